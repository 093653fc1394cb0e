"""Equations of motion: tops beside SymPy's `LagrangesMethod`, chains, and exact solutions.

The cost of a right-hand side is in `benchmarks/kernels.py`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import reduce
from math import log2
from statistics import median
from time import perf_counter, process_time
from typing import Any

import numpy as np
import sympy as sp
from sympy.physics.mechanics import LagrangesMethod, ReferenceFrame, dynamicsymbols, inertia

import rigidsym as rs
from benchmarks.measure import Settings, progress
from benchmarks.report import Cell, Column, Figure, Report, Table

A, B, C = sp.symbols("A B C")
SYMMETRIC = ((A, A, C), "m*g*l*cos(theta)")
ASYMMETRIC = ((A, B, C), "m*g*(sin(theta)*(a*sin(psi) + b*cos(psi)) + l*cos(theta))")
MOST = {"symmetric": (0.3, 60), "asymmetric": (1.0, 180)}  # seconds, operations
TIME = dynamicsymbols._t
JOINTS = "zxzyxyzxyzxyzxzyxyzx"  # axes of the longest chain
BRICK = {"A": 0.001894220, "B": 0.006211019, "C": 0.007194665}  # slug ft², NASA/TM-2015-218675
TOP = {"A": 1.3, "C": 0.7, "g": 9.81, "l": 0.4, "m": 2.0}


def run(settings: Settings) -> Report:
    """Derivations, and accuracy over 1,000 periods."""
    derived, on_joints = dict(derivations(settings.repeats or 3)), list(chains())
    tables = [
        Table(
            "Heavy tops to explicit accelerations (ZXZ): seconds, operations after cse",
            tuple(
                map(
                    Column,
                    ("top", "rigidsym, s", "operations", "SymPy, s", "its operations", "after cse"),
                )
            ),
            tuple((name, *row) for name, row in derived.items()),
        ),
        Table(
            "Bodies on joints, in processor time",
            (Column("system"), Column("figure"), Column("value", ".4g"), Column("at most", "g")),
            tuple(on_joints),
        ),
        Table(
            "Against exact solutions: largest error, largest relative drift of an integral",
            (Column("motion"), Column("method"), Column("error", ".1e"), Column("drift", ".1e")),
            tuple(accuracy()),
        ),
    ]
    figures = [
        Figure(
            f"Heavy {name} top to accelerations",
            f"at most {MOST[name][0]} s and {MOST[name][1]} operations",
            f"{row[0]} s and {row[1]}",
            float(row[0]) <= MOST[name][0] and int(row[1]) <= MOST[name][1],
        )
        for name, row in derived.items()
    ]
    figures += [
        Figure(f"{system}: {figure}", f"at most {most:g}", f"{value:.4g}", value <= most)
        for system, figure, value, most in on_joints
        if most is not None
    ]
    return Report(title="Motion", tables=tuple(tables), figures=tuple(figures))


# derivation


def derivations(repeats: int) -> Iterator[tuple[str, tuple[Any, ...]]]:
    for name, (moments, potential) in (("symmetric", SYMMETRIC), ("asymmetric", ASYMMETRIC)):
        progress(f"the {name} top")
        seconds = []
        for _ in range(repeats):
            _forget()
            start = perf_counter()
            motion = rs.derive(
                "ZXZ", "accelerations", body=rs.principal_moments(*moments), potential=potential
            )
            seconds.append(perf_counter() - start)
        start = perf_counter()
        assert motion.forces is not None
        theirs = _by_sympy(moments, motion.forces.potential)
        spent = perf_counter() - start
        raw = sum(map(sp.count_ops, theirs))
        ours = f"{median(seconds):.2f}"
        yield name, (ours, _shared(motion.accelerations), f"{spent:.1f}", raw, _shared(theirs))
    progress()


def _forget() -> None:
    """Rings and presenters are kept from one derivation to the next, but not here."""
    from rigidsym.algebra import codec, present

    codec._shared.cache_clear()
    present.presenter_for.cache_clear()


def _by_sympy(moments: Sequence[sp.Expr], potential: sp.Expr) -> Any:
    phi, theta, psi = dynamicsymbols("phi theta psi")
    space = ReferenceFrame("N")
    body = space.orientnew("B", "Body", [phi, theta, psi], "ZXZ")
    omega = body.ang_vel_in(space)
    kinetic = omega.dot(inertia(body, *moments).dot(omega)) / 2
    method = LagrangesMethod(kinetic - potential, [phi, theta, psi])
    method.form_lagranges_equations()
    return method.rhs()[3:]


def _shared(expressions: Sequence[sp.Expr]) -> int:
    shared, outputs = sp.cse(list(expressions))
    return int(sum(sp.count_ops(e) for _, e in shared) + sum(map(sp.count_ops, outputs)))


# chains


def chains() -> Iterator[tuple[str, str, float, float | None]]:
    """Each figure of a system, and the most that it may be."""
    progress("chains")
    start = process_time()
    motion, system = gimbal(), "gimbal of three axes, its payload off them"
    yield system, "accelerations, proved, s", process_time() - start, 1.5
    yield system, "their C source, kB", len(motion.kernels("c").source) / 1000, 40
    start = process_time()
    motion, system = arm(), "arm of two links on four joints"
    angles = motion.argument("q").names
    values = dict.fromkeys(motion.argument("parameters").names, 0.2) | {"g": 9.81}
    first = {f"{angle}{dot}": 0.4 for angle in angles for dot in ("", "_dot")}
    motion.simulate(first, values, 10.0, samples=101)
    yield system, "derived, and simulated for 10 s, s", process_time() - start, 5.0
    counts: dict[int, int] = {}
    for joints in (5, 10, 20):
        start, system = process_time(), f"{joints} bodies on {joints} joints"
        turns = [f"{axis}(q{k})" for k, axis in enumerate(JOINTS[:joints], 1)]
        weight = sp.Add(*(sp.cos(dynamicsymbols(f"q{k + 1}")) for k in range(joints)))
        motion = chain(turns, ("mass_matrix", "bias_vector"), sp.Symbol("w") * weight)
        yield system, "M and h, proved, s", process_time() - start, 3.0 if joints == 10 else None
        formulas = [
            e for name in ("mass_matrix", "bias_vector") for e in motion.step(name).expression
        ]
        formulas += [definition.expression for definition in motion.definitions]
        counts[joints] = sum(map(sp.count_ops, formulas))
        yield system, "operations of M and h", counts[joints], None
        if joints > 5:
            growth = log2(counts[joints] / counts[joints // 2])
            yield system, f"growth of operations from {joints // 2} joints, power", growth, 2.0


def gimbal() -> rs.Motion:
    """Two frames with inertia, and a payload whose centre of mass is off the axes."""
    turns, (m, g) = ("z(phi)", "x(theta)", "y(psi)"), sp.symbols("m g")
    centre = _rotation(turns) * sp.Matrix(sp.symbols("a b l"))
    return chain(turns, "accelerations", m * g * centre[2], [(centre, m)])


def arm() -> rs.Motion:
    """Two links on joints of two axes: the first has inertia and a mass, the second ends in one."""
    turns, (m, n, g, c, d, k) = ("z(q1)", "x(q2)", "z(q3)", "x(q4)"), sp.symbols("m n g c d k")
    first, second = _rotation(turns[:2])[:, 2], _rotation(turns)[:, 2]
    elbow, hand = c * first, d * first + k * second
    return chain(turns, "energy", g * (m * elbow[2] + n * hand[2]), [(elbow, m), (hand, n)], [2])


def chain(
    turns: Sequence[str],
    only: str | Sequence[str],
    potential: Any,
    particles: Sequence[tuple[Any, sp.Symbol]] = (),
    bodies: Sequence[int] | None = None,
) -> rs.Motion:
    """Particles, and bodies after the last turn and each other one (or those in `bodies`)."""
    parts: list[Any] = [
        {"rotation": " ".join(turns[:k]), "principal_moments": sp.symbols(f"A{k} B{k} C{k}")}
        for k in bodies or range(1, len(turns))
    ]
    parts += [{"velocity": list(place.diff(TIME)), "mass": mass} for place, mass in particles]
    body, text = rs.principal_moments(A, B, C), " ".join(turns)
    return rs.derive(text, only, body=body, potential=potential, parts=parts)


def _rotation(turns: Sequence[str]) -> Any:
    return reduce(
        sp.Matrix.__mul__, (sp.Matrix(t.matrix) for t in rs.rotation_from(" ".join(turns)).turns)
    )


# accuracy


def accuracy() -> Iterator[tuple[Cell, ...]]:
    """1,000 periods of a free body and of a nodding top; the brick after 30 s."""
    free = rs.derive("unit_quaternion", ["energy"], body=rs.principal_moments(A, B, C), potential=0)
    omega = np.radians([10.0, 20.0, 30.0])
    for what, t_end in (("free body, 30 s (NASA case 2)", 30.0), ("free body, 1,000 periods", 1e4)):
        start = {"w": 1, "x": 0, "y": 0, "z": 0, "angular_velocity_body": omega}
        options = {"samples": 31 if t_end < 100 else 1001}
        exact = free.simulate(start, BRICK, t_end, method="exact", **options)
        progress(what)
        found = free.simulate(start, BRICK, t_end, **options)
        error = np.abs(found.rotation_matrix - exact.rotation_matrix).max()
        yield what, "DOP853", float(error), max(found.drift.values())
    yield _nodding()
    progress()


def _nodding(periods: int = 1000) -> tuple[Cell, ...]:
    """θ of a heavy top against sn, over whole periods."""
    from scipy.special import ellipj, ellipk

    motion = rs.derive(
        "ZXZ", ["energy"], body=rs.principal_moments(A, A, C), potential=SYMMETRIC[1]
    )
    start = {"phi": 0, "theta": 0.9, "psi": 0, "phi_dot": 0, "theta_dot": 0, "psi_dot": 12.0}
    weight, a = TOP["m"] * TOP["g"] * TOP["l"], TOP["A"]
    spin = TOP["C"] * start["psi_dot"]
    p_phi, u0 = spin * np.cos(0.9), np.cos(0.9)
    energy = weight * u0  # without C ω₃²/2
    u = np.polynomial.Polynomial([0, 1])
    cubic = 2 * (1 - u**2) * (energy - weight * u) / a - ((p_phi - spin * u) / a) ** 2
    one, two, three = np.sort(cubic.roots().real)
    rate = np.sqrt(weight / (2 * a) * (three - one))
    m = (two - one) / (three - one)
    found = motion.simulate(start, TOP, periods * 2 * ellipk(m) / rate, samples=20 * periods + 1)
    sn, *_ = ellipj(ellipk(m) + rate * found.t, m)  # from the upper circle on
    error = np.abs(np.cos(found.q[:, 1]) - one - (two - one) * sn**2).max()
    return "heavy top, 1,000 nutations", "DOP853", float(error), max(found.drift.values())
