"""The pictures of examples: coordinates in time, and a trace on a sphere, an ellipsoid or a plane.

The equations of motion are integrated in floats by the classical Runge-Kutta method, whose steps
are halved until the picture stays the same.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import chain
from typing import NamedTuple

import sympy as sp

from rigidsym.algebra.evaluate import function_of
from rigidsym.errors import ModelError
from rigidsym.formula.letters import Letters
from rigidsym.formula.reader import formula
from rigidsym.formula.scalars import formula_of
from rigidsym.mechanics.derivation import Derivation
from rigidsym.models.forces import OMEGA_BODY, OMEGA_COMPONENTS, Example, Forces, initial_values
from rigidsym.models.rotation import TIME
from rigidsym.notes.figure.camera import STANDARD, Point, Vector, unit
from rigidsym.notes.figure.chart import Range, chart, circle, in_a_row, on_ellipsoid
from rigidsym.notes.figure.drawing import Drawing
from rigidsym.notes.figure.scene import BODY

Numbers = list[float]

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
    traces: tuple[str, ...]  # "axis", "polhode", "polhodes", "path"


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
    traces = list(_traces(motions, letters))
    drawings = [drawing for _, drawing in traces]
    if not drawings:
        width = _WIDE if len(motions) == 1 else _NARROW
        drawings = [_over_time(motion, letters, width) for motion in motions]
    elif len(drawings) == 1:
        drawings.insert(0, _over_time(motions[0], letters, _NARROW))
    kinds = tuple(dict.fromkeys(kind for kind, _ in traces))
    return MotionPicture(in_a_row(drawings), 1 if first.is_poinsot else len(motions), kinds)


class ExampleMotion:
    """One example, integrated: `states` at the times `t`, each with the place of a particle."""

    def __init__(self, derivation: Derivation, forces: Forces, example: Example) -> None:
        self.derivation, self.forces, self.example = derivation, forces, example
        self.y = derivation.argument("y").symbols
        q = derivation.model.coordinates
        self.known = dict(zip(self.y, (sp.Dummy() for _ in self.y), strict=True))
        slopes = [*derivation.spelled(derivation.step("state_derivative").expression)]
        particles = [part.velocity for part in forces.parts if part.velocity]
        self.path = slice(len(self.y), len(self.y) + 3)
        start = self._start([q.func.__name__ for q in q])
        start += [0.0] * (3 * bool(particles))
        found = _integrated(
            self.function([*slopes, *chain(*particles[:1])], len(start)), start, example.time
        )
        if found is None:
            raise ModelError(
                f"{derivation.name}: an example cannot be drawn; expected a motion that is slower, "
                "shorter, or farther from the poles of the coordinates"
            )
        self.t = [example.time * k / _SAMPLES for k in range(_SAMPLES + 1)]
        self.states: list[Numbers] = found

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
        return any(self.states[0][len(self.derivation.model.coordinates) :])

    def _start(self, coordinates: Sequence[str]) -> Numbers:
        """The initial state in the order of y."""
        given = initial_values(self.derivation.model, self.example.initial)
        wanted = [f"{name}_dot" for name in coordinates]
        if self.y[len(coordinates) :] == OMEGA_BODY:
            wanted = [*OMEGA_COMPONENTS]
        at_rest = not any(v for name, v in given.items() if name not in coordinates)
        missing = [name for name in wanted if name not in given and not at_rest]
        if missing:
            raise ModelError(
                f"{self.derivation.name}: an example begins without {', '.join(missing)}, which "
                "are part of the state"
            )
        return [float(given.get(name, 0.0)) for name in (*coordinates, *wanted)]

    def function(
        self, values: Sequence[sp.Expr], count: int = 0
    ) -> Callable[[float, Numbers], Numbers]:
        """Expressions in the time, the state and constants, as a function of the first two.

        Raises ModelError for constants without a value, all at once.
        """
        plain = [value.xreplace(self.known) for value in values]
        symbols = sp.Tuple(*plain).free_symbols - {*self.known.values(), TIME}
        constants = sorted(symbols, key=str)
        numbers = self.example.parameters
        missing = [symbol.name for symbol in constants if symbol.name not in numbers]
        if missing:
            raise ModelError(
                f"{self.derivation.name}: an example lacks values of {', '.join(missing)}"
            )
        spare = [sp.Dummy() for _ in range(count - len(self.known))]
        arguments = [TIME, *self.known.values(), *spare, *constants]
        shared, results = sp.cse(plain, sp.numbered_symbols(cls=sp.Dummy))
        arguments += [symbol for symbol, _ in shared]
        parts = [function_of(value, arguments) for _, value in shared]
        ends = [function_of(value, arguments) for value in results]
        given = [float(numbers[symbol.name]) for symbol in constants]

        def evaluated(t: float, state: Numbers) -> Numbers:
            held = [t, *state, *given]
            for part in parts:
                held.append(part(held))
            return [end(held) for end in ends]

        return evaluated

    def over_time(self, values: Sequence[sp.Expr]) -> list[Numbers]:
        """The values at all times."""
        function = self.function(values, len(self.states[0]))
        return [function(t, state) for t, state in zip(self.t, self.states, strict=True)]

    @property
    def omega(self) -> list[sp.Expr]:
        """Ω′ in the state."""
        if self.y[-3:] == OMEGA_BODY:
            return list(OMEGA_BODY)
        return [*self.derivation.spelled(self.derivation.step("angular_velocity_body").expression)]


def _integrated(
    slopes: Callable[[float, Numbers], Numbers], start: Numbers, time: float
) -> list[Numbers] | None:
    """The states at all samples; None if steps that are short enough would be too many."""
    before = None
    count = 1
    while count <= _MOST_STEPS:
        try:
            found = _stepped(slopes, start, time, count)
        except (ArithmeticError, ValueError):  # too long a step has left the domain
            found = None
        if before and found and _is_same(before, found):
            return found
        before, count = found, 2 * count
    return None


def _stepped(
    slopes: Callable[[float, Numbers], Numbers], start: Numbers, time: float, count: int
) -> list[Numbers]:
    h = time / _SAMPLES / count
    found, y = [start], start
    for k in range(_SAMPLES * count):
        t = k * h
        a = slopes(t, y)
        b = slopes(t + h / 2, [u + h / 2 * v for u, v in zip(y, a, strict=True)])
        c = slopes(t + h / 2, [u + h / 2 * v for u, v in zip(y, b, strict=True)])
        d = slopes(t + h, [u + h * v for u, v in zip(y, c, strict=True)])
        rates = zip(y, a, b, c, d, strict=True)
        y = [u + h / 6 * (p + 2 * (q + r) + s) for u, p, q, r, s in rates]
        if (k + 1) % count == 0:
            found.append(y)
    return found


def _is_same(one: Sequence[Numbers], other: Sequence[Numbers]) -> bool:
    """Whether no value differs by more than is seen."""
    for left, right in zip(zip(*one, strict=True), zip(*other, strict=True), strict=True):
        allowed = _SEEN * max(1e-3, max(right) - min(right))
        if any(not abs(a - b) <= allowed for a, b in zip(left, right, strict=True)):
            return False
    return True


def _over_time(motion: ExampleMotion, letters: Letters, width: float) -> Drawing:
    """The angles that stay within a turn, or the components of Ω′ if there are no angles."""
    q = motion.derivation.model.coordinates
    is_in_angles = set(motion.derivation.model.coordinate_units) == {"rad"}
    if is_in_angles:
        names = [letters.name(x) for x in q]
        columns = list(zip(*(state[: len(q)] for state in motion.states), strict=True))
        swinging = [k for k, c in enumerate(columns) if max(c) - min(c) < _TURN]
        shown = [(names[k], columns[k]) for k in swinging or range(len(q))]
    else:
        names = [formula_of(omega, letters) for omega in OMEGA_BODY]
        columns = list(zip(*motion.over_time(motion.omega), strict=True))
        shown = list(zip(names, columns, strict=True))
    curves = [(name, list(zip(motion.t, column, strict=True))) for name, column in shown]
    across = Range.of([0.0, motion.t[-1]])
    return chart(across, curves, (width, _HEIGHT), formula(r"t / \mathrm{s}"))


def _traces(motions: Sequence[ExampleMotion], letters: Letters) -> Iterator[tuple[str, Drawing]]:
    """What is traced, with its drawing."""
    first = motions[0]
    turns = first.derivation.model.turns
    if first.is_poinsot:
        yield "polhode" if len(motions) == 1 else "polhodes", _polhodes(motions, letters)
        motions = motions[:1]
    if any(part.velocity for part in first.forces.parts):
        yield from (("path", _path(motion)) for motion in motions)
    elif turns and turns[-1].axis == "z":
        yield from (("axis", _axis(motion)) for motion in motions)


def _polhodes(motions: Sequence[ExampleMotion], letters: Letters) -> Drawing:
    """Each on the ellipsoid of its own energy, scaled to one size."""
    first = motions[0]
    moments = first.function([*first.inertia.diagonal()], len(first.states[0]))
    a, b, c = (moment**0.5 for moment in moments(0.0, first.states[0]))
    least = min(a, b, c)
    paths = [
        [unit((a * x, b * y, c * z)) for x, y, z in motion.over_time(motion.omega)]
        for motion in motions
        if motion.is_turning
    ]
    circles = [circle(axis, 0.0) for axis in STANDARD]
    axes = [(letters.notation.applied(name), k) for k, name in enumerate(BODY)]
    return on_ellipsoid(paths, circles, (least / a, least / b, least / c), axes)


def _axis(motion: ExampleMotion) -> Drawing:
    """The trace of the third axis of the body, with the circles that bound its height."""
    path: list[Vector] = [
        (x, y, z) for x, y, z in motion.over_time([*motion.derivation.model.matrix.col(2)])
    ]
    heights = [z for _, _, z in path]
    low, high = min(heights), max(heights)
    bounds = [low] if high - low < _LOW else [low, high]
    circles = [circle(STANDARD[2], height) for height in (0.0, *bounds)]
    return on_ellipsoid([path], circles, (1.0, 1.0, 1.0), [(formula("z"), 2)])


def _path(motion: ExampleMotion) -> Drawing:
    """The path of the particle, from above, in one scale."""
    points: list[Point] = [(x, y) for x, y, _ in (state[motion.path] for state in motion.states)]
    xs, ys = zip(*points, strict=True)
    across, up = Range.of(xs), Range.of(ys)
    scale = min(_NARROW / (across.high - across.low), _HEIGHT / (up.high - up.low))
    size = (scale * (across.high - across.low), scale * (up.high - up.low))
    return chart(across, [(formula(r"y / \mathrm{m}"), points)], size, formula(r"x / \mathrm{m}"))
