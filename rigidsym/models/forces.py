"""What acts on a body that turns about a fixed point, what moves with it, and motions with numbers.

A note draws the examples, and `simulate` begins with the first.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from difflib import get_close_matches
from math import isfinite
from numbers import Real
from types import MappingProxyType
from typing import Any, NamedTuple

import sympy as sp
from sympy.core.function import AppliedUndef

from rigidsym.algebra.generators import TIME
from rigidsym.errors import ModelError, offer
from rigidsym.models.body import BodyDescription, Parameter, RigidBody
from rigidsym.models.library import rotation_from
from rigidsym.models.rotation import OMEGA_BODY, RotationModel, as_typed, depends_on_time, symbolic
from rigidsym.system.records import Record
from rigidsym.text.expression import names_in, parse_expression
from rigidsym.text.names import check_name

OMEGA = "angular_velocity_body"
OMEGA_COMPONENTS = (f"{OMEGA}_1", f"{OMEGA}_2", f"{OMEGA}_3")


class Example(NamedTuple):
    """One motion; SI units, angles in radians."""

    parameters: Mapping[str, float]
    initial: Mapping[str, float]  # coordinates, and rates or components of Ω′, by name
    time: float  # s


def examples_of(model: RotationModel, examples: Sequence[Mapping[str, Any]]) -> Iterator[Example]:
    """The examples in their order; each takes from the first what it does not name.

    Raises ModelError for a key or an initial value that does not exist, and for no time.
    """
    names = [q.func.__name__ for q in model.coordinates]
    initials = (*names, *(f"{name}_dot" for name in names), *OMEGA_COMPONENTS)
    first: Mapping[str, Any] = {"time": 0}
    for k, example in enumerate(examples):
        for key in set(example) - set(Example._fields):
            raise ModelError(
                f"an example: unknown key {key}; expected {', '.join(Example._fields)}"
            )
        parameters, initial = (
            {**first.get(key, {}), **example.get(key, {})} for key in Example._fields[:2]
        )
        motion = Example(parameters, initial, example.get("time", first["time"]))
        for name in initial:
            if name not in initials:
                raise ModelError(
                    f"an example: unknown initial value {name}; {offer(name, initials)}"
                )
        numbers: list[Any] = [*parameters.values(), *initial.values(), motion.time]
        are_finite = all(isinstance(value, Real) and isfinite(value) for value in numbers)
        if not are_finite or motion.time <= 0:
            raise ModelError("an example needs finite numbers, and a time > 0 in seconds")
        first = first if k else motion._asdict()
        yield motion


def initial_values(model: RotationModel, values: Mapping[str, Any]) -> dict[str, Any]:
    """All coordinates, and all rates or components of Ω′: no rotation, at rest, by default."""
    names = [q.func.__name__ for q in model.coordinates]
    start: dict[str, Any] = dict.fromkeys(names, 0.0)
    if start.keys().isdisjoint(values):
        start = no_rotation(model)
    turning = [f"{name}_dot" for name in names]
    if not set(OMEGA_COMPONENTS).isdisjoint(values):
        turning = list(OMEGA_COMPONENTS)
    return {**start, **dict.fromkeys(turning, 0.0), **values}


def no_rotation(model: RotationModel) -> dict[str, float]:
    """Coordinates of R = 1: all 0, or one of them 1."""
    q = model.coordinates
    # Angles and vectors vanish for R = 1, which is the case place = −1. A quaternion
    # has its scalar at one, wherever that stands among the coordinates.
    for place in range(-1, len(q)):
        values = {x: sp.S.One if k == place else sp.S.Zero for k, x in enumerate(q)}
        if model.matrix.xreplace(values) == sp.eye(3):
            return {x.func.__name__: float(value) for x, value in values.items()}
    # The nine entries of R itself are those of 1; the rotation vector has no value at 0, but is 0.
    start = map(float, sp.eye(3)) if [*model.matrix] == [*q] else (0.0 for _ in q)
    return dict(zip((x.func.__name__ for x in q), start, strict=True))


METHODS = ("lagrange", "euler")
_LONG, _ALIKE = 4, 0.8  # letters of a name, and the share that two names have in common
_OF_MOTION = (  # names of quantities, which are no constants
    r"(?i)(angular_(velocity|acceleration|momentum)|(omega|alpha)(?=_[sb]))(_space|_body)?(_?\d)?"
    r"|((kinetic|potential|rotational|translational)_)?energy|rotation_matrix(_?[123]{2})?"
    r"|generalised_momenta|lagrangian|hamiltonian|(quaternion|torque_body)(_?[0123])?"
)
_MOMENT = "principal moment of inertia"
_NONE: Mapping[Any, sp.Expr] = MappingProxyType({})
CENTRE = "centre_of_mass"


class MovingPart(NamedTuple):
    """What moves with the body: another body that turns about the fixed point, or a particle.

    Of a body, its rotation, in some of the same coordinates, and its principal moments; of a
    particle, its velocity in space, linear in the rates, and its mass three times.
    """

    rotation: RotationModel | None
    velocity: tuple[sp.Expr, ...]  # (3,) or none
    inertia: tuple[sp.Expr, ...]  # (3,), kg m² or kg


class Forces(Record, kw_only=True):
    """A potential energy V(q, t), in joules, and generalised forces Q by coordinate, in N m.

    Symbols that are no coordinates are constants; they become parameters of the body. Forces may
    depend on the rates as well, and the torque on Ω′ by the symbols OMEGA_BODY; both on the time.
    """

    potential: sp.Expr = sp.S.Zero
    generalised: Mapping[sp.Expr, sp.Expr] = field(default_factory=lambda: _NONE)
    torque: tuple[sp.Expr, ...] = ()  # N′ beside them, in body components, N m; three or none
    first_integrals: Mapping[str, sp.Expr] = field(default_factory=lambda: _NONE)  # claimed
    method: str = ""  # one of METHODS; "": Lagrange's where the coordinates are free
    parts: tuple[MovingPart, ...] = ()
    # (3,), m, in components of the description; () for the centre of mass; None: not stated
    fixed_point: tuple[sp.Expr, ...] | None = None
    examples: tuple[Example, ...] = ()  # motions with numbers

    def leave_free(self, model: RotationModel) -> bool:
        """Whether nothing acts on a body that can turn in every way, and nothing moves with it."""
        acting = [*self.generalised.values(), *self.torque, *self.parts]
        # A constant potential exerts no force. With fewer than three coordinates, the joint exerts
        # torques even on a body on which nothing else acts.
        acting += [sp.diff(self.potential, q) for q in model.coordinates]
        return not any(acting) and len(model.coordinates) >= len(OMEGA_BODY)

    @property
    def depend_on_time(self) -> bool:
        """Whether the time occurs by itself in what acts, or in a claimed first integral."""
        return any(map(depends_on_time, self.expressions))

    def map(self, function: Callable[[sp.Expr], sp.Expr]) -> Forces:
        """The forces with a function of each expression in its place."""

        def each(values: Iterable[sp.Expr]) -> tuple[sp.Expr, ...]:
            return tuple(map(function, values))

        return replace(
            self,
            potential=function(self.potential),
            generalised={q: function(force) for q, force in self.generalised.items()},
            torque=each(self.torque),
            fixed_point=self.fixed_point and each(self.fixed_point),
            first_integrals={name: function(e) for name, e in self.first_integrals.items()},
            parts=tuple(
                part._replace(velocity=each(part.velocity), inertia=each(part.inertia))
                for part in self.parts
            ),
        )

    def in_symbols_of(self, body: RigidBody) -> Forces:
        """With the symbols of the body where names are the same: m for a positive m."""
        own = {parameter.symbol.name: parameter.symbol for parameter in body.parameters}
        # SymPy distinguishes a positive m from one without assumptions, though both print as m.
        return self.map(
            lambda e: e.xreplace({s: own[s.name] for s in e.free_symbols if s.name in own})
        )

    def with_parameters(self, body: RigidBody, model: RotationModel) -> RigidBody:
        """The body with the constants of the forces among its parameters.

        Raises ModelError for a fixed point that is not stated, and for an example with a value of
        another constant.
        """
        check_fixed_point(body, self.fixed_point)
        bound = {p.symbol for p in body.parameters} | {*model.constants, *OMEGA_BODY, TIME}
        symbols = set().union(*(expression.free_symbols for expression in self.expressions)) - bound
        constants = {str(symbol) for symbol in (bound | symbols) - {*OMEGA_BODY, TIME}}
        of_examples = {name for example in self.examples for name in example.parameters}
        for name in sorted(of_examples - constants):
            raise ModelError(
                f"an example: unknown parameter {name}; {offer(name, sorted(constants))}"
            )
        about = {
            m: _MOMENT if part.rotation else "mass of a particle"
            for part in self.parts
            for m in part.inertia
        }
        declared = {p.symbol: p for p in body.declared}
        more = (
            (declared.get(s) or Parameter(symbol=s, positive=False)).described_by(about.get(s, ""))
            for s in sp.ordered(symbols)
        )
        example = self.examples[0].parameters if self.examples else {}
        return replace(body, parameters=(*body.parameters, *more), example=example)

    @property
    def expressions(self) -> Iterator[sp.Expr]:
        """All that acts, all that is claimed to be constant, and the parts."""
        yield from (self.potential, *self.generalised.values(), *self.torque)
        yield from (*self.first_integrals.values(), *self.of_parts, *(self.fixed_point or ()))

    @property
    def of_parts(self) -> Iterator[sp.Expr]:
        return (e for part in self.parts for e in (*part.velocity, *part.inertia))


def forces_on(
    model: RotationModel,
    *,
    potential: sp.Expr | str | int = 0,
    forces: Mapping[str, sp.Expr | str] = MappingProxyType({}),
    torque: Sequence[sp.Expr | str] = (),
    first_integrals: Mapping[str, sp.Expr | str] = MappingProxyType({}),
    parts: Sequence[Mapping[str, Any]] = (),
    fixed_point: Sequence[sp.Expr | str | float] | str | None = None,
    method: str = "",
    examples: Sequence[Mapping[str, Any]] = (),
) -> Forces:
    """What acts on a body, by the keys of [dynamics]; texts are read as in a file.

    In a text `theta_dot` is the rate of theta, `omega_body_1`, or its long name, a component of Ω′
    and `t` the time; other names are constants. Raises ModelError for a force on
    what is no coordinate, for a potential that depends on the rates or on no coordinate, for a
    constant with the name of a quantity or nearly that of a rate, for parts and examples that are
    none, and for parts that depend on the time; ExpressionError for a text that cannot be read.
    """
    coordinates = {q.func.__name__: q for q in model.coordinates}
    names = coordinates | {f"{name}_dot": sp.diff(q, TIME) for name, q in coordinates.items()}
    for spelling in (OMEGA_COMPONENTS, ("omega_body_1", "omega_body_2", "omega_body_3")):
        names |= zip(spelling, OMEGA_BODY, strict=True)
    names["t"] = TIME
    for name in forces:
        if name not in coordinates:
            raise ModelError(
                f"a force on {name}, which is not a coordinate; expected {', '.join(coordinates)}"
            )
    if len(torque) not in (0, 3):
        raise ModelError(f"torque: expected three components, got {len(torque)}")
    if method not in ("", *METHODS):
        raise ModelError(f"no method {method!r}; {offer(method, METHODS)}")
    acting = Forces(
        potential=_read(potential, names),
        generalised={coordinates[name]: _read(force, names) for name, force in forces.items()},
        torque=tuple(_read(component, names) for component in torque),
        first_integrals={n: _read(value, names) for n, value in first_integrals.items()},
        method=method,
        parts=tuple(_part(part, names) for part in parts),
        fixed_point=None if fixed_point is None else _point(fixed_point, names),
        examples=tuple(examples_of(model, examples)),
    )
    depends = f"the potential {as_typed(acting.potential)} depends on"
    if acting.potential.has(sp.Derivative, *OMEGA_BODY):
        raise ModelError(f"{depends} rates; expected V(q, t)")
    if acting.potential.free_symbols and not acting.potential.has(*model.coordinates):
        plain = [*map(as_typed, model.coordinates)]
        own = sorted(symbol.name for symbol in acting.potential.free_symbols)
        near = [name for each in own for name in get_close_matches(each, plain, n=1)]
        hint = f" (did you mean {near[0]}?)" if near else ""
        remedy = f"expected one of them{hint}, or no potential: a constant exerts no force"
        if name := next(filter(plain.__contains__, own), ""):
            remedy = f"{name} is a symbol here; expected a text, or the function {name}(t)"
        raise ModelError(f"{depends} none of the coordinates {', '.join(plain)}; {remedy}")
    for expression in acting.of_parts:
        what = "t" if depends_on_time(expression) else "Ω′"
        if what == "t" or expression.has(*OMEGA_BODY):
            raise ModelError(
                f"{as_typed(expression)} depends on {what}; expected a part that does not"
            )
    return acting


def check_fixed_point(body: RigidBody | BodyDescription, point: object) -> None:
    """Raises ModelError if none is stated for a body whose description has a centre of mass.

    A tensor by itself is about the fixed point.
    """
    if point is None and not body.is_tensor:
        raise ModelError(
            "no fixed point, and the body has a centre of mass, which may be elsewhere; expected "
            f'fixed_point = [0, 0, 0] or another point of its description, or "{CENTRE}"'
        )


def _part(entry: Mapping[str, Any], names: Mapping[str, sp.Expr]) -> MovingPart:
    """Another body, {"rotation", "principal_moments"}, or a particle, {"velocity", "mass"}."""
    velocity: Sequence[Any] = ()
    rotation = None
    if entry.keys() == {"rotation", "principal_moments"}:
        rotation = rotation_from(entry["rotation"])
        strange = [str(q.func) for q in rotation.coordinates if q not in names.values()]
        if strange:
            raise ModelError(f"a part turns by {strange[0]}, which is not a coordinate of the body")
        inertia = entry["principal_moments"]
    elif entry.keys() == {"velocity", "mass"}:
        # T = ½ m v² = ½ vᵀ diag(m, m, m) v has the form of ½ Ω′ᵀ I′ Ω′, so one formula serves both.
        velocity, inertia = entry["velocity"], [entry["mass"]] * 3
    else:
        raise ModelError(
            f"a part with {', '.join(entry) or 'nothing'}; expected rotation and "
            "principal_moments, or velocity and mass"
        )
    if len(inertia) != 3 or len(velocity) not in (0, 3):
        raise ModelError(
            "a part: expected three principal moments, or three components of velocity"
        )
    return MovingPart(
        rotation=rotation,
        velocity=tuple(_read(component, names) for component in velocity),
        inertia=tuple(_read(moment, names) for moment in inertia),
    )


def _point(stated: object, names: Mapping[str, sp.Expr]) -> tuple[sp.Expr, ...]:
    """Three constants, or none for the centre of mass."""
    expected = f'expected three constants or "{CENTRE}" for a fixed point, got {stated!r}'
    if isinstance(stated, str):
        if stated != CENTRE:
            raise ModelError(expected)
        return ()
    parts = [*stated] if isinstance(stated, Iterable) else []
    point = tuple(_read(part, names) for part in parts)
    if len(point) != 3 or any(x.has(TIME, AppliedUndef, *OMEGA_BODY) for x in point):
        raise ModelError(expected)
    return point


def _read(value: sp.Expr | str | float, names: Mapping[str, sp.Expr]) -> sp.Expr:
    if isinstance(value, float):
        if not isfinite(value):
            raise ModelError(f"expected a finite number, got {value}")
        value = str(value)  # 0.1 is 1/10
    if isinstance(value, str):
        for name in set(names_in(value)) - set(names):
            _check_spelling(name, names)
        used = {name: names.get(name) or sp.Symbol(check_name(name)) for name in names_in(value)}
        value = parse_expression(value, used)
    # The ring knows (√x²)² = x² and the rate x ẋ/√x², and of |x| nothing.
    return symbolic(value, "a potential or a force").replace(sp.Abs, lambda x: sp.sqrt(x**2))


def _check_spelling(name: str, names: Mapping[str, sp.Expr]) -> None:
    """Raises ModelError for a constant whose name is that of a quantity, or all but a known one."""
    # thetadot and Theta_dot are meant for theta_dot. As constants they would turn a force that
    # damps into one that does not, without an error.
    plain = name.replace("_", "").lower()
    # Names of digits differ by intention, theta_1 and theta_2, so only names of letters are
    # compared by their likeness.
    near = [other for other in names if other.replace("_", "").lower() == plain != other]
    if len(name) >= _LONG and not any(letter.isdigit() for letter in name):
        near += get_close_matches(name, names, n=1, cutoff=_ALIKE)
    if near and len(plain) > 1:  # T may be a constant beside the time t
        raise ModelError(f"unknown name {name}; did you mean {near[0]}?")
    if re.fullmatch(_OF_MOTION, name):
        raise ModelError(
            f"{name} is a quantity, not a constant; expected coordinates, rates (theta_dot), "
            "components of Ω′ (omega_body_1) and constants"
        )
