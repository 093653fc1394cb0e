"""Names for the parts of a long matrix: k₁ = 1 − cos n, so that its entries become short.

What comes up again and is long enough to be worth a name gets one, and so does what no line can
break in: the inside of a fraction or a root that is wider than the page.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.formula.display import broken, widest
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.letters import Letters
from rigidsym.formula.scalars import factored, formula_of

_LETTERS = "kbhm"  # of the names; one that nothing in the notation is called by is taken
_OVERHEAD = 3.0  # ems that a definition takes beside its formula
_LEAST = {True: 2.5, False: 6.0}  # ems worth a name: of a sum or quotient, and of a product
_NAME = 1.1  # ems of a name

Part = tuple[sp.Symbol, sp.Expr]


class Namer:
    """Names parts of matrices; what has a name already keeps it in all that follow."""

    def __init__(self, letters: Letters) -> None:
        self.letters = letters
        self.pen = LatexPen(letters.notation)
        taken = {str(name.expr if name.is_Derivative else name)[0] for name in letters.names}
        self._letter = next(letter for letter in _LETTERS if letter not in taken)
        self._known: dict[sp.Expr, sp.Symbol] = {}
        self._known_before = 0
        self._given = 0  # names that are not of this letter

    def give(self, names: Iterable[Part]) -> None:
        """Use these names for what they stand for, instead of new ones."""
        new = {value: name for name, value in names if value.args and value not in self._known}
        self._known |= new
        self._given += len(new)

    def named(
        self, matrix: sp.ImmutableMatrix, room: float
    ) -> tuple[tuple[Part, ...], sp.ImmutableMatrix]:
        """The named parts in order of use, and the matrix in terms of them; every line of both
        is at most `room` ems wide."""
        self._known_before = len(self._known)
        factor, inside = factored(matrix)  # what stands before the matrix needs no name
        before = self.letters.shortened(factor)
        is_symmetric = inside.rows > 1 and inside == inside.T  # then half of it is listed
        places = [divmod(k, inside.cols) for k in range(len(inside))]
        places = [(i, j) for i, j in places if i <= j or not is_symmetric]
        entries = [self.letters.shortened(inside[place]) for place in places]
        moving = sp.Tuple(*entries).atoms(AppliedUndef, sp.Derivative)
        as_symbols = {part: sp.Symbol(f"at_{k}") for k, part in enumerate(sorted(moving, key=str))}
        still = [entry.xreplace(as_symbols) for entry in entries]  # a rate is not taken apart
        found, short = sp.cse(still, symbols=sp.numbered_symbols("cse_"), order="canonical")
        back = {symbol: part for part, symbol in as_symbols.items()}
        parts = [(symbol, value.xreplace(back)) for symbol, value in found]
        parts, entries = self._worth_a_name(parts, [e.xreplace(back) for e in short])
        parts, entries = self._breakable(parts, entries, room)
        if before != 1:  # a fraction may have to go below each entry, where no line can break
            more, entries = self._breakable((), [before * entry for entry in entries], room)
            parts = list(dict.fromkeys([*parts, *more]))
        shown = {(j, i): e for (i, j), e in zip(places, entries, strict=True) if is_symmetric}
        shown |= dict(zip(places, entries, strict=True))
        return tuple(parts), sp.ImmutableMatrix(*matrix.shape, lambda i, j: shown[int(i), int(j)])

    def forget(self) -> None:
        """Free the names that were given last, where they come to stand nowhere."""
        self._known = dict(islice(self._known.items(), self._known_before))

    def _worth_a_name(
        self, found: Sequence[Part], entries: Sequence[sp.Expr]
    ) -> tuple[list[Part], list[sp.Expr]]:
        """The parts that are long and come up again; all others are written out."""
        written: dict[sp.Symbol, sp.Expr] = {}
        parts: list[Part] = []
        written_down = sp.Tuple(*(value for _, value in found), *entries)
        times = Counter(node for node in sp.preorder_traversal(written_down) if node.is_Symbol)
        for symbol, value in found:
            whole = value.xreplace(written)
            width = self._width(whole)
            is_bound = whole.is_Add or whole.is_Pow or any(p.is_Pow for p in whole.args)
            # A name saves its value at every place but one, which is the definition.
            saved = (times[symbol] - 1) * (width - _NAME) - _OVERHEAD
            if width >= _LEAST[bool(is_bound)] and saved > 0:
                # The sign stays before the name, so that a part and its negative share it.
                sign = -1 if whole.as_coeff_Mul()[0].is_negative or -whole in self._known else 1
                name = self._name_of(sign * whole)
                written[symbol] = sign * name
                parts.append((name, sign * whole))
            else:
                written[symbol] = whole
        return parts, [entry.xreplace(written) for entry in entries]

    def _breakable(
        self, parts: Sequence[Part], entries: Sequence[sp.Expr], room: float
    ) -> tuple[list[Part], list[sp.Expr]]:
        """The same, with names for what is wider than a line and cannot break."""
        all_parts: list[Part] = []
        for name, value in parts:
            *inner, whole = self._split(value, room)
            all_parts += [*inner, (name, whole[1])]
        shown: list[sp.Expr] = []
        for entry in entries:
            *inner, whole = self._split(entry, room)
            all_parts += inner
            shown.append(whole[1])
        return list(dict.fromkeys(all_parts)), shown

    def _split(self, value: sp.Expr, room: float) -> list[Part]:
        """Parts of an expression that need names so that it fits, and last what is left of it."""
        names: list[Part] = []
        while widest(broken(formula_of(value, self.letters), room, self.pen)) > room:
            part = max(_unbreakable(value), key=self._width, default=None)
            if part is None or self._width(part) < room / 4:
                break
            *inner, (_, whole) = self._split(part, room)
            name = self._name_of(whole)
            names += [*inner, (name, whole)]
            value = value.xreplace({part: name})
        return [*names, (sp.Symbol("left"), value)]

    def _name_of(self, value: sp.Expr) -> sp.Symbol:
        known = self._known.get(value)
        if known is None:
            number = len(self._known) - self._given + 1
            known = self._known[value] = sp.Symbol(f"{self._letter}_{number}")
        return known

    def _width(self, part: sp.Expr) -> float:
        return self.pen.write(formula_of(part, self.letters)).width


def _unbreakable(expression: sp.Expr) -> Iterator[sp.Expr]:
    """The sums that stand where no line can end: above or below a fraction line, under a root."""
    for node in sp.preorder_traversal(expression):
        if node.is_Pow and node.base.is_Add and not (node.exp.is_Integer and node.exp > 0):
            yield node.base
        elif node.is_Mul and any(a.is_Pow and a.exp.is_negative for a in node.args):
            # what stands above the line of a fraction
            yield from (factor for factor in node.args if factor.is_Add)
        elif node.is_Function and node.args[0].is_Add:
            yield node.args[0]
