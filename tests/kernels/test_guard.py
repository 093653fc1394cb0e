"""Which divisors are guarded, and from what size on they are told from zero."""

from __future__ import annotations

import pytest
import sympy as sp

from rigidsym.algebra.stable_forms import Stumpff
from rigidsym.kernels import ir
from rigidsym.kernels.lowering.cse import Reader
from rigidsym.kernels.lowering.naming import Names
from rigidsym.kernels.lowering.rounding import guarded
from rigidsym.kernels.lowering.schedule import write
from rigidsym.kernels.targets.infix import infix

A, B, C = sp.symbols("a b c")
ARGUMENT = ir.KernelArgument(name="q", components=("a", "b", "c"), units=("1",) * 3, about="")


def text(expression: ir.Expression) -> str:
    return infix(expression)


def guards(*expressions: sp.Expr) -> tuple[list[str], list[str]]:
    """Assignments and outputs as text, with divisors guarded."""
    reader = Reader("test", {symbol: symbol.name for symbol in (A, B, C)})
    weighted = [reader.weighted(e) for e in expressions]
    reader.graph.share(node for _, node in weighted)
    names = Names(ARGUMENT.components)
    assignments, outputs = write(reader.graph, weighted, names)
    kernel = ir.Kernel(
        name="test",
        arguments=(ARGUMENT,),
        assignments=assignments,
        outputs=outputs,
        shape=(len(outputs),),
        symbol="f",
        about="",
        unit="1",
    )
    whole = guarded(kernel, names)
    return [f"{a.name} = {text(a.value)}" for a in whole.assignments], list(
        map(text, whole.outputs)
    )


def test_a_sine_that_divides_is_zero_up_to_the_rounding_of_its_angle():
    assert guards(B / sp.sin(A), C / sp.cos(A) + 1 / sp.sin(A)) == (
        [
            "sin_a = sin(a)",
            "cos_a = cos(a)",
            "sin_a_or_nan = or_nan(sin_a, a)",
            "cos_a_or_nan = or_nan(cos_a, a)",
        ],
        ["b / sin_a_or_nan", "1.0 / sin_a_or_nan + c / cos_a_or_nan"],
    )


@pytest.mark.parametrize(
    ("divisor", "assigned"),
    [
        (A**2 + 1, []),
        (A**2 + B**2 + sp.Rational(1, 2), []),
        (A, []),
        (A * B, []),
        (A**2 + B**2, ["x0 = a * a + b * b", "x0_or_nan = or_nan(x0, None)"]),
        (2 * A**2 + 3 * B**2, ["x0 = 2.0 * a * a + 3.0 * b * b", "x0_or_nan = or_nan(x0, None)"]),
    ],
    ids=str,
)
def test_squares_of_inputs_vanish_only_where_they_underflow(divisor, assigned):
    assert guards(C / divisor)[0] == assigned


@pytest.mark.parametrize(
    ("divisor", "assigned"),
    [
        (A - B, ["x1 = abs(a)", "x2 = abs(b)", "x3 = 4.0 * (x1 + x2)"]),
        (A**2 - B, ["x1 = abs(b)", "x2 = 4.0 * (x1 + a * a)"]),
        (A**2 - 1, ["x1 = 4.0 * (1.0 + a * a)"]),
        (A * B + 1, ["x1 = a * b", "x2 = abs(x1)", "x3 = 4.0 * (1.0 + x2)"]),
        (2 * A * B + 1, ["x1 = 2.0 * a * b", "x2 = abs(x1)", "x3 = 4.0 * (1.0 + x2)"]),
        (A**3 + 1, ["x1 = a * a * a", "x2 = abs(x1)", "x3 = 4.0 * (1.0 + x2)"]),
    ],
    ids=str,
)
def test_a_sum_that_divides_is_told_from_zero_by_the_sizes_of_its_terms(divisor, assigned):
    found = guards(C / divisor)[0]
    assert found[1:-1] == assigned
    assert found[-1] == f"x0_or_nan = or_nan(x0, {assigned[-1].split()[0]})"


def test_a_sum_of_squares_of_sines_is_told_from_zero_by_the_squares_of_its_angles():
    assert guards(C / (sp.sin(A) ** 2 + B**2))[0][1:] == [
        "x0 = b * b + sin_a * sin_a",
        "x1 = abs(a)",
        "x2 = 4.0 * (1.0 + x1)",
        "x3 = x2 * x2",
        "x0_or_nan = or_nan(x0, x3, 2)",
    ]


def test_a_square_of_an_input_times_a_sine_is_a_rounded_one():
    below = B**2 * sp.sin(A) ** 2 + C**2
    *_, size, bound, reach, last = guards(1 / below)[0]
    assert (size, bound) == ("x2 = abs(a)", "x3 = 4.0 * (1.0 + x2)")
    assert (reach, last) == ("x4 = x3 * x3", "x1_or_nan = or_nan(x1, x4, 2)")


def test_stumpff_functions_are_zero_up_to_the_rounding_of_their_argument():
    assert guards(*(C / Stumpff(k, A) for k in range(3)))[0] == [
        "c0_a = c0(a)",
        "c1_a = c1(a)",
        "c2_a = c2(a)",
        "x0 = sqrt(a)",
        "x1 = 4.0 * x0",
        "c0_a_or_nan = or_nan(c0_a, x1)",
        "c1_a_or_nan = or_nan(c1_a, 4.0)",
        "c2_a_or_nan = or_nan(c2_a, 8.0, 2)",
    ]


def test_a_kernel_that_divides_by_nothing_stays_as_it_is():
    assert guards(A * sp.sin(B)) == (["sin_b = sin(b)"], ["a * sin_b"])
    assert guards(A / 3) == ([], ["a / 3.0"])


def test_a_divisor_within_a_sum_and_behind_a_name_is_guarded_once():
    quotient = C / sp.sin(A)
    assert guards(B + quotient, -C * (B + quotient), 1 / (1 + quotient**2)) == (
        [
            "sin_a = sin(a)",
            "sin_a_or_nan = or_nan(sin_a, a)",
            "x0 = c / sin_a_or_nan",
            "x1 = b + x0",
        ],
        ["x1", "-c * x1", "1.0 / (1.0 + x0 * x0)"],
    )


def test_a_divisor_of_a_divisor_is_guarded_first():
    assert guards(C / (B + 1 / sp.sin(A)))[0][:3] == [
        "sin_a = sin(a)",
        "sin_a_or_nan = or_nan(sin_a, a)",
        "x0 = 1.0 / sin_a_or_nan + b",
    ]
