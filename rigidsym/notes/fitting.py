"""Long quantities made to fit.

An equation takes one line, or two that part at an equals sign. A wider one is broken before a + or
−, with its entries below one another (`rigidsym.formula.display`). A tensor or momentum in space
that would be broken is written in short, as a product; so is any quantity that would fill most of a
page.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rigidsym.algebra.generators import rate_of
from rigidsym.formula import tree
from rigidsym.formula.display import PAGE, display
from rigidsym.formula.latex_pen import LatexPen
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.mechanics.derivation import Derivation, Step
from rigidsym.mechanics.quantities.energy import ENERGY_QUANTITIES, MOMENTUM_BODY
from rigidsym.mechanics.quantities.kinematics import BODY, RATES, ROTATION, SPACE
from rigidsym.mechanics.quantities.mass import INERTIA_QUANTITIES
from rigidsym.notes.document import Equation, NoteBlock, said
from rigidsym.notes.equations import sum_of_vectors
from rigidsym.notes.facts.rotation import product_of

_MOST_LINES = 12  # of one quantity
_MOST_OF_ROTATION = 48  # a page of R itself, which the others are for
_RATHER_SHORT = frozenset(  # than broken
    {"rotation_rate", "inertia_tensor_space", "angular_momentum_rotation", "angular_momentum"}
)
_IN_SHORT = {"angular_momentum_rotation": tree.row(ROTATION, MOMENTUM_BODY)}
_ADJUGATES = dict[str, tree.Formula]()  # of three rates
_INVERSES = dict[str, tree.Formula]()  # of more
for _frame in (SPACE, BODY):
    _matrix, _inverse = _frame.matrix, f"inverse_rate_matrix_{_frame.name}"
    _acceleration = formula(r"#1\,\ddot{\mathbf{q}} + #3\,#2", _matrix, RATES, tree.Rate(_matrix))
    _IN_SHORT[f"angular_acceleration_{_frame.name}"] = _acceleration
    # the right inverse of least norm
    _INVERSES[_inverse] = formula(r"#2\,(#1#2)^{-1}", _matrix, tree.transpose_of(_matrix))
    _ADJUGATES[_inverse] = formula(r"\frac{1}{\det#1}\,\operatorname{adj}#1", _matrix)


def fitted(
    equation: Equation, step: Step, derivation: Derivation, letters: Letters, *, is_audit: bool
) -> Iterator[NoteBlock]:
    """An equation; where it would be long, in short."""
    name, model = step.quantity.name, derivation.model
    layout = display(equation, letters, PAGE, LatexPen(letters.notation))
    side = _short_form(step, derivation, letters)
    if side is None and not equation.sides[1:]:  # nothing else says what it is
        yield equation
        return
    short = without_entries(equation, () if side is None else (side,))
    # Quantities of a rotation by a vector are said best by vectors. In a lecture, nine long entries
    # of dR/dt say less than the chain rule.
    is_of_body = name in {*INERTIA_QUANTITIES, *ENERGY_QUANTITIES}
    by_vectors = bool(model.vector) and not is_of_body
    by_vectors |= name == "rotation_rate" and not is_audit
    is_matrix = equation.matrix is not None and not layout.is_listed
    lines = equation.matrix.rows if equation.matrix and is_matrix else layout.lines
    most = _MOST_OF_ROTATION if name == "rotation_matrix" else _MOST_LINES
    is_long = layout.is_broken and (by_vectors or name in _RATHER_SHORT)
    if is_long or (by_vectors and layout.is_listed):
        yield short
    elif layout.width > PAGE or (layout.is_broken and lines > most):
        yield from (short, said("left_out"))  # the function evaluates it all the same
    else:
        yield equation


def as_vectors(equation: Equation, step: Step, letters: Letters) -> Equation:
    """With its vector form; where there is one, the entries are shown only if they fit.

    Those of the rates, which hold the most products, are not.
    """
    if step.vector_form is None:
        return equation
    sides = (*equation.sides, sum_of_vectors(step.vector_form, letters))
    whole = replace(equation, sides=sides)
    is_listed = display(whole, letters, PAGE, LatexPen(letters.notation)).is_listed
    fits = not (step.quantity.name.startswith("rates_") or is_listed)
    return whole if fits else without_entries(equation, sides[-1:])


def without_entries(equation: Equation, sides: Sequence[tree.Formula] = ()) -> Equation:
    """Ended by these sides in place of its entries; where nothing is left, it is a definition."""
    return replace(
        equation,
        sides=(*equation.sides, *sides),
        matrix=None,
        scalar=None,
        entries=(),
        is_result=equation.is_result and bool(sides),
    )


def _short_form(step: Step, derivation: Derivation, letters: Letters) -> tree.Formula | None:
    """What a quantity is equal to, by other quantities, beside its definition."""
    name, model = step.quantity.name, derivation.model
    if name == "rotation_matrix" and model.turns:
        whole = product_of(model.turns, letters)
        return formula(r"\left(#1\right)^{\mathsf T}", whole) if model.passive else whole
    if name == "rotation_rate":  # φ̇ ∂R/∂φ + ..., which is what its entries come from
        rate = step.quantity.symbol
        whole = rate.of if isinstance(rate, tree.Rate) else rate
        pairs = [(letters.name(rate_of(q)), letters.name(q)) for q in model.coordinates]
        text = r"#2\,\frac{\partial #1}{\partial #3}"
        return tree.joined([formula(text, whole, *pair) for pair in pairs], tree.PLUS)
    count = len(model.coordinates)
    is_free = count > 3 and not model.constraints
    inverses = _INVERSES if is_free else _ADJUGATES if count == 3 else {}
    return (_IN_SHORT | inverses).get(name)
