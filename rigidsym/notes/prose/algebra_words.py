"""Rodrigues' formula and quaternions, as a textbook derives them before any matrix is written.

A block is a paragraph, or an equation whose lines begin with `=`. Formulas in a paragraph stand
between dollar signs; <v> is the vector of the coordinates, <n> its length, and <w> the coordinate
beside it; of a quaternion <n> is |q|, which is left out where it is 1.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from itertools import groupby

from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import Formula
from rigidsym.models.rotation import RotationModel
from rigidsym.notes.document.document import Equation, EquationRow, NoteBlock, Paragraph, said
from rigidsym.notes.formula.derivation_letters import VECTOR

_RODRIGUES = r"""
Let $\mathbf{e}$ be the unit vector along the axis and $\alpha$ the angle of the turn. A vector
$\mathbf{x}'$ has a part along the axis and a part perpendicular to it,

= \mathbf{x}'
= \mathbf{x}'_{\parallel} + \mathbf{x}'_{\perp}

with $\mathbf{x}'_{\parallel} = (\mathbf{e}\cdot\mathbf{x}')\,\mathbf{e}$. The turn keeps the first
part. It moves the second in the plane spanned by $\mathbf{x}'_{\perp}$ and
$\mathbf{e}\times\mathbf{x}'$, which are perpendicular and of equal length:

= \mathbf{x}
= \mathbf{x}'_{\parallel} + \cos\alpha\,\mathbf{x}'_{\perp}
  + \sin\alpha\,\mathbf{e}\times\mathbf{x}'

Since $\mathbf{x}'_{\perp} = -\mathbf{e}\times(\mathbf{e}\times\mathbf{x}')$, this is Rodrigues'
formula

= \mathbf{x}
= \mathbf{x}' + \sin\alpha\,\mathbf{e}\times\mathbf{x}'
  + (1 - \cos\alpha)\,\mathbf{e}\times(\mathbf{e}\times\mathbf{x}')
"""
_LENGTHS = {  # what the vector is, and the coefficients that follow
    "axis_angle": r"""
Here $\alpha = <w>$.
""",
    "rotation_vector": r"""
Here $<v> = \alpha\,\mathbf{e}$, so that $\alpha = <n>$, and the coefficients of
$<v>\times\mathbf{x}'$ and $<v>\times(<v>\times\mathbf{x}')$ are $\frac{\sin <n>}{<n>}$ and
$\frac{1 - \cos <n>}{<n>^2}$. For small angles they tend to 1 and to $\frac{1}{2}$, so that the
rotation vector has no singularity there.
""",
    "gibbs_vector": r"""
Here $<v> = \tan\frac{\alpha}{2}\,\mathbf{e}$. With $<n> = \tan\frac{\alpha}{2}$,

= \sin\alpha
= \frac{2 <n>}{1 + <n>^2}

= 1 - \cos\alpha
= \frac{2 <n>^2}{1 + <n>^2}

so that both coefficients, of $<v>\times\mathbf{x}'$ and of $<v>\times(<v>\times\mathbf{x}')$, are
$\frac{2}{1 + <n>^2}$.
""",
    "modified_rodrigues": r"""
Here $<v> = \tan\frac{\alpha}{4}\,\mathbf{e}$. With $<n> = \tan\frac{\alpha}{4}$,

= \sin\alpha
= \frac{4 <n>\,(1 - <n>^2)}{(1 + <n>^2)^2}

= 1 - \cos\alpha
= \frac{8 <n>^2}{(1 + <n>^2)^2}
""",
}
_QUATERNION = r"""
The quaternion $\mathbf{q} = <w> + <v>$ has a scalar and a vector part. Quaternions are multiplied
by the rule

= (a + \mathbf{a})\,(b + \mathbf{b})
= a\,b - \mathbf{a}\cdot\mathbf{b} + a\,\mathbf{b} + b\,\mathbf{a} + \mathbf{a}\times\mathbf{b}

and $\mathbf{q}^{\ast} = <w> - <v>$ is the conjugate, so that
$\mathbf{q}\,\mathbf{q}^{\ast} = <n>^2$. The quaternion takes $\mathbf{x}'$ to

