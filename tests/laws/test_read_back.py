"""What is printed is what was proved: formulas, read back at 50 digits.

Small readers that share no code with the package read the LaTeX of the notes.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from typing import Any

import pytest
import sympy as sp

from helpers.parametrisations import Moving
from helpers.reading import Values, define, equations
from helpers.witness import TOLERANCE, evaluate, mp

VECTORS = {  # as the notes call it, its components, and those whose length is n
    "quaternion": ("v", "q_1 q_2 q_3", "q_0 q_1 q_2 q_3"),
    "unit_quaternion": ("v", "q_1 q_2 q_3", "q_0 q_1 q_2 q_3"),
    "axis_angle": ("e", "e_1 e_2 e_3", "e_1 e_2 e_3"),
    "rotation_vector": ("v", "v_1 v_2 v_3", "v_1 v_2 v_3"),
}
ROTATIONS = (  # one of each kind
    *("ZXZ", "xyz", "quaternion", "unit_quaternion", "axis_angle"),
    pytest.param("rotation_vector", marks=pytest.mark.campaign),
    *("z(phi) x(theta) [0,b,c](psi)", "z(2*phi - psi) x(theta) z(psi)"),
    "z(phi) [1,1,0](theta) x(pi/4)",
)
PRINTED = {"w": "q_0", "x": "q_1", "y": "q_2", "z": "q_3"}  # as notes call quaternions
SYMBOLS = {  # of results, as the reader names them
    "rotation_matrix": "bold R",
    "rotation_rate": "dR/dt",
    "angular_velocity_space": "bold Omega",
    "angular_velocity_body": "bold Omega'",
    "rate_matrix_space": "bold W",
    "rate_matrix_body": "bold W'",
    "angular_acceleration_space": "dOmega/dt",
}


class Printed:
    """A motion, a point in its coordinates, and what each quantity is worth there."""

    def __init__(self, text: str) -> None:
        moving = Moving(text, passive=False)
        self.motion, self.point = moving.motion, dict(moving.values)
        for frame in ("space", "body"):
            omega = getattr(moving, f"angular_velocity_{frame}")
            self.point |= zip(self.motion.argument(f"omega_{frame}").symbols, omega, strict=True)
        self.expected = {
            step.quantity.name: evaluate(self.motion.spelled(step.expression), self.point)
            for step in self.motion.steps
        }
        self.known: Values = {"pi": mp.pi, "bold 1": mp.eye(3)}
        for symbol, value in self.point.items():
            self.known[_name(symbol)] = value
        for name, head in SYMBOLS.items():
            self.known[head] = self.expected[name]
        for frame, prime in (("space", ""), ("body", "'")):
            self.known[f"dot bold Omega{prime}"] = self.expected[f"angular_acceleration_{frame}"]
            inverse = self.expected.get(f"inverse_rate_matrix_{frame}")
            if inverse is not None:
                self.known[f"bold W{prime}+"] = inverse
        coordinates = self.motion.model.coordinates
        rates = self.rates = mp.matrix([self.known["dot " + _name(q)] for q in coordinates])
        if text != "quaternion":  # of which |q| may change
            self.known["dot bold q"] = rates
        self.known["ddot bold q"] = mp.matrix([self.known["ddot " + _name(q)] for q in coordinates])
        for symbol, name in (("R", "rotation_matrix"), ("W", "rate_matrix_space")):
            self._add_slopes(symbol, name)
        self._add_slopes("W'", "rate_matrix_body")
        if text in VECTORS:
            self._add_vectors(*VECTORS[text])

    def _add_vectors(self, letter: str, components: str, long: str) -> None:
        def vector(names: str, dots: str = "") -> Any:
            return mp.matrix([self.known[dots + name] for name in names.split()])

        for dots in ("", "dot ", "ddot "):
            self.known[f"{dots}bold {letter}"] = vector(components, dots)
        self.known["n"] = mp.norm(vector(long))
        self.known["dot n"] = mp.fdot(vector(long), vector(long, "dot ")) / self.known["n"]

    def _add_slopes(self, symbol: str, name: str) -> None:
        """∂M/∂q for each coordinate, and dM/dt."""
        matrix = self.motion.spelled(self.motion.step(name).expression)
        total = 0 * self.expected[name]
        for q in self.motion.model.coordinates:
            slope = evaluate(sp.diff(matrix, q), self.point)
            self.known[f"partial{symbol}/partial{_name(q)}"] = slope
            total += slope * self.known["dot " + _name(q)]
        self.known.setdefault(f"d{symbol}/dt", total)

    def check(self, name: str, latex: str, known: Values) -> None:
        """Each side that can be read is the quantity; of entries, each is its own.

        The last side must be readable.
        """
        expected = self.expected[name]
        found = list(equations(latex, known))
        if len(found) == 1:
            *others, last = found[0]
            assert last is not None, f"cannot read {latex}"
            for side in (last, *(side for side in others if side is not None)):
                assert _distance(side, expected) < TOLERANCE, latex
        else:
            entries = mp.matrix([sides[-1] for sides in found])
            assert _distance(entries, mp.matrix(list(expected))) < TOLERANCE, latex


def _name(symbol: sp.Expr) -> str:
    """As the reader names it: phi, dot v_1, Omega'_2."""
    order = int(symbol.derivative_count) if isinstance(symbol, sp.Derivative) else 0
    plain = str(symbol.expr if order else symbol).removesuffix("(t)")
    base, body, index = re.fullmatch(r"([A-Za-z]+)(_body)?_?(\d*)", plain).groups()
    dots = ("", "dot ", "ddot ")[order]
    return dots + PRINTED.get(base, base) + ("'" if body else "") + (f"_{index}" if index else "")


