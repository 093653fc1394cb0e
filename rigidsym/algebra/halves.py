"""Quotients by 1 − cos θ or 1 + cos θ, written in half the angle.

1 − cos θ = 2 sin² θ/2 keeps its digits where it vanishes; over the half angle the quotient loses
what its two sides have in common, sin θ/(1 − cos θ) = cot θ/2.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.present import presenter_for


def halved(
    entries: Sequence[sp.Expr], given: Iterable[sp.Expr], constraints: Sequence[sp.Expr] = ()
) -> list[sp.Expr]:
    """The entries over half of each angle whose 1 ± cos divides, proved equal.

    `given` are the expressions that the entries were derived from.
    """
    angles = dict.fromkeys(angle for entry in entries for angle in _vanishing(entry))
    if not angles:
        return list(entries)
    codec = codec_for([*given, *(sp.sin(angle / 2) for angle in angles)], constraints=constraints)
    present = presenter_for(codec)
    return [present.quotient(codec.encode_quotient(entry)) for entry in entries]


def _vanishing(entry: sp.Expr) -> Iterator[sp.Expr]:
    """The angles of the divisors a ± a cos θ."""
    for power in entry.atoms(sp.Pow):
        number, rest = power.base.as_coeff_Add()
        size, cosine = rest.as_coeff_Mul()
        if power.exp.is_negative and isinstance(cosine, sp.cos) and abs(size) == abs(number):
            yield cosine.args[0]
