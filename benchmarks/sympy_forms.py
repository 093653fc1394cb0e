"""Every quantity as SymPy itself gives it, in every form that SymPy offers; the shortest counts.

Sources: `sympy.physics.vector` and plain matrix work on what it returns. Passes: what SymPy has
for making an expression shorter. The survey takes minutes, so that its result is kept in a file,
one a SymPy version.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import sympy as sp
from sympy.physics.vector import ReferenceFrame, dynamicsymbols, kinematic_equations

RESULTS = Path(__file__).parent / "results"
ANGLES = ("phi", "theta", "psi")

Expr = Any  # SymPy carries no types
Matrix = Any
Passes = Mapping[str, Callable[[Expr], Expr]]


@dataclass(frozen=True, slots=True)
class Form:
    """One form of one quantity: where it comes from, what was done to it, and its length."""

    source: str
    manner: str
    operations: int
    entries: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Survey:
    """The forms of one quantity in one convention."""

    raw: int  # operations as SymPy first gives it
    best: Form  # of SIMPLIFIED
    factored: Form  # of SIMPLIFIED and FACTORED
    mixed: int  # each entry in whichever of all forms is shortest for it
    values: tuple[float, ...]  # the entries at a fixed point: what the other side must give


def operations(entries: Matrix) -> int:
    """`sympy.count_ops`, summed over the entries."""
    return sum(int(sp.count_ops(entry)) for entry in entries)


@lru_cache(maxsize=4096)
def _trigsimp(entry: Expr) -> Expr:
    return sp.trigsimp(entry)


@lru_cache(maxsize=4096)
def _simplify(entry: Expr) -> Expr:
    return sp.simplify(entry)


def _collect(entry: Expr) -> Expr:
    """Collected by whichever sine or cosine leaves least."""
    return min(
        (sp.collect(entry, part) for part in entry.atoms(sp.sin, sp.cos)),
        key=sp.count_ops,
        default=entry,
    )


# What SymPy gives, and what its simplifiers make of it.
SIMPLIFIED: Passes = {
    "as it comes": lambda entry: entry,
    "expand": sp.expand,
    "trigsimp": _trigsimp,
    "trigsimp, method fu": lambda entry: sp.trigsimp(entry, method="fu"),
    "simplify": _simplify,
}
# What its ways of taking out factors make of that: a user's choice of form, a harder bar.
FACTORED: Passes = {
    "factor": sp.factor,
    "factor_terms": sp.factor_terms,
    "trigsimp, factor": lambda entry: sp.factor(_trigsimp(entry)),
    "trigsimp, factor_terms": lambda entry: sp.factor_terms(_trigsimp(entry)),
    "trigsimp, collect": lambda entry: _collect(_trigsimp(entry)),
    "trigsimp, expand, collect": lambda entry: _collect(sp.expand(_trigsimp(entry))),
    "simplify, factor": lambda entry: sp.factor(_simplify(entry)),
}


def frames(sequence: str) -> tuple[ReferenceFrame, ReferenceFrame]:
    """The space frame and a body frame turned by φ, θ, ψ; upper case is intrinsic."""
    space, body = ReferenceFrame("N"), ReferenceFrame("B")
    orient = body.orient_body_fixed if sequence.isupper() else body.orient_space_fixed
    orient(space, dynamicsymbols(" ".join(ANGLES)), sequence.upper())
    return space, body


def sources(sequence: str) -> Iterator[tuple[str, str, Matrix]]:
    """Quantity, source, matrix: every way in which SymPy gives a quantity."""
    space, body = frames(sequence)
    R = space.dcm(body)
    R_dot = R.diff(dynamicsymbols._t)
    yield "rotation_matrix", "dcm", R
    yield "rotation_rate", "dcm, diff", R_dot
    yield "spin_matrix", "dcm, diff, product", R_dot * R.T
    for name, frame in (("space", space), ("body", body)):
        yield from _in_frame(name, frame, space, body)
    yield from _kinematic_equations(sequence)


def _in_frame(
    name: str, frame: ReferenceFrame, space: ReferenceFrame, body: ReferenceFrame
) -> Iterator[tuple[str, str, Matrix]]:
    """What has a space and a body form: Ω, W, W⁻¹, q̇ from Ω, dΩ/dt."""
    omega = body.ang_vel_in(space).to_matrix(frame)
    rates = [q.diff() for q in dynamicsymbols(" ".join(ANGLES))]
    yield f"angular_velocity_{name}", "ang_vel_in", omega
    yield f"rate_matrix_{name}", "ang_vel_in, jacobian", omega.jacobian(rates)
    short = omega.applyfunc(_trigsimp)
    W = short.jacobian(rates)
    yield f"rate_matrix_{name}", "ang_vel_in, trigsimp, jacobian", W
    given = sp.Matrix(speeds(name))
    for method in ("GE", "ADJ"):
        inverse = W.inv(method=method)
        yield f"inverse_rate_matrix_{name}", f"inv, {method}", inverse
        short_inverse = inverse.applyfunc(_trigsimp)
        yield f"rates_from_angular_velocity_{name}", f"inv, {method}", inverse * given
        yield (
            f"rates_from_angular_velocity_{name}",
            f"inv, {method}, trigsimp, product",
            short_inverse * given,
        )
    yield f"rates_from_angular_velocity_{name}", "LUsolve", W.LUsolve(given)
    alpha = body.ang_acc_in(space).to_matrix(frame)
    yield f"angular_acceleration_{name}", "ang_acc_in", alpha
    yield (
        f"angular_acceleration_{name}",
        "ang_vel_in, trigsimp, diff",
        short.diff(dynamicsymbols._t),
    )


def _kinematic_equations(sequence: str) -> Iterator[tuple[str, str, Matrix]]:
    angles = dynamicsymbols(" ".join(ANGLES))
    manner = "body" if sequence.isupper() else "space"
    zero = kinematic_equations(list(speeds("body")), angles, manner, sequence.upper())
    rates = [q.diff() - left for q, left in zip(angles, zero, strict=True)]
    yield "rates_from_angular_velocity_body", "kinematic_equations", sp.Matrix(rates)


def speeds(frame: str) -> tuple[Expr, ...]:
    """The given angular velocity, as the same symbols on both sides of the comparison."""
    stem = "Omega" if frame == "space" else "Omega_body"
    return tuple(sp.Symbol(f"{stem}_{k}") for k in (1, 2, 3))


def survey(sequence: str, simplified: Passes, factored: Passes) -> dict[str, Survey]:
    """Every quantity of one convention in every form; raises where two forms differ in value."""
    found: dict[str, list[_Found]] = {}
    for quantity, source, matrix in sources(sequence):
        for manner, apply in {**simplified, **factored}.items():
            form = _Found(source, manner, matrix.applyfunc(apply), manner in simplified)
            found.setdefault(quantity, []).append(form)
    for quantity, forms in found.items():
        _check_equal(f"{sequence} {quantity}", [form.matrix for form in forms])
    return {quantity: _summary(forms) for quantity, forms in found.items()}


class _Found(NamedTuple):
    source: str
    manner: str
    matrix: Matrix
    is_simplified: bool

    def written(self) -> Form:
        entries = tuple(map(str, self.matrix))
        return Form(self.source, self.manner, operations(self.matrix), entries)


def _summary(forms: Sequence[_Found]) -> Survey:
    by_entry = zip(*(form.matrix for form in forms), strict=True)
    return Survey(
        raw=operations(forms[0].matrix),
        best=_shortest([form for form in forms if form.is_simplified]),
        factored=_shortest(forms),
        mixed=sum(min(int(sp.count_ops(entry)) for entry in entries) for entries in by_entry),
        values=tuple(values(forms[0].matrix)),
    )


def _shortest(forms: Sequence[_Found]) -> Form:
    return min(forms, key=lambda form: operations(form.matrix)).written()


def values(matrix: Matrix) -> list[float]:
    """The entries at one fixed point, to tell forms of different value apart."""
    point: dict[Expr, float] = {}
    for k, q in enumerate(dynamicsymbols(" ".join(ANGLES)), start=1):
        point |= {q: 0.7 * k, q.diff(): 0.3 + 0.9 * k, q.diff().diff(): 1.1 - 0.4 * k}
    point |= {s: 0.2 + 0.3 * k for f in ("space", "body") for k, s in enumerate(speeds(f))}
    return [float(entry.xreplace(point).evalf()) for entry in matrix]


def agree(first: Sequence[float], second: Sequence[float]) -> bool:
    """Whether two sets of values at the fixed point are those of one quantity."""
    pairs = zip(first, second, strict=True)
    return all(math.isclose(a, b, rel_tol=1e-9, abs_tol=1e-9) for a, b in pairs)


def _check_equal(what: str, matrices: list[Matrix]) -> None:
    first = values(matrices[0])
    if not all(agree(first, values(other)) for other in matrices[1:]):
        raise ArithmeticError(f"{what}: SymPy's forms differ in value")


def cache_path() -> Path:
    """Where the surveys for this SymPy version are kept."""
    return RESULTS / f"sympy_{sp.__version__}_forms.json"


def load() -> dict[str, dict[str, Survey]]:
    """The kept surveys: convention, quantity, survey; empty where there are none."""
    path = cache_path()
    if not path.exists():
        return {}
    return {
        sequence: {name: _decoded(entry) for name, entry in quantities.items()}
        for sequence, quantities in json.loads(path.read_text(encoding="utf-8")).items()
    }


def _decoded(entry: dict[str, Any]) -> Survey:
    return Survey(
        raw=entry["raw"],
        best=_form(entry["best"]),
        factored=_form(entry["factored"]),
        mixed=entry["mixed"],
        values=tuple(entry["values"]),
    )


def _form(entry: dict[str, Any]) -> Form:
    return Form(entry["source"], entry["manner"], entry["operations"], tuple(entry["entries"]))


def save(surveys: Mapping[str, Mapping[str, Survey]]) -> None:
    """Keep the surveys; written whole, so that a break leaves the convention before."""
    plain = {s: {name: asdict(found) for name, found in q.items()} for s, q in surveys.items()}
    path = cache_path()
    path.parent.mkdir(exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(json.dumps(plain, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    part.replace(path)