def _distance(one: Any, two: Any) -> Any:
    return mp.norm(mp.matrix([one - two]) if not isinstance(one, mp.matrix) else one - two, 1)


printed = cache(Printed)


@pytest.mark.parametrize("text", ["ZXZ", "unit_quaternion", "z(phi) x(theta) [0,b,c](psi)"])
def test_each_equation_in_latex(text):
    one = printed(text)
    for name in one.expected:
        one.check(name, one.motion.latex(name), one.known)


def displays_in_latex(note: str) -> Iterator[tuple[str, str]]:
    """Each display with the name of its result, if it is one."""
    kinds = r"\\begin\{resultof\}\{\w+:(\w+)\}(.*?)\\end\{resultof\}|\\\[\n(.*?)\n\\\]"
    several = (
        r"(?:\\boxed\{)?(\\begin\{align\*\}.*?)(?:\\numbered\{\w+:(\w+)\}\s*)?\\end\{align\*\}"
    )
    for found in re.finditer(f"{kinds}|{several}", note, re.DOTALL):
        name, result, plain, lines, label = found.groups(default="")
        yield name or label, result or plain or rf"{lines}\end{{align*}}"


@pytest.mark.parametrize("text", ROTATIONS)
def test_displays_of_the_note(text):
    one = printed(text)
    note = one.motion.note(with_kernels=False)
    displays = list(displays_in_latex(note.latex()))
    assert {name for name, _ in displays} >= one.expected.keys()
    known = dict(one.known)
    for _, display in displays:
        define(display, known)
    for name, display in displays:
        if name in one.expected:
            # q̇ of Ω keeps the length of a quaternion, which the rates in dΩ/dt may change
            any_rates = {"dot bold q": one.rates} if name.startswith("angular_acc") else {}
            one.check(name, display, known | any_rates)
        else:
            for head, *_, last in (e for e in equations(display, known) if len(e) > 1):
                same_kind = isinstance(head, mp.matrix) == isinstance(last, mp.matrix)
                if head is not None and last is not None and same_kind:
                    assert _distance(head, last) < TOLERANCE, display
