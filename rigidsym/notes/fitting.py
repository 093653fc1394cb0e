"""Long quantities made to fit, in this order.

1. As it stands: on one line, or on two, parted at an equals sign.
2. Parts get names first (k₁ = 1 − cos θ), where this takes fewer lines, or makes a matrix of what
   would be a listing of entries.
3. What is still too wide is broken by its width, before a + or −, entries below one another.
4. A matrix cannot be broken: where it fits with s_θ and c_θ it has those, and is not listed. Only
   names of sums come before them; for products of sines and cosines the shorthand says more.
What would take most of a page so is said in short (`in_short`), by what it is made of; so are
dR/dt and the components in space of a tensor or momentum of the body, if their parts would need
names.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import sympy as sp

from rigidsym.formula.abbreviations import Namer, Part
from rigidsym.formula.display import PAGE, Display, display
from rigidsym.formula.letters import TIME, Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.formula.tree import (
    PLUS,
    Differential,
    Formula,
    Fraction,
    Rate,
    Row,
    joined,
    row,
    transpose_of,
)
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES, MOMENTUM_BODY
from rigidsym.mechanics.quantities.kinematics import BODY, RATES, ROTATION, SPACE
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.notes.document import (
    Equation,
    EquationReference,
    NoteBlock,
    Paragraph,
    Text,
    listed,
    said,
)
from rigidsym.notes.facts.rotation import product_of
from rigidsym.notes.vectors import sum_of_vectors

_MOST_LINES = 24  # of one quantity, where there is a short way to say it
_MOST_OF_ROTATION = 48  # a page of R itself, which the others are for
_RATHER_SHORT = frozenset(  # than with names for their parts
    {
        "rotation_rate",
        "inertia_tensor_space",
        "angular_momentum_rotation",
        "angular_momentum",
    }
)
_BODY_VELOCITY = "angular_velocity_body"
_ROOM_OF_A_NAME = 6.0  # ems


class _Form(NamedTuple):
    """An equation, and the parts that it has names for."""

    equation: Equation
    parts: Sequence[Part] = ()


class Fitter:
    """The equations of one note, each as short as can be."""

    def __init__(self, derivation: Derivation, letters: Letters, *, is_audit: bool) -> None:
        self.derivation = derivation
        self.letters = letters
        self._is_audit = is_audit
        self._namer = Namer(letters)
        self._explained_at: dict[sp.Symbol, str] = {}  # name of a part: label of its equation

    def fitted(self, equation: Equation, shown: Display, step: Step) -> Iterator[NoteBlock]:
        """An equation; where it would be long, in short, or its parts with their names first."""
        # quantities of the rotation are said best by vectors, where there are any
        is_of_body = step.quantity.name in {*INERTIA_QUANTITIES, *ENERGY_QUANTITIES}
        is_vector = bool(self.derivation.model.vector) and not is_of_body
        is_long = shown.is_broken or (is_vector and bool(shown.done))
        short = in_short(step, self.derivation, self.letters) if is_long else None
        if short is not None and is_vector:
            yield _without_entries(equation, short)
            return
        if step.quantity.name == "rotation_rate" and not self._is_audit and shown.done:
            rate = equation.sides[0]  # nine long entries say less than what they come from
            yield _without_entries(equation, [by_the_chain_rule(rate, self.letters)])
            return
        form = self._shortest(equation, shown)
        if form.parts and step.quantity.name in _RATHER_SHORT:
            self._namer.forget()
            yield _without_entries(equation, in_short(step, self.derivation, self.letters) or ())
            return
        if short is not None:
            lines = sum(map(self._lines, self._blocks(form)))
            is_rotation = step.quantity.name == "rotation_matrix"
            if lines > (_MOST_OF_ROTATION if is_rotation else _MOST_LINES):
                self._namer.forget()
                yield _without_entries(equation, short)  # the function evaluates it all the same
                yield said("left_out", str(lines))
                return
        yield from self._blocks(form)
        if equation.number:  # it can be referred to
            for name, _ in form.parts:
                self._explained_at.setdefault(name, equation.label)
        if equation.number and step.quantity.name == _BODY_VELOCITY:
            # from here on, Ω′₁, Ω′₂, Ω′₃ stand for the components of the angular velocity
            for names in (a.symbols for a in self.derivation.arguments if a.name == "omega_body"):
                self._namer.give(zip(names, step.expression, strict=True))
                self._explained_at |= dict.fromkeys(names, step.quantity.name)

    def whole(self, equation: Equation) -> Iterator[NoteBlock]:
        """An equation that belongs to no quantity, with the names of its parts."""
        shown = display(equation, self.letters, PAGE)
        yield from self._blocks(self._shortest(equation, shown))

    def _shortest(self, equation: Equation, shown: Display) -> _Form:
        """With names for its parts, where that is better than without."""
        plain = _Form(equation)
        if not shown.is_broken and not shown.done:
            return plain
        scalar = equation.scalar
        matrix = sp.ImmutableMatrix([scalar]) if equation.matrix is None else equation.matrix
        # In a listing each entry stands behind its name, and a symmetric one behind both of its
        # names.
        names = 1.5 if matrix.rows > 1 and matrix == matrix.T else 1.0  # I₁₂ = I₂₁
        parts, short = self._namer.named(matrix, PAGE - names * _ROOM_OF_A_NAME)
        value = {"scalar": short[0]} if equation.matrix is None else {"matrix": short}
        named = _Form(replace(equation, **value), parts)
        is_better = self._is_shorter if shown.is_broken else self._is_more_of_a_matrix
        if named.parts and is_better(named, plain):
            return named
        self._namer.forget()
        return plain

    def _is_shorter(self, named: _Form, plain: _Form) -> bool:
        """Whether names save lines; two more are worth it where nothing is broken then."""
        shown = display(named.equation, self.letters, PAGE)
        # Too wide even when broken: names are the only way.
        if display(plain.equation, self.letters, PAGE).width > PAGE:
            return True
        lines = sum(map(self._lines, self._blocks(named)))
        before = self._lines(plain.equation)
        if shown.done == "abbreviated":  # names and shorthand are much to ask of a reader
            return 2 * lines < before
        return lines < before + (0 if shown.is_broken else 2)

    def _is_more_of_a_matrix(self, named: _Form, plain: _Form) -> bool:
        """Whether a matrix that is too wide for one fits with names for its parts."""
        was_listed = display(plain.equation, self.letters, PAGE).done == "listed"
        fits = not display(named.equation, self.letters, PAGE).done
        return fits and (was_listed or all(value.is_Add for _, value in named.parts))

    def _blocks(self, form: _Form) -> Iterator[NoteBlock]:
        """An equation behind what its names stand for; what was said before is referred to."""
        new = [part for part in form.parts if part[0] not in self._explained_at]
        labels = (self._explained_at[name] for name, _ in form.parts if name in self._explained_at)
        old: list[Text] = [(EquationReference(label),) for label in dict.fromkeys(labels)]
        if old:
            words = said("defined_before").text
            yield Paragraph((*words, " ", *listed(old), "; let" if new else "."))
        elif new:
            yield said("let")
        if new:
            yield definitions(new, self.letters)
        yield form.equation

    def _lines(self, block: NoteBlock) -> int:
        if not isinstance(block, Equation):
            return 1
        shown = display(block, self.letters, PAGE)
        if block.matrix is None or not block.sides or shown.done == "listed":
            return shown.lines
        return int(block.matrix.shape[0])


def as_vectors(equation: Equation, step: Step, letters: Letters) -> Equation:
    """With its vector form; where there is one, the entries are shown only if they fit.

    Those of the rates, which hold the most products, are not.
    """
    if step.vector_form is None:
        return equation
    sides = (*equation.sides, sum_of_vectors(step.vector_form, letters))
    whole = replace(equation, sides=sides)
    fits = not (step.quantity.name.startswith("rates_") or display(whole, letters, PAGE).done)
    return whole if fits else _without_entries(equation, sides[-1:])


def definitions(parts: Sequence[Part], letters: Letters) -> Equation:
    """k₁ = ..., k₂ = ...: what the names of parts stand for."""
    names, values = zip(*parts, strict=True)
    return Equation(
        sides=(),
        matrix=sp.ImmutableMatrix(values),
        entries=tuple(formula_of(name, letters) for name in names),
    )


def _without_entries(equation: Equation, sides: Sequence[Formula]) -> Equation:
    """Ended by these sides in place of its entries; where nothing is left, it is a definition."""
    return replace(
        equation,
        sides=(*equation.sides, *sides),
        matrix=None,
        scalar=None,
        entries=(),
        is_result=equation.is_result and bool(sides),
    )


_IN_SHORT: dict[str, tuple[Formula, ...]] = {
    "spin_matrix": (),  # by its definition, as all others without sides
    "inertia_tensor_space": (),
    "rotational_energy": (),
    "kinetic_energy": (),
    "angular_momentum_rotation_body": (),
    "angular_momentum": (),
    "angular_momentum_rotation": (row(ROTATION, MOMENTUM_BODY),),
}
_INVERSES: dict[str, tuple[Formula, ...]] = {}  # of more than three rates
for _frame in (SPACE, BODY):
    _w = _frame.matrix
    _IN_SHORT |= {
        f"rates_from_angular_velocity_{_frame.name}": (),
        f"angular_acceleration_{_frame.name}": (
            formula(r"#1\,\ddot{\mathbf{q}} + #3\,#2", _w, RATES, Rate(_w)),
        ),
    }
    # the right inverse of least norm
    _inverse = formula(r"#2\,(#1#2)^{-1}", _w, transpose_of(_w))
    _INVERSES[f"inverse_rate_matrix_{_frame.name}"] = (_inverse,)


def in_short(step: Step, derivation: Derivation, letters: Letters) -> tuple[Formula, ...] | None:
    """What a quantity is equal to, by other quantities; None where it is known by itself alone."""
    name, model = step.quantity.name, derivation.model
    if name == "rotation_matrix" and model.turns:
        whole = product_of(model.turns, letters)
        if model.passive:  # A is the transpose
            whole = formula(r"\left(#1\right)^{\mathsf T}", whole)
        return (whole,)
    if name == "rotation_rate":
        return (by_the_chain_rule(step.quantity.symbol, letters),)
    is_free = len(model.coordinates) > 3 and not model.constraints
    return (_IN_SHORT | _INVERSES if is_free else _IN_SHORT).get(name)


def by_the_chain_rule(rate: Formula, letters: Letters) -> Formula:
    """dR/dt = φ̇ ∂R/∂φ + ..., which is what its entries come from."""
    coordinates = [q for q, (order, k) in letters.places.items() if order == 0 and k >= 0]
    above = Row((Differential("∂"), rate.of if isinstance(rate, Rate) else rate))
    terms = [
        row(letters.name(q.diff(TIME)), Fraction(above, row(Differential("∂"), letters.name(q))))
        for q in coordinates
    ]
    return joined(terms, PLUS)
