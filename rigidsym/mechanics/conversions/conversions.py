"""Coordinates, the unit quaternion and R from each other: with proofs, and as functions.

A quaternion p is scalar first here, (p_0, p_1, p_2, p_3); only the results for a model with a
scalar-last quaternion have its order. It represents R, which turns the body, even if a model
presents the transpose.

Each kind of rotation, the 24 Euler conventions and the named parametrisations, has a rule. A model
is recognised by its turns, or by its matrix and its constraints, not by its name: your own R(q)
that is a rotation vector converts as one. The sentences are in
templates/notes/en/conversions.toml.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property, reduce
from itertools import chain
from typing import Any

import sympy as sp

from rigidsym.algebra.codec import codec_for
from rigidsym.algebra.matrix import RingMatrix
from rigidsym.algebra.present import presenter_for
from rigidsym.errors import AlgebraError
from rigidsym.formula.reader import Sentence, formula, named, sentence, text_of
from rigidsym.formula.tree import Formula
from rigidsym.mechanics.conversions.function import (
    MATRIX,
    PARTS,
    SHEPPERD,
    Continuity,
    ConversionFunction,
    Converted,
    NamedValues,
    Vector,
    Where,
    half_turn,
    outer_product,
    product,
    shepperd,
    short_way,
    square,
)
from rigidsym.mechanics.derivation import Derivation, Proof, Quantity, Step, argument, phrases, when
from rigidsym.mechanics.prove import Prover
from rigidsym.models.parametrisations import PARAMETRISATIONS, parametrised
from rigidsym.models.rotation import AXES, SOURCES, RotationModel, rotation_of
from rigidsym.system.records import Record

Claim = tuple[tuple[sp.Expr, ...], Formula]  # what vanishes, and how it is written
Way = Callable[[NamedValues, Vector], Vector]
WORDS = phrases("conversions")
LONGEST_CHAIN = 4  # turns whose product is written out: its terms double with each
_QUATERNION = Quantity(
    name="quaternion",
    symbol=formula(r"\p"),
    inputs=("q",),
    shape="vector",
    source=SOURCES["Shuster"],
    variants=(when("last", meaning="quaternion_scalar_last"),),
)


def vanishing(model: RotationModel, claims: Sequence[Claim]) -> tuple[Proof, ...]:
    """Proofs that the residuals of each claim reduce to zero in the ring of the model."""
    if not claims:
        return ()
    residuals = [residual for parts, _ in claims for residual in parts]
    codec = codec_for([*model.matrix, *residuals], constraints=model.constraints, order=0)
    prove = Prover(model, codec)
    return tuple(prove.vanishes(codec.column(parts), text) for parts, text in claims)


class Rule(Record, kw_only=True):
    """The coordinates from a quaternion of any length but zero, and perhaps the way there.

    Quaternions are scalar first, and coordinates in the order of their kind.
    """

    model: RotationModel
    kind: str = "euler"  # or the name of a parametrisation
    order: tuple[int, ...]  # place, among the model's coordinates, of each of them
    back: Way  # from a quaternion whose parts are not too small or large to be squared
    claims: tuple[Claim, ...] = ()  # what the ring of the model has to decide
    quaternion: Vector = ()  # in closed form, of length one
    halves: Callable[[Vector], Vector] | None = None  # of Euler angles: a₀ to a₃
    forward: Way | None = None  # to the quaternion, if its closed form is none or loses digits
    quarters: int = 0  # of Euler angles: the quarter turns from the middle angle 0 to a pole

    @property
    def scalar(self) -> str:
        """Whether quaternions are (w, x, y, z) or (x, y, z, w): as the coordinates are."""
        return "last" if "quaternion" in self.kind and self.order[0] == 3 else "first"

    def listed(self, quaternion: Sequence[Any]) -> tuple[Any, ...]:
        """A quaternion (w, x, y, z) in the order of the model."""
        first, *vector = quaternion
        return (*vector, first) if self.scalar == "last" else (first, *vector)

    @property
    def words(self) -> Mapping[str, str]:
        words: Mapping[str, str] = WORDS[self.kind]
        return words

    @property
    def because(self) -> Sentence:
        """How the coordinates follow."""
        return sentence(self.words["backward"])

    @property
    def branch(self) -> Sentence:
        """Which of the possible coordinates are given."""
        if self.kind != "euler":
            return sentence(self.words["choice"])
        names = [named(q.func.__name__) for q in self.model.coordinates]
        first, middle, third = (names[place] for place in self.order)
        interval = "[−π/2, π/2]" if self.quarters else "[0, π]"
        typed = self.words["choice"].replace("INTERVAL", interval)
        return sentence(typed, *(first, third, middle, first, third, names[2]))

    @cached_property
    def proofs(self) -> tuple[Proof, ...]:
        return vanishing(self.model, self.claims)

    def from_quaternion(self, values: NamedValues, quaternion: Vector) -> Vector:
        """The coordinates, in the order of the model."""
        placed = dict(zip(self.order, self.back(values, quaternion), strict=True))
        return tuple(placed[place] for place in range(len(placed)))

    def from_matrix(self, values: NamedValues, matrix: sp.Matrix) -> Vector:
        if self.kind == "direction_cosines":
            return tuple(matrix[place] for place in self.order)
        parts = shepperd(values, matrix)
        short = short_way(values, parts) if "quaternion" in self.kind else parts
        return self.from_quaternion(values, short)


def rule_of(model: RotationModel) -> Rule | None:
    """The rule of a model; None if its coordinates do not follow in closed form."""
    for kind, entry in PARAMETRISATIONS.items():
        count = len(entry.coordinates.split())
        orders = [tuple(range(count)), *([(3, 0, 1, 2)] if count == 4 else [])]  # scalar last
        for order in orders if count == len(model.coordinates) else ():
            q = tuple(model.coordinates[place] for place in order)
            known = parametrised(kind, [part.func.__name__ for part in q])
            if known.matrix == model.matrix and known.constraints == model.constraints:
                return Rule(model=model, kind=kind, order=order, **_PARTS[kind](q))
    angles = tuple(turn.angle for turn in model.turns)
    if len(angles) != 3 or sorted(angles, key=str) != sorted(model.coordinates, key=str):
        return None
    first, second, third = (turn.axis for turn in model.turns)
    if second in (first, third) or not {first, second, third} <= {*AXES}:
        return None
    return _of_euler_angles(model, tuple(map(model.coordinates.index, angles)))


# Three turns about coordinate axes. With e₁, e₂ the first two axes and C the fixed turn about e₂
# that takes e₁ to the third axis (none for ZXZ, a quarter turn for ZYX), R C = R₁(α) R₂(β') R₁(γ):
# two turns about one axis with a turn across between them. In the frame e₁, e₂, e₁ × e₂ its
# quaternion is cos(β'/2) (cos σ, sin σ) and sin(β'/2) (cos δ, sin δ), with σ = (α + γ)/2 and
# δ = (α − γ)/2. So nothing cancels where β' is near 0 or π, which are the poles.


def _of_euler_angles(model: RotationModel, order: tuple[int, ...]) -> Rule:
    first, second, third = (sp.Matrix(turn.direction) for turn in model.turns)
    quarters = -int(first.cross(third).dot(second))
    other = -1 if order[0] == 2 else 1
    sign = -1 if quarters > 0 else 1  # of the middle angle and of e₂, so that β' is in [0, π]
    second *= sign
    frame = sp.diag(1, sp.Matrix.hstack(first, second, first.cross(second)).T)
    # parallel to (cos λ/2, sin λ/2) for the angle λ of C, without a root
    along, across = sp.Integer(1), abs(quarters)

    def in_frame(quaternion: Vector) -> Vector:
        """The components of p (1 + C) in the frame."""
        turned = sp.Matrix(product(quaternion, (along, *(across * second))))
        return tuple(map(sp.expand, frame * turned))

    def halves(quaternion: Vector) -> Vector:
        """The same in the order of the model: with −δ for δ, the outer angles change places."""
        *parts, last = in_frame(quaternion)
        return (*parts, other * last)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        a = values.each(("a0", "a1", "a2", "a3"), in_frame(quaternion))
        # a = κ (cos β'/2 cos σ, cos β'/2 sin σ, sin β'/2 cos δ, sin β'/2 sin δ), κ > 0. So β' is
        # twice the angle of (far, near), and α = σ + δ and γ = σ − δ are the angles of the complex
        # numbers (a₀ + i a₁)(a₂ ± i a₃), which need no wrapping as sums of angles would.
        far, near = values.length("far", a[:2]), values.length("near", a[2:])
        # Where a half of the quaternion vanishes, its angle is taken to be the other's, or minus
        # it, so that the last coordinate is zero, whether it is the first turn's or the third's.
        is_low, is_high = near <= values.tiny * far, far <= values.tiny * near
        c = values.let("a0", Where(is_high, a[2], a[0]))
        s = values.let("a1", Where(is_high, other * a[3], a[1]))
        u = values.let("a2", Where(is_low, a[0], a[2]))
        v = values.let("a3", Where(is_low, other * a[1], a[3]))
        # The arc tangent keeps its digits near both poles, where an arc cosine would lose half of
        # them.
        middle = 2 * sp.atan2(near, far) - quarters_in_radians
        first = values.angle("first", s * u + c * v, c * u - s * v)
        last = values.angle("last", s * u - c * v, c * u + s * v)
        return first, sign * middle, last

    quarters_in_radians = sp.Float(float(sp.pi / 2)) if quarters else sp.S.Zero
    alpha, beta, gamma = (turn.angle for turn in model.turns)
    half, sigma, delta = sign * beta / 2, (alpha + gamma) / 2, (alpha - gamma) / 2
    # β' = ±β + λ: cos(β/2 + λ/2) and sin(β/2 + λ/2) by addition, times the factor that `along` and
    # `across` leave out.
    cosine = along * sp.cos(half) - across * sp.sin(half)
    sine = along * sp.sin(half) + across * sp.cos(half)
    expected = (
        (cosine * sp.cos(sigma), r"\cos#\,\cos\sigma"),
        (cosine * sp.sin(sigma), r"\cos#\,\sin\sigma"),
        (sine * sp.cos(delta), r"\sin#\,\cos\delta"),
        (sine * sp.sin(delta), r"\sin#\,\sin\delta"),
    )
    parts = in_frame(reduce(product, (half_turn(t.direction, t.angle) for t in model.turns)))
    claims = tuple(
        ((part - value,), formula(rf"a_{k} = \kappa\," + text.replace("#", r"\frac{\beta'}{2}")))
        for k, (part, (value, text)) in enumerate(zip(parts, expected, strict=True))
    )
    return Rule(
        model=model, order=order, back=back, halves=halves, claims=claims, quarters=quarters
    )


# Parametrisations: the parts of their rules. Nothing cancels on the way back.


def _along(factor: sp.Expr, vector: Sequence[sp.Expr]) -> Vector:
    return tuple(factor * part for part in vector)


def _equal(text: str, first: Sequence[sp.Expr], second: Sequence[sp.Expr]) -> Claim:
    return tuple(a - b for a, b in zip(first, second, strict=True)), formula(text)


def _unit(values: NamedValues, quaternion: Vector) -> Vector:
    """The quaternion over its length."""
    return _along(1 / values.length("length", quaternion), quaternion)


def _length(values: NamedValues, vector: Vector) -> tuple[sp.Basic, sp.Expr]:
    """Whether a vector vanishes, and its length, or one: a root of zero has no derivative."""
    size = values.let("square", square(vector))
    none = sp.Eq(size, 0)
    return none, values.let("length", sp.sqrt(Where(none, sp.S.One, size)))


def _quaternion(q: Vector) -> dict[str, Any]:
    size = sp.sqrt(square(q))
    p = _along(1 / size, q)
    claims = (_equal(r"|\q|\,\p = \q", _along(size, p), q),)
    return {
        "quaternion": p,
        "claims": claims,
        "back": _unit,
        "forward": lambda values, q: _unit(values, values.scaled(q)),
    }


def _unit_quaternion(q: Vector) -> dict[str, Any]:
    claims = (_equal(r"\q\cdot\q = 1", [square(q)], [sp.S.One]),)
    return {"quaternion": q, "claims": claims, "back": _unit}


def _axis_angle(q: Vector) -> dict[str, Any]:
    *axis, angle = q
    half = sp.sin(angle / 2)
    vector = _along(half, axis)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        # p = (cos φ/2, sin φ/2 e) gives φ = 2 atan2(|p_v|, p_0) in [0, π], and e = p_v/|p_v|.
        # Without a rotation any axis will do, and x is taken.
        w, x, y, z = short_way(values, quaternion)
        none, length = _length(values, (x, y, z))
        first = values.let("axis_x", Where(none, sp.S.One, x / length))
        return first, y / length, z / length, 2 * sp.atan2(Where(none, sp.S.Zero, length), w)

    claims = (
        _equal(r"\p_v = \sin\tfrac{\varphi}{2}\,\mathbf{e}", vector, vector),
        _equal(r"|\p_v|^2 = \sin^2\tfrac{\varphi}{2}", [square(vector)], [half**2]),
    )
    return {"quaternion": (sp.cos(angle / 2), *vector), "claims": claims, "back": back}


def _rotation_vector(q: Vector) -> dict[str, Any]:
    angle = sp.sqrt(square(q))
    half = sp.sin(angle / 2)
    vector = _along(half / angle, q)

    def forward(values: NamedValues, q: Vector) -> Vector:
        """Where n² is too small for a float, sin(n/2)/n is 1/2."""
        none, length = _length(values, q)
        factor = values.let("factor", Where(none, sp.S.Half, sp.sin(length / 2) / length))
        return Where(none, sp.S.One, sp.cos(length / 2)), *_along(factor, q)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        # v = 2 atan2(|p_v|, p_0) p_v/|p_v|, and the limit 2 p_v/p_0 as p_v vanishes.
        w, *parts = short_way(values, quaternion)
        none, length = _length(values, tuple(parts))
        limit = 2 / Where(sp.Eq(w, 0), sp.S.One, w)
        factor = values.let("factor", Where(none, limit, 2 * sp.atan2(length, w) / length))
        return _along(factor, parts)

    claims = (
        _equal(r"n\,\p_v = \sin\tfrac{n}{2}\,\v", _along(angle, vector), _along(half, q)),
        _equal(r"|\p_v|^2 = \sin^2\tfrac{n}{2}", [square(vector)], [half**2]),
    )
    p = (sp.cos(angle / 2), *vector)
    return {"quaternion": p, "claims": claims, "forward": forward, "back": back}


def _gibbs_vector(q: Vector) -> dict[str, Any]:
    # g = e tan(β/2) = p_v/p_0. After a half turn p_0 = 0: the components become infinite, but a
    # component that vanishes stays 0, and is not NaN.
    p = _along(1 / sp.sqrt(1 + square(q)), (sp.S.One, *q))

    def back(_: NamedValues, quaternion: Vector) -> Vector:
        w, *vector = quaternion
        return tuple(x / Where(sp.Eq(w, 0), Where(sp.Eq(x, 0), sp.S.One, w), w) for x in vector)

    claims = (_equal(r"p_0\,\g = \p_v", _along(p[0], q), p[1:]),)
    return {"quaternion": p, "claims": claims, "back": back}


def _modified_rodrigues(q: Vector) -> dict[str, Any]:
    size = square(q)
    # s = e tan(β/4), so by the half-angle formulas
    # p_0 = (1 − s·s)/(1 + s·s) and p_v = 2 s/(1 + s·s).
    scalar, vector = (1 - size) / (1 + size), _along(2 / (1 + size), q)

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        # s = p_v/(|p| + p_0) with p_0 ≥ 0: nothing cancels in the divisor, and |s| is at most 1.
        parts = short_way(values, quaternion)
        divisor = values.let("divisor", values.length("length", parts) + parts[0])
        return tuple(part / divisor for part in parts[1:])

    claims = (_equal(r"(1 + p_0)\,\s = \p_v", _along(1 + scalar, q), vector),)
    return {"quaternion": (scalar, *vector), "claims": claims, "back": back}


def _direction_cosines(_: Vector) -> dict[str, Any]:
    def forward(values: NamedValues, q: Vector) -> Vector:
        return _unit(values, short_way(values, shepperd(values, sp.Matrix(3, 3, q))))

    def back(values: NamedValues, quaternion: Vector) -> Vector:
        # R(p) is quadratic in p, so division by p·p normalises without a root.
        size = values.let("square", square(quaternion))
        return tuple(sp.expand(entry) / size for entry in rotation_of(quaternion))

    return {"forward": forward, "back": back}


_PARTS: dict[str, Callable[[Vector], dict[str, Any]]] = {
    parts.__name__.removeprefix("_"): parts
    for parts in (
        *(_quaternion, _unit_quaternion, _axis_angle, _rotation_vector),
        *(_gibbs_vector, _modified_rodrigues, _direction_cosines),
    )
}


# What converts, for one model


class Conversions(Record):
    """What converts between a model's coordinates, its unit quaternion and its matrix.

    Each is derived and proved in the ring of the model when it is asked for.
    """

    model: RotationModel

    @cached_property
    def inverse(self) -> Rule | None:
        """How the coordinates follow from a quaternion of any length but zero."""
        return rule_of(self.model)

    @cached_property
    def quaternion(self) -> Step | None:
        """The unit quaternion; None if it has no short closed form."""
        model, rule = self.model, self.inverse
        # R = R₁ R₂ ⋯ has the quaternion p₁ p₂ ⋯, and the turn by β about e has
        # cos(β/2) + sin(β/2) e.
        factors = [half_turn(turn.direction, turn.angle) for turn in model.turns]
        if rule is not None and rule.quaternion:
            factors = [rule.quaternion]
        # Each factor has two terms, cos and sin, so a product of n turns has up to 2ⁿ terms an
        # entry.
        if not 0 < len(factors) <= LONGEST_CHAIN:
            return None
        entries = [*model.matrix, *chain.from_iterable(factors)]
        try:
            codec = codec_for(entries, constraints=model.constraints, order=0)
            value = sp.ImmutableMatrix(factors[0])
            if len(factors) > 1:
                whole = reduce(product, (tuple(map(codec.encode, factor)) for factor in factors))
                value = presenter_for(codec).matrix(RingMatrix.column(codec.ring, whole))
        except AlgebraError:  # half of a fixed angle need not have a sine that is a root
            return None
        prove, is_fixed = Prover(model, codec), value.free_symbols.isdisjoint(model.constants)
        # ±p are the same rotation, so R(p) = R and |p| = 1 are all that can be claimed.
        same = codec.column(rotation_of(list(value)) - model.matrix)
        proofs = (
            prove.vanishes(same, formula(r"\R(\p) = \R")),
            prove.vanishes(codec.column([value.dot(value) - 1]), formula(r"\p\cdot\p = 1")),
        )
        if not all(proof.is_exact for proof in proofs):
            return None  # where it is a root of a root, the ring may not know that
        quantity = _QUATERNION if is_fixed else _QUATERNION._replace(inputs=("q", "parameters"))
        if rule is not None:
            value = sp.ImmutableMatrix(rule.listed(tuple(value)))
            quantity = quantity.presented({rule.scalar})
        words = text_of(self.because)
        return Step(quantity=quantity, expression=value, words=words, proofs=proofs)

    @property
    def because(self) -> Sentence:
        """How the quaternion follows."""
        kind = self.inverse.kind if self.inverse else "euler"
        return sentence(WORDS["turns" if kind == "euler" else kind]["forward"])

    @property
    def without(self) -> str:
        """What to use in place of an inverse; empty if there is one."""
        return "" if self.inverse else WORDS["without"]

    @cached_property
    def from_matrix(self) -> Proof:
        """4 p pᵀ = K(R): sums and differences of the entries of R, for every unit quaternion p."""
        model = parametrised("unit_quaternion")
        column = sp.Matrix(model.coordinates)
        # R is quadratic in p, so each entry is a polynomial that vanishes by p·p = 1.
        residual = outer_product(model.matrix) - 4 * column * column.T
        return vanishing(model, [(tuple(residual), formula(r"4\,\p\p^T = \mathbf{K}"))])[0]

    @property
    def proofs(self) -> tuple[Proof, ...]:
        forward = self.quaternion.proofs if self.quaternion else ()
        return (*forward, *(self.inverse.proofs if self.inverse else ()), self.from_matrix)

    @property
    def is_proved(self) -> bool:
        return all(proof.is_exact for proof in self.proofs)


def converted(derivation: Derivation) -> Converted:
    """The functions of the conversions; where there are none, a remark says why."""
    conversions = Conversions(derivation.model)
    rule, step = conversions.inverse, conversions.quaternion
    number = len(derivation.steps) + 1  # in the note
    steps = (replace(step, number=number),) if step else ()
    if rule is None:
        remarks = (WORDS["without"], *(() if step else (WORDS["without_quaternion"],)))
        return Converted(steps=steps, remarks=remarks)
    functions = [_to_coordinates(rule, source) for source in ("quaternion", "rotation_matrix")]
    if rule.forward is not None:
        q = derivation.argument("q")
        values = NamedValues(q.symbols)
        parts = rule.forward(values, tuple(q.symbols[place] for place in rule.order))
        forward = ConversionFunction(
            name="quaternion",
            symbol="p",
            argument=q,
            values=tuple(values.lines),
            outputs=rule.listed(parts),
            about=_QUATERNION.presented({rule.scalar}).about,
            remarks=(
                *([f"Equation ({number}) of the note."] if step else []),
                WORDS[rule.kind]["function"],
            ),
        )
        steps, functions = (), [forward, *functions]
    continuity = None
    if "continuity" in rule.words:  # the coordinates are not unique
        kind = rule.kind.replace("unit_", "")
        continuity = Continuity(kind, (rule.words["continuity"],), rule.quarters)
    return Converted(steps, tuple(functions), continuity)


def _to_coordinates(rule: Rule, source: str) -> ConversionFunction:
    """`from_quaternion` or `from_rotation_matrix`."""
    is_matrix = source == "rotation_matrix"
    inputs: Sequence[sp.Symbol] = tuple(map(sp.Dummy, MATRIX if is_matrix else PARTS))
    values = NamedValues(inputs)
    halves: Vector = ()
    if is_matrix:
        matrix, kind = sp.Matrix(3, 3, inputs), "R"
        if rule.model.passive:  # The rules are about R; a passive model presents A = Rᵀ.
            matrix, kind = matrix.T, "A, the transpose of R"
        coordinates = rule.from_matrix(values, matrix)
    else:
        # The way back holds for every length but zero, so the quaternion is scaled and not
        # normalised: the sum of sizes needs no root, and no square can overflow.
        coordinates = rule.from_quaternion(values, values.scaled(inputs))
        halves = rule.halves(tuple(inputs)) if rule.halves and rule.order[1] == 1 else ()
        inputs, kind = rule.listed(inputs), f"scalar {rule.scalar}"
    texts, units = WORDS["functions"][source], rule.model.coordinate_units
    remarks = (rule.because, rule.branch, sentence(texts["remark"].format(SHEPPERD)))
    name, words = source.removeprefix("rotation_"), texts["input"].format(kind)
    return ConversionFunction(
        name=f"from_{source}",
        argument=argument(name, inputs, words=words, names=[symbol.name for symbol in inputs]),
        is_matrix=is_matrix,
        values=tuple(values.lines),
        outputs=coordinates,
        halves=halves,
        about=texts["about"].format(kind),
        remarks=tuple(map(text_of, remarks)),
        unit=units[0] if len({*units}) == 1 else f"({', '.join(units)})",
    )