= \mathbf{x}
= \frac{1}{<n>^2}\,\mathbf{q}\,\mathbf{x}'\,\mathbf{q}^{\ast}
= \mathbf{x}' + \frac{2}{<n>^2}\left(<w>\,<v>\times\mathbf{x}'
  + <v>\times(<v>\times\mathbf{x}')\right)

With $<w> = <n>\cos\frac{\alpha}{2}$ and
$<v> = <n>\sin\frac{\alpha}{2}\,\mathbf{e}$, where $\mathbf{e}$ is a unit vector, the
coefficients are $2\cos\frac{\alpha}{2}\sin\frac{\alpha}{2} = \sin\alpha$ and
$2\sin^2\frac{\alpha}{2} = 1 - \cos\alpha$. By Rodrigues' formula this is the turn by $\alpha$ about
$\mathbf{e}$.
"""
_OF_TURNING = r"""
If only the angle changes, the angular velocity is $\dot{\alpha}\,\mathbf{e}$. If only the axis
moves, a rotation $\mathbf{Q}$ with the angular velocity $\mathbf{e}\times\dot{\mathbf{e}}$ carries
it along. The turn about the moved axis undoes $\mathbf{Q}$, turns about the former axis and applies
$\mathbf{Q}$ again; its angular velocity is

= \mathbf{e}\times\dot{\mathbf{e}} - \mathbf{R}\,(\mathbf{e}\times\dot{\mathbf{e}})
= (1 - \cos\alpha)\,\mathbf{e}\times\dot{\mathbf{e}} + \sin\alpha\,\dot{\mathbf{e}}

by Rodrigues' formula. Both together are

= \boldsymbol{\Omega}
= \dot{\alpha}\,\mathbf{e} + \sin\alpha\,\dot{\mathbf{e}}
  + (1 - \cos\alpha)\,\mathbf{e}\times\dot{\mathbf{e}}

The derivative of the rotation matrix leads to the same result.
"""
_OF_RATES = r"""
Keep $<n>$ constant. Differentiating $<n>^2\,\mathbf{x} =
\mathbf{q}\,\mathbf{x}'\,\mathbf{q}^{\ast}$ for a point at rest in the body gives
$\dot{\mathbf{x}} = \boldsymbol{\Omega}\times\mathbf{x}$ with

= \boldsymbol{\Omega}
= \frac{2}{<n>^2}\,\dot{\mathbf{q}}\,\mathbf{q}^{\ast}

= \boldsymbol{\Omega}'
= \frac{2}{<n>^2}\,\mathbf{q}^{\ast}\,\dot{\mathbf{q}}

Multiplied by $\mathbf{q}$, this is the equation that attitude software integrates:

= \dot{\mathbf{q}}
= \frac{1}{2}\,\boldsymbol{\Omega}\,\mathbf{q}
= \frac{1}{2}\,\mathbf{q}\,\boldsymbol{\Omega}'

The derivative of the rotation matrix leads to the same result.
"""
_QUATERNIONS = ("quaternion", "unit_quaternion", "cayley_klein")


def is_told(model: RotationModel) -> bool:
    """Whether there are words on how the coordinates turn a vector."""
    return model.name.removesuffix("_passive") in (*_QUATERNIONS, *_LENGTHS)


def rotation_in_words(model: RotationModel, letters: Letters) -> Iterator[NoteBlock]:
    """How the coordinates turn a vector; nothing for other models."""
    name = model.name.removesuffix("_passive")
    if name in _QUATERNIONS:
        yield from _blocks(_QUATERNION, model, letters)
    elif name in _LENGTHS:
        yield from _blocks(_RODRIGUES + _LENGTHS[name], model, letters)


def rates_in_words(model: RotationModel, letters: Letters) -> Iterator[NoteBlock]:
    """The angular velocity as a product of quaternions, or of a turn whose axis moves."""
    name = model.name.removesuffix("_passive")
    if name in _QUATERNIONS:
        yield from _blocks(_OF_RATES, model, letters)
    elif name in _LENGTHS:
        yield from _blocks(_OF_TURNING, model, letters)


def _blocks(text: str, model: RotationModel, letters: Letters) -> Iterator[NoteBlock]:
    if "α" in model.convention[0]:  # a parameter of Cayley and Klein
        text = text.replace(r"\alpha", r"\gamma")
    others = [q for q in model.coordinates if q not in model.vector]
    spans: dict[str, Formula] = {"v": VECTOR}
    spans |= {"w": formula_of(others[0], letters)} if others else {}
    if letters.length:
        spans["n"] = letters.names[letters.length.symbol]
    else:  # it is 1
        text = re.sub(r"\\frac\{(\d)\}\{<n>\^2\}", r"\1", text).replace("$<n>^2$", "1")
        text = text.replace("Keep $<n>$ constant. ", "")
        text = re.sub(r"(?<!\d)1\\,|<n>(\^2)?(\\,|(?=\\))", "", text).replace("<n>^2", "1")
    blocks = text.strip().split("\n\n")
    for is_formula, group in groupby(blocks, lambda block: block.startswith("= ")):
        if is_formula:
            parts = (block.removeprefix("= ").split("\n= ") for block in group)
            yield EquationRow(
                tuple(
                    Equation(sides=tuple(formula(*_filled(side, spans)) for side in sides))
                    for sides in parts
                )
            )
        else:
            yield from (_paragraph(" ".join(block.split()), spans) for block in group)


def _filled(typed: str, spans: Mapping[str, Formula]) -> tuple[str, *tuple[Formula, ...]]:
    """The formula with #1, #2, ... for the letters of the model, and these."""
    for place, name in enumerate(spans, start=1):
        typed = typed.replace(f"<{name}>", f"#{place}")
    return (typed, *spans.values())


def _paragraph(text: str, spans: Mapping[str, Formula]) -> Paragraph:
    parts = text.split("$")
    formulas = [formula(*_filled(part, spans)) for part in parts[1::2]]
    words = "".join(part if k % 2 == 0 else "{}" for k, part in enumerate(parts))
    return said(words, *formulas)
