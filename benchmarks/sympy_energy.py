"""Kinetic energy and angular momentum of a turning body as `sympy.physics.mechanics` gives them.

In every form that SymPy offers, the shortest counts. The survey takes the better part of an hour,
so that its result is kept in a file, one a SymPy version.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import sympy as sp
from sympy.physics.mechanics import Point, RigidBody, inertia

from benchmarks.sympy_forms import RESULTS, Form, frames, operations, values

Matrix = Any  # SymPy carries no types

A, B, C, M = sp.symbols("A B C M")
BODIES: Mapping[str, tuple[sp.Symbol, ...]] = {
    "general": (A, B, C),
    "symmetric": (A, A, C),
    "spherical": (A, A, A),
}
MOMENTS = {A: 1.3, B: 1.7, C: 2.1, M: 1.9}  # where values are compared
PASSES: Mapping[str, Callable[[Any], Any]] = {
    "as it comes": lambda entry: entry,
    "trigsimp": sp.trigsimp,
    "simplify": sp.simplify,
}


@dataclass(frozen=True, slots=True)
class Survey:
    """The forms of one quantity of one body in one convention."""

    raw: int  # operations as SymPy first gives it
    simplified: int  # after `simplify`
    best: Form
    values: tuple[float, ...]  # at a fixed point: what the other side must give


def quantities(sequence: str, body: str) -> Iterator[tuple[str, Matrix]]:
    """E_R, and L_R in the components of body and space, of a body at rest in its centre."""
    space, turned = frames(sequence)
    centre = Point("G")
    centre.set_vel(space, 0)
    tensor = inertia(turned, *BODIES[body])
    rigid = RigidBody("body", centre, turned, M, (tensor, centre))
    yield "rotational_energy", sp.Matrix([rigid.kinetic_energy(space)])
    momentum = rigid.angular_momentum(centre, space)
    yield "angular_momentum_rotation_body", momentum.to_matrix(turned)
    yield "angular_momentum_rotation", momentum.to_matrix(space)


def survey(sequence: str, body: str) -> dict[str, Survey]:
    """The three quantities of one convention and one body, in every form."""
    return {name: _survey(matrix) for name, matrix in quantities(sequence, body)}


def _survey(matrix: Matrix) -> Survey:
    forms = {manner: matrix.applyfunc(apply) for manner, apply in PASSES.items()}
    manner = min(forms, key=lambda name: operations(forms[name]))
    entries = tuple(map(str, forms[manner]))
    return Survey(
        raw=operations(matrix),
        simplified=operations(forms["simplify"]),
        best=Form("RigidBody", manner, operations(forms[manner]), entries),
        values=tuple(values(matrix.xreplace(MOMENTS))),
    )


def cache_path() -> Path:
    """Where the survey for this SymPy version is kept."""
    return RESULTS / f"sympy_{sp.__version__}_energy.json"


def load() -> dict[str, dict[str, dict[str, Survey]]]:
    """The kept survey: convention, body, quantity, forms; empty where there is none."""
    path = cache_path()
    if not path.exists():
        return {}
    return {
        sequence: {
            body: {name: _decoded(entry) for name, entry in found.items()}
            for body, found in bodies.items()
        }
        for sequence, bodies in json.loads(path.read_text(encoding="utf-8")).items()
    }


def _decoded(entry: dict[str, Any]) -> Survey:
    best = entry["best"]
    form = Form(best["source"], best["manner"], best["operations"], tuple(best["entries"]))
    return Survey(entry["raw"], entry["simplified"], form, tuple(entry["values"]))


def save(surveys: Mapping[str, Mapping[str, Mapping[str, Survey]]]) -> None:
    """Keep the survey; written whole, so that a break leaves what was there before."""
    plain = {
        sequence: {
            body: {name: asdict(found) for name, found in quantities.items()}
            for body, quantities in bodies.items()
        }
        for sequence, bodies in surveys.items()
    }
    path = cache_path()
    path.parent.mkdir(exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(json.dumps(plain, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    part.replace(path)
