"""The pictures of examples: coordinates in time, and a trace on a sphere or an ellipsoid.

The equations of motion are integrated in floats by the classical Runge-Kutta method, whose steps
are halved until the picture stays the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from rigidsym.algebra.evaluate import Floats, evaluate, function_of
from rigidsym.errors import ModelError
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.forces import OMEGA_BODY, OMEGA_COMPONENTS, Example, Forces, initial_values
from rigidsym.models.rotation import TIME
from rigidsym.notes.figure.chart import chart, circle, in_a_row, on_ellipsoid
from rigidsym.notes.figure.drawing import Drawing
from rigidsym.notes.figure.scene import BODY

Numbers = NDArray[Any]
Slopes = Callable[[float, Numbers], Numbers]

_NEEDED = {"state_derivative", "angular_velocity_body"}
_SAMPLES = 400
_MOST_STEPS = 256  # from one sample to the next
_SEEN = 2e-3  # of the range of a value
_TURN = 6.3  # rad: angles that go further are left out of the chart
_WIDE, _NARROW, _HEIGHT = 4.6, 2.5, 1.7  # of a chart
_IN_A_ROW = 3  # spheres
_LOW = 0.02  # between the bounding circles of a trace


class MotionPicture(NamedTuple):
    """A drawing, and what its caption says of it."""

    drawing: Drawing
    told: int  # of how many examples the caption needs the numbers
    traces: tuple[str, ...]  # "axis", "polhode", "polhodes"


def motion_picture(derivation: Derivation, letters: Letters) -> MotionPicture | None:
    """The pictures of all examples in a row; None without one, or without the equations.

    Raises ModelError if values are missing, and if the motion is too fast to follow.
    """
    forces = derivation.forces
    derived = {*(step.quantity.name for step in derivation.steps), *derivation.functions}
    if forces is None or not forces.examples or not derived >= _NEEDED:
        return None
    first = ExampleMotion(derivation, forces, forces.examples[0])
    most = None if first.is_poinsot else _IN_A_ROW  # all polhodes are on one ellipsoid
    others = (ExampleMotion(derivation, forces, e) for e in forces.examples[1:most])
    motions = [first, *others]
    traces: list[tuple[str, Drawing]] = []  # what is traced, with its drawing
    if first.is_poinsot:
        kind = "polhode" if len(motions) == 1 else "polhodes"
        traces.append((kind, _polhodes(motions, letters)))
    turns = derivation.model.turns
    if turns and turns[-1].axis == "z":
        by_axis = motions[:1] if first.is_poinsot else motions
        traces += [("axis", _axis(motion)) for motion in by_axis]
    drawings = [drawing for _, drawing in traces]
    if not drawings:
        width = _WIDE if len(motions) == 1 else _NARROW
        drawings = [_over_time(motion, letters, width) for motion in motions]
    elif len(drawings) == 1:
        drawings.insert(0, _over_time(first, letters, _NARROW))
    kinds = tuple(dict.fromkeys(kind for kind, _ in traces))
    return MotionPicture(in_a_row(drawings), 1 if first.is_poinsot else len(motions), kinds)


class ExampleMotion:
    """One example, integrated: its `states` (n, k) at the times `t` (n,)."""

    def __init__(self, derivation: Derivation, forces: Forces, example: Example) -> None:
        self.derivation, self.forces, self.example = derivation, forces, example
        self.y = derivation.argument("y").symbols
        self.count = len(derivation.model.coordinates)
        slopes = [*derivation.spelled(derivation.step("state_derivative").expression)]
        states = _integrated(self._slopes(slopes), np.array(self._start()), example.time)
        if states is None:
            raise ModelError(
                f"{derivation.name}: an example cannot be drawn; expected a motion that is slower, "
                "shorter, or farther from the poles of the coordinates"
            )
        self.t = np.linspace(0.0, example.time, _SAMPLES + 1)
        self.states = states

    @property
    def inertia(self) -> sp.ImmutableMatrix:
        """I′ about the fixed point."""
        assert self.derivation.body is not None
        return self.derivation.body.inertia

    @property
    def is_poinsot(self) -> bool:
        """Whether the polhode on the ellipsoid of energy shows the motion."""
        is_free = self.forces.leave_free(self.derivation.model)
        return is_free and bool(self.inertia.is_diagonal()) and self.is_turning

    @property
    def is_turning(self) -> bool:
        """Whether the body does not begin at rest."""
        return bool(self.states[0, self.count :].any())

    def _start(self) -> list[float]:
        """The initial state in the order of y."""
        values = initial_values(self.derivation.model, self.example.initial)
        coordinates = self.derivation.argument("q").names
        rates = [f"{name}_dot" for name in coordinates]
        if self.y[self.count :] == OMEGA_BODY:
            rates = [*OMEGA_COMPONENTS]
        at_rest = not any(v for name, v in values.items() if name not in coordinates)
        missing = [name for name in rates if name not in values and not at_rest]
        if missing:
            raise ModelError(
                f"{self.derivation.name}: an example begins without {', '.join(missing)}, which "
                "are part of the state"
            )
        return [float(values.get(name, 0.0)) for name in (*coordinates, *rates)]

    def _constants(self, expressions: Sequence[sp.Expr]) -> dict[sp.Expr, float]:
        """The values of the constants. Raises ModelError for those without one, all at once."""
        symbols = sp.Tuple(*expressions).free_symbols - {*self.y, TIME}
        numbers = self.example.parameters
        missing = sorted(symbol.name for symbol in symbols if symbol.name not in numbers)
        if missing:
            raise ModelError(
                f"{self.derivation.name}: an example lacks values of {', '.join(missing)}"
            )
        return {symbol: float(numbers[symbol.name]) for symbol in symbols}

    def _slopes(self, expressions: Sequence[sp.Expr]) -> Slopes:
        """The derivative of the state as a function of the time and the state."""
        constants = self._constants(expressions)
        plain = dict(zip(self.y, (sp.Dummy() for _ in self.y), strict=True))  # also of rates
        shared, results = sp.cse(
            [e.xreplace(plain) for e in expressions], sp.numbered_symbols(cls=sp.Dummy)
        )
        arguments = [TIME, *constants, *plain.values(), *(symbol for symbol, _ in shared)]
        parts = [function_of(value, arguments) for _, value in shared]
        ends = [function_of(value, arguments) for value in results]
        numbers = [*constants.values()]

        def slopes(t: float, state: Numbers) -> Numbers:
            values = [t, *numbers, *state.tolist()]
            for part in parts:
                values.append(part(values))
            return np.array([end(values) for end in ends])

        return slopes

    def over_time(self, expressions: Sequence[sp.Expr]) -> Numbers:
        """The values of expressions at all times, (n, len(expressions))."""
        values = {TIME: self.t, **self._constants(expressions)}
        values |= dict(zip(self.y, self.states.T, strict=True))
        columns = [evaluate(e, Floats(np), values) for e in expressions]
        return np.stack(np.broadcast_arrays(self.t, *columns)[1:], axis=1)

    @property
    def omega(self) -> Numbers:
        """Ω′ at all times, (n, 3)."""
        if self.y[-3:] == OMEGA_BODY:
            return self.states[:, -3:]
        step = self.derivation.step("angular_velocity_body")
        return self.over_time([*self.derivation.spelled(step.expression)])


def _integrated(slopes: Slopes, start: Numbers, time: float) -> Numbers | None:
    """The states at all samples; None if steps that are short enough would be too many."""
    before = None
    count = 1
    while count <= _MOST_STEPS:
        try:
            states = _stepped(slopes, start, time / _SAMPLES / count, count)
        except (ArithmeticError, ValueError):  # too long a step has left the domain
            states = None
        if before is not None and states is not None:
            allowed = _SEEN * np.maximum(1e-3, np.ptp(states, axis=0))
            if (np.abs(states - before) <= allowed).all():
                return states
        before, count = states, 2 * count
    return None


def _stepped(slopes: Slopes, y: Numbers, h: float, count: int) -> Numbers:
    states = [y]
    for k in range(_SAMPLES * count):
        t = k * h
        a = slopes(t, y)
        b = slopes(t + h / 2, y + h / 2 * a)
        c = slopes(t + h / 2, y + h / 2 * b)
        d = slopes(t + h, y + h * c)
        y = y + h / 6 * (a + 2 * (b + c) + d)
        if (k + 1) % count == 0:
            states.append(y)
    return np.array(states)


def _over_time(motion: ExampleMotion, letters: Letters, width: float) -> Drawing:
    """The angles that stay within a turn, or the components of Ω′ if there are no angles."""
    model = motion.derivation.model
    if {*model.coordinate_units} == {"rad"}:
        pairs = [*zip(map(letters.name, model.coordinates), motion.states.T, strict=False)]
        pairs = [pair for pair in pairs if np.ptp(pair[1]) < _TURN] or pairs
    else:
        names = (formula_of(omega, letters) for omega in OMEGA_BODY)
        pairs = [*zip(names, motion.omega.T, strict=True)]
    curves = [np.stack([motion.t, column], axis=1) for _, column in pairs]
    names_of = [name for name, _ in pairs]
    return chart(curves, (width, _HEIGHT), formula(r"t / \mathrm{s}"), names=names_of)


def _polhodes(motions: Sequence[ExampleMotion], letters: Letters) -> Drawing:
    """Each on the ellipsoid of its own energy, scaled to one size."""
    roots = np.sqrt(motions[0].over_time([*motions[0].inertia.diagonal()])[0])
    paths = [roots * motion.omega for motion in motions if motion.is_turning]
    paths = [path / np.linalg.norm(path, axis=1, keepdims=True) for path in paths]
    circles = [circle(axis, 0.0) for axis in np.eye(3)]
    axes = [(letters.notation.applied(name), k) for k, name in enumerate(BODY)]
    return on_ellipsoid(paths, circles, roots.min() / roots, axes)


def _axis(motion: ExampleMotion) -> Drawing:
    """The trace of the third axis of the body, with the circles that bound its height."""
    path = motion.over_time([*motion.derivation.model.matrix.col(2)])
    low, high = path[:, 2].min(), path[:, 2].max()
    bounds = [low] if high - low < _LOW else [low, high]
    circles = [circle(np.eye(3)[2], height) for height in (0.0, *bounds)]
    return on_ellipsoid([path], circles, np.ones(3), [(formula("z"), 2)])
