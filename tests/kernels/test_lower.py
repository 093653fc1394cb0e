"""What the kernels of a derivation take, give and say, before any target prints them."""

from __future__ import annotations

import pytest

import rigidsym as rs
from helpers.motions import derived
from rigidsym.kernels import ir
from rigidsym.kernels.lowering.lower import MARGIN, lower
from rigidsym.kernels.targets.infix import infix
from rigidsym.models.library import rotation_from
from rigidsym.motion import derive

SKEW = "z(phi) x(theta) [1,1,0](psi)"
FREE = "z(phi) [a,b,c](beta)"


def kernel(program: ir.Program, name: str) -> ir.Kernel:
    return next(kernel for kernel in program.kernels if kernel.name == name)


def test_quantities_come_in_the_order_of_their_equations_and_the_margin_last():
    program = lower(derived("ZXZ"))
    assert program.name == "euler_zxz_intrinsic"
    assert [k.equation for k in program.kernels] == [*range(1, 14), None]
    assert [k.name for k in program.kernels][-1] == MARGIN
    matrix = kernel(program, "rotation_matrix")
    assert (matrix.shape, matrix.symbol, matrix.unit) == ((3, 3), "R", "")
    assert [a.name for a in matrix.arguments] == ["q"]
    assert program.arguments[0].components == ("phi", "theta", "psi")


@pytest.mark.parametrize(
    ("rotation", "product", "presented", "bound"),
    [
        ("ZXZ", "R = Rz(φ) Rx(θ) Rz(ψ).", "Active", []),
        (rs.EulerAngles("zyx", passive=True), "R = Rx(ψ) Ry(θ) Rz(φ).", "Passive", []),
        (
            FREE,
            "R = Rz(φ) R[a,b,c](β).",
            "Active",
            ["R is a rotation where a**2 + b**2 + c**2 = 1."],
        ),
        (
            "unit_quaternion",
            "",
            "Active",
            ["R is a rotation where w**2 + x**2 + y**2 + z**2 = 1."],
        ),
    ],
    ids=["active", "passive", "chain", "quaternion"],
)
def test_the_convention_is_said_in_sentences(rotation, product, presented, bound):
    said = lower(derive(rotation, only=["rotation_matrix"])).convention
    assert [line for line in said if line.startswith("R = ")] == ([product] if product else [])
    assert [line.split(":")[0] for line in said if ": R" in line or ": rot" in line] == [presented]
    assert [line for line in said if line.startswith("R is a rotation where")] == bound


@pytest.mark.parametrize(
    ("name", "value", "symbol", "end"),
    [
        ("ZYX", "abs_cos_theta", "|det W|", "; 1 at most, 0 at one"),
        ("ZXZ", "abs_sin_theta", "|det W|", "; 1 at most, 0 at one"),
        ("rotation_vector", "2.0 * abs_c2_x0", "|det W|", "; 1 at most, 0 at one"),
        (SKEW, "0.5 * abs_x0", "|det W|", "; 0 at one"),
    ],
)
def test_the_margin_is_scaled_to_one_if_its_largest_value_is_known(name, value, symbol, end):
    motion = derive(rotation_from(name), only=["inverse_rate_matrix_space"])
    found = kernel(lower(motion), MARGIN)
    assert (found.symbol, found.shape, infix(found.outputs[0])) == (symbol, (), value)
    assert found.about == f"how far the coordinates are from a singular orientation{end}"
    assert [a.name for a in found.arguments] == ["q"]
