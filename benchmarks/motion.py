"""Equations of motion: their derivation beside SymPy's `LagrangesMethod`, and exact solutions.

The cost of a right-hand side is in `benchmarks/kernels.py`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import median
from time import perf_counter
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
BRICK = {"A": 0.001894220, "B": 0.006211019, "C": 0.007194665}  # slug ft², NASA/TM-2015-218675
TOP = {"A": 1.3, "C": 0.7, "g": 9.81, "l": 0.4, "m": 2.0}
# Ω′ after 30 s of atmospheric case 2 by the report's five tools, °/s; of NESC's published data
# (https://nescacademy.nasa.gov/flightsim), to the digits that each tool prints.
NESC = {
    "SIM 01": (12.61839077566776, -17.3974747618308, 31.11958888682995),
    "SIM 02": (12.619216961385067, -17.396709626714614, 31.119942061280724),
    "SIM 04": (12.6183907757, -17.3974747619, 31.1195888868),
    "SIM 05": (12.618423766019587, -17.397444101295715, 31.11960300607054),
    "SIM 06": (12.620844062702608, -17.394550197091117, 31.12073831148526),
}


def run(settings: Settings) -> Report:
    """Derivation, accuracy over 1,000 periods, and right-hand sides."""
    repeats = settings.repeats or 3
    derived = dict(derivations(repeats))
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
            "Against exact solutions: largest error, largest relative drift of an integral",
            (Column("motion"), Column("method"), Column("error", ".1e"), Column("drift", ".1e")),
            tuple(accuracy()),
        ),
        Table(
            "NASA/TM-2015-218675, atmospheric case 2: angular velocity of the body after 30 s, °/s",
            (
                *(Column("by"), Column("first", ".12f"), Column("second", ".12f")),
                *(Column("third", ".12f"), Column("error", ".1e")),
            ),
            tuple(tumbling()),
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


def tumbling() -> Iterator[tuple[Cell, ...]]:
    """The brick after 30 s: in elliptic functions, integrated, and by the five tools."""
    free = rs.derive("unit_quaternion", ["energy"], body=rs.principal_moments(A, B, C), potential=0)
    start: dict[str, Any] = {"w": 1, "x": 0, "y": 0, "z": 0}
    start["angular_velocity_body"] = np.radians([10.0, 20.0, 30.0])
    ends = {
        f"rigidsym, {method}": np.degrees(
            free.simulate(start, BRICK, 30.0, method=method, samples=31).angular_velocity_body[-1]
        )
        for method in ("exact", "DOP853")
    }
    exact = ends["rigidsym, exact"]
    for name, end in (ends | NESC).items():
        yield name, *map(float, end), float(np.abs(np.array(end) - exact).max())


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
