"""Lowering: exact, each sine once, no more operations than SymPy's own pass."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
import sympy as sp
from hypothesis import given, settings, strategies as st

import rigidsym as rs
from rigidsym.errors import KernelError
from rigidsym.kernels import ir
from rigidsym.kernels.ir import Assignment, Call, Guarded, Name, Negative, Number, Product, Sum
from rigidsym.kernels.lowering.cse import Reader
from rigidsym.kernels.lowering.lower import MARGIN, lower
from rigidsym.kernels.lowering.naming import Names
from rigidsym.kernels.lowering.schedule import narrowed, write
from rigidsym.kernels.targets.text.infix import infix
from rigidsym.kernels.targets.text.python import assignment_lines, bracketed
from rigidsym.kernels.targets.text.remarks import Operations, count
from rigidsym.mechanics.conversions.function import Where

A, B, C, D = sp.symbols("a b c d")
INPUTS = {symbol: symbol.name for symbol in (A, B, C, D)}
SAME = {name: name for name in ir.FUNCTIONS}


def lowered(*expressions: sp.Expr) -> tuple[list[str], list[str]]:
    """Assignments and outputs of expressions in a, b, c, d, as text."""
    assignments, outputs = lower_all(expressions)
    return (
        [f"{a.name} = {infix(a.value, SAME)}" for a in assignments],
        [infix(output, SAME) for output in outputs],
    )


def lower_all(expressions):
    reader = Reader("test", INPUTS)
    weighted = [reader.weighted(sp.sympify(e)) for e in expressions]
    reader.graph.share(node for _, node in weighted)
    return write(reader.graph, weighted, Names(INPUTS.values()))


def restored(assignments, outputs, values):
    """The outputs as SymPy expressions, with every assignment put back."""
    for assignment in assignments:
        values[assignment.name] = in_sympy(assignment.value, values)
    return [in_sympy(output, values) for output in outputs]


def in_sympy(expression, values):
    match expression:
        case Name(text):
            return values[text]
        case Number(value):
            return sp.Rational(value.numerator, value.denominator)
        case Negative(operand):
            return -in_sympy(operand, values)
        case Sum(terms):
            return sp.Add(*(in_sympy(term, values) for term in terms))
        case Product(factors, divisors):
            above = sp.Mul(*(in_sympy(factor, values) for factor in factors))
            return above / sp.Mul(*(in_sympy(divisor, values) for divisor in divisors))
        case Call("abs", argument):
            return sp.Abs(values[argument.text])
        case Call(function, argument):
            return getattr(sp, function)(values[argument.text])
        case Guarded(value, _):
            return values[value.text]


def without_quotients(expression):
    """tan and cot written as quotients, so that only rearrangement is left to undo."""
    return expression.replace(sp.tan, lambda x: sp.sin(x) / sp.cos(x)).replace(
        sp.cot, lambda x: sp.cos(x) / sp.sin(x)
    )


def expressions_of(motion: rs.Motion, kernel: str) -> list[sp.Expr]:
    """What a kernel computes, entry by entry."""
    if kernel == MARGIN:
        return [sp.Abs(motion.singularities.determinant)]
    return list(motion.step(kernel).expression)


def program(motion: rs.Motion) -> ir.Program:
    return lower(motion)


def test_assignments_put_back_are_the_derivation(motion):
    for kernel in program(motion).kernels:
        values = {
            name: symbol
            for argument in kernel.arguments
            for name, symbol in zip(
                argument.components, motion.argument(argument.name).symbols, strict=True
            )
        }
        found = restored(kernel.assignments, kernel.outputs, values)
        for output, entry in zip(found, expressions_of(motion, kernel.name), strict=True):
            assert sp.expand(output - without_quotients(entry)) == 0


def test_narrow_lines_change_nothing(motion):
    for kernel in program(motion).kernels:
        narrow = narrowed(kernel, lambda e: infix(e, SAME), line=45, output=30)
        assert count(narrow.values) == count(kernel.values)
        symbols = {name: sp.Symbol(name) for name in kernel.components}
        before = restored(kernel.assignments, kernel.outputs, dict(symbols))
        after = restored(narrow.assignments, narrow.outputs, dict(symbols))
        assert [sp.expand(x - y) for x, y in zip(before, after, strict=True)] == [0] * len(before)


def test_sine_and_cosine_are_taken_once_and_only_where_needed(motion):
    for kernel in program(motion).kernels:
        calls = [a.value for a in kernel.assignments if isinstance(a.value, Call)]
        assert len(calls) == len(set(calls))
        used = {name for a in kernel.assignments for name in ir.names_in(a.value)}
        used |= {name for output in kernel.outputs for name in ir.names_in(output)}
        assert {a.name for a in kernel.assignments} <= used


def test_no_more_operations_than_sympy_finds(motion):
    for kernel in program(motion).kernels:
        entries = [without_quotients(e) for e in expressions_of(motion, kernel.name)]
        shared, left = sp.cse(entries, order="none")
        theirs = sum(sp.count_ops(e) for e in (*(e for _, e in shared), *left))
        assert count(kernel.values).total() <= theirs, kernel.name


def test_each_sine_of_an_angle_is_counted_once(motion):
    kernel = next(k for k in program(motion).kernels if k.name == "rotation_matrix")
    assert count(kernel.values)["trigonometric"] == 6
    assert count(kernel.values).total() <= 24


def test_a_product_that_several_outputs_hold_is_computed_once():
    assert lowered(A * B * C, A * B * D, A * B) == (
        ["x0 = a * b"],
        ["c * x0", "d * x0", "x0"],
    )


def test_a_sum_is_shared_with_its_negative():
    assert lowered(C * (A - B), D * (B - A), -B + A) == (
        ["x0 = a - b"],
        ["c * x0", "-d * x0", "x0"],
    )


def test_parts_of_sums_are_shared_up_to_a_number():
    assert lowered(A + 2 * B + C, 3 * A + 6 * B + D) == (
        ["x0 = a + 2.0 * b"],
        ["c + x0", "d + 3.0 * x0"],
    )


def test_a_sum_that_is_a_multiple_of_the_common_part_is_a_product():
    assert lowered(A + 2 * B, 3 * A + 6 * B, C + A + 2 * B) == (
        ["x0 = a + 2.0 * b"],
        ["x0", "3.0 * x0", "c + x0"],
    )


def test_a_sum_that_does_not_hold_the_common_part_is_left_alone():
    assert lowered(A + 2 * B + C, 3 * A + 6 * B + D, A + B, C - D, 2 * C + 2 * D, C + D) == (
        ["x0 = a + 2.0 * b", "x1 = c + d"],
        ["c + x0", "d + 3.0 * x0", "a + b", "c - d", "2.0 * x1", "x1"],
    )


def test_the_sign_of_most_terms_is_taken_out_of_a_sum():
    assert lowered(D * (C - A - B), A + B - C) == (["x0 = a + b - c"], ["-d * x0", "x0"])
    less = A / 2 + B / 4 - C
    assert lowered(D * less, less) == (["x0 = 0.5 * a + 0.25 * b - c"], ["d * x0", "x0"])
    assert lowered(D * (A / 2 - B), A / 2 - B) == (["x0 = 0.5 * a - b"], ["d * x0", "x0"])
    assert lowered(D * (B - A), A * (B - A)) == (["x0 = a - b"], ["-d * x0", "-a * x0"])


def test_of_pairs_that_occur_equally_often_one_that_is_asked_for_is_shared():
    assert lowered(A * B * C, A * B * D, B * C) == (
        ["x0 = b * c"],
        ["a * x0", "a * b * d", "x0"],
    )


def test_a_minus_turns_one_sum_of_a_product_around():
    assert lowered(-(A - B) * (C - D) * C, 2 + A, sp.Integer(2)) == (
        [],
        ["c * (b - a) * (c - d)", "2.0 + a", "2.0"],
    )


def test_functions_of_inputs_come_first_and_a_sine_before_its_cosine():
    assert lowered(sp.cos(A + B), sp.sin(A + B) + sp.sin(2 * C), sp.cos(D))[0] == [
        "cos_d = cos(d)",
        "x0 = a + b",
        "sin_x0 = sin(x0)",
        "cos_x0 = cos(x0)",
        "x1 = 2.0 * c",
        "sin_x1 = sin(x1)",
    ]
    assert lowered(sp.atan2(A, B + C), sp.sin(D))[0] == [
        "sin_d = sin(d)",
        "x0 = b + c",
        "atan2_0 = atan2(a, x0)",
    ]


@pytest.mark.parametrize(("length", "name"), [(20, f"sin_{'a' * 20}"), (21, "sin_0")])
def test_a_sine_has_the_name_of_its_argument_unless_that_is_long(length, name):
    angle = sp.Symbol("a" * length)
    reader = Reader("test", {angle: angle.name})
    (call,), _ = write(reader.graph, [reader.weighted(sp.sin(angle))], Names([angle.name]))
    assert call.name == name


def test_a_sum_within_a_sum_is_taken_apart_if_nothing_else_uses_it():
    reader = Reader("test", INPUTS, {sp.Symbol("e"): A - B})
    weighted = [reader.weighted(C - 3 * sp.Symbol("e"))]
    _, (output,) = write(reader.graph, weighted, Names(INPUTS.values()))
    assert infix(output, SAME) == "3.0 * b + c - 3.0 * a"


def test_a_choice_is_assigned():
    assert lowered(Where(A < B, C, D)) == (["x0 = c if a < b else d"], ["x0"])


def test_a_sine_that_goes_away_is_not_taken():
    assert lowered(sp.sin(A) * sp.cot(A)) == (["cos_a = cos(a)"], ["cos_a"])


def test_a_square_is_shared_as_any_product_is():
    assert lowered(A**2 * B, A**2 * C, A * D) == (
        ["x0 = a * a"],
        ["b * x0", "c * x0", "a * d"],
    )


def test_a_tangent_and_the_quotient_of_sine_and_cosine_are_one_thing():
    quotient = sp.sin(A) / sp.cos(A)
    assert lowered(sp.tan(A) + quotient, sp.tan(A) - quotient, sp.tan(A) - quotient + B) == (
        ["sin_a = sin(a)", "cos_a = cos(a)"],
        ["2.0 * sin_a / cos_a", "0.0", "b"],
    )


def held(values, *outputs):
    """Assignments and outputs where values are to be assigned in their order by their names."""
    reader = Reader("test", INPUTS)
    for name, value in values.items():
        reader.hold(sp.Symbol(name), sp.sympify(value))
    weighted = [reader.weighted(output) for output in outputs]
    assignments, found = write(reader.graph, weighted, Names(INPUTS.values()))
    return (
        [f"{a.name} = {infix(a.value, SAME)}" for a in assignments],
        [infix(output, SAME) for output in found],
    )


def test_a_value_with_a_name_is_assigned_as_it_is():
    total, part, small = sp.symbols("total part small")
    assert held({"total": A + B, "part": C * total}, part - total, total * D) == (
        ["total = a + b", "part = c * total"],
        ["part - total", "d * total"],
    )
    assert held({"total": 2 * A + 2 * B, "small": -total / 4}, small) == (
        ["total = 2.0 * (a + b)"],
        ["-0.25 * total"],  # a multiple is as good as the value
    )
    values = {"small": A * B, "total": A + B, "part": C * D}  # which nothing asks for
    assert held(values, total, small) == (["small = a * b", "total = a + b"], ["total", "small"])


def test_a_call_with_a_name_is_assigned_once_and_its_multiple_again():
    root, twice = sp.symbols("root twice")
    assert held({"root": sp.sqrt(A), "twice": 2 * sp.sin(A)}, root + twice) == (
        ["sin_a = sin(a)", "root = sqrt(a)", "twice = 2.0 * sin_a"],
        ["root + twice"],
    )


def test_a_number_an_input_and_a_name_that_is_held_need_no_other_name():
    one, same, total, again = sp.symbols("one same total again")
    values = {"one": sp.S.One, "same": A, "total": A + B, "again": total}
    assert held(values, one + same * again) == (["total = a + b"], ["1.0 + a * total"])


def test_a_product_that_is_part_of_another_is_its_own_common_part():
    assert lowered(A * B * C, A * B * C * D, A * B) == (
        ["x0 = a * b", "x1 = c * x0"],
        ["x1", "d * x1", "x0"],
    )
    _, outputs = lower_all([A * B * C, A * B * C * D, A * B])
    assert outputs[0] == Name("x1")


def test_a_quotient_that_is_part_of_a_product_stays_one():
    assert lowered(A * B * D / C, A * B / C) == (["x0 = a * b / c"], ["d * x0", "x0"])


def test_powers_become_products():
    assert lowered(A**4 * B) == (["x0 = a * a"], ["b * x0 * x0"])


def test_one_reciprocal_replaces_three_divisions():
    assignments, outputs = lowered(A / D, B / D, C / D)
    assert assignments == ["x0 = 1.0 / d"]
    assert outputs == ["a * x0", "b * x0", "c * x0"]


def test_a_fraction_over_a_name():
    assert lowered(-1 / (3 * A), 2 / (3 * A), 1 / (4 * A)) == (
        ["x0 = 1.0 / a"],
        ["-x0 / 3.0", "2.0 * x0 / 3.0", "0.25 * x0"],
    )
    assert lowered(-1 / (3 * A)) == ([], ["-1.0 / (a * 3.0)"])


def test_two_divisions_stay():
    assert lowered(A / D, B / D) == ([], ["a / d", "b / d"])


def test_divisors_stand_together():
    assert lowered(A / (B * C), 1 / (D * (A + B))) == ([], ["a / (b * c)", "1.0 / (d * (a + b))"])


def test_numbers():
    assert lowered(A / 2, 2 * A / 3, A / 3, sp.Rational(1, 3), sp.Integer(0), sp.Integer(-1)) == (
        [],
        ["0.5 * a", "2.0 * a / 3.0", "a / 3.0", "1.0 / 3.0", "0.0", "-1.0"],
    )


def test_fixed_roots_are_numbers():
    assert lowered(sp.sqrt(2) * A / 2) == ([], ["0.5 * 1.4142135623730951 * a"])


def test_angles_that_are_sums_get_a_name():
    assignments, outputs = lowered(sp.sin(A + B) * C, sp.cos(A + B))
    assert assignments == ["x0 = a + b", "sin_x0 = sin(x0)", "cos_x0 = cos(x0)"]
    assert outputs == ["c * sin_x0", "cos_x0"]


def test_tangents_and_secants_share_a_cosine():
    assignments, outputs = lowered(sp.tan(A), sp.sec(A), sp.csc(B))
    assert assignments == ["sin_a = sin(a)", "cos_a = cos(a)", "sin_b = sin(b)"]
    assert outputs == ["sin_a / cos_a", "1.0 / cos_a", "1.0 / sin_b"]


def test_roots_are_taken_once():
    length = sp.sqrt(A**2 + B**2)
    assignments, outputs = lowered(A / length, B * length, length**3)
    assert "sqrt_x0 = sqrt(x0)" in assignments
    assert outputs[:2] == ["a / sqrt_x0", "b * sqrt_x0"]


def test_what_no_kernel_can_compute_is_named():
    with pytest.raises(KernelError) as caught:
        lowered(sp.exp(A) * B)
    assert str(caught.value) == (
        "test: no kernel can compute exp(a) (exp); "
        "expected sums, products, roots, sines and cosines of a, b, c, d"
    )


def test_an_input_that_is_not_declared_is_named():
    with pytest.raises(KernelError, match=r"test: no kernel can compute e \(Symbol\)"):
        lowered(sp.Symbol("e"))


LEAVES = st.sampled_from([A, B, C, D, sp.Integer(2), sp.Integer(-1), sp.Rational(1, 2)])
EXPRESSIONS = st.recursive(
    LEAVES,
    lambda e: st.one_of(
        st.lists(e, min_size=2, max_size=4).map(lambda parts: sp.Add(*parts)),
        st.lists(e, min_size=2, max_size=3).map(lambda parts: sp.Mul(*parts)),
        e.map(lambda x: x**2),
        st.tuples(e, st.sampled_from([A, B, 3 * C])).map(lambda pair: pair[0] / pair[1]),
    ),
    max_leaves=12,
)


@given(st.lists(EXPRESSIONS, min_size=1, max_size=5))
@settings(max_examples=150, deadline=None)
def test_lowering_is_exact_for_any_sum_of_products_and_quotients(expressions):
    assignments, outputs = lower_all(expressions)
    values = {symbol.name: symbol for symbol in INPUTS}
    found = restored(assignments, outputs, values)
    assert [sp.expand(x - y) for x, y in zip(found, expressions, strict=True)] == [0] * len(found)


@given(st.lists(EXPRESSIONS, min_size=1, max_size=3))
@settings(max_examples=80, deadline=None)
def test_printed_text_has_the_value_of_the_tree(expressions):
    assignments, outputs = lower_all(expressions)
    values = {"a": 1.25, "b": -0.5, "c": 3.0, "d": 0.75}
    exact = {sp.Symbol(name): sp.Rational(value) for name, value in values.items()}
    for assignment in assignments:
        values[assignment.name] = float(sp.sympify(infix(assignment.value, SAME), locals=values))
    for output, expression in zip(outputs, expressions, strict=True):
        printed = float(sp.sympify(infix(output, SAME), locals=values))
        assert printed == pytest.approx(float(expression.subs(exact)), rel=1e-12, abs=1e-12)


a, b, c = Name("a"), Name("b"), Name("c")


@pytest.mark.parametrize(
    ("tree", "text"),
    [
        (Negative(Sum((a, b))), "-(a + b)"),
        (Negative(Product((a, b))), "-a * b"),
        (Sum((Negative(a), Negative(Sum((b, c))))), "-a - (b + c)"),
        (Sum((a, Negative(Product((b, c))))), "a - b * c"),
        (Product((Negative(a), b)), "(-a) * b"),
        (Product((a, Sum((b, c)))), "a * (b + c)"),
        (Product((a,), (b,)), "a / b"),
        (Product((a,), (b, c)), "a / (b * c)"),
        (Product((a,), (Sum((b, c)),)), "a / (b + c)"),
        (Product((a,), (Product((b, c)),)), "a / (b * c)"),
        (Call("sqrt", a), "sqrt(a)"),
        (Number(Fraction(3, 4)), "0.75"),
        (Product((Number(Fraction(2)), a), (Number(Fraction(3)),)), "2.0 * a / 3.0"),
        (Number(0.1), "0.1"),
        (Sum((a, Number(Fraction(1, 3)))), "a + 1.0 / 3.0"),
        (Product((a,), (Number(Fraction(1, 3)),)), "a / (1.0 / 3.0)"),
    ],
)
def test_trees_are_printed_with_the_brackets_they_need(tree, text):
    assert infix(tree, SAME) == text


@pytest.mark.parametrize(("second", "lines"), [(39, 1), (40, 3), (41, 4)])
def test_items_are_laid_out_by_width(second, lines):
    text = bracketed(4, "fun(", ["a" * 38, "b" * second], ")")
    assert len(text.splitlines()) == lines
    assert max(map(len, text.splitlines())) <= 88


@pytest.mark.parametrize(("size", "lines"), [(42, 1), (43, 3), (80, 3), (81, 4)])
def test_wide_assignments_get_brackets(size, lines):
    text = assignment_lines(4, "a" * 39, f"{'b' * (size - 4)} * c")
    assert len(text.splitlines()) == lines
    assert max(map(len, text.splitlines())) <= 88


def test_operations_are_counted_as_written():
    expressions = [
        Negative(Product((a, b))),
        Sum((a, Negative(b), a)),
        Product((Sum((a, b)),), (a, b)),
        Sum((Negative(a), Negative(b))),
        Call("sqrt", a),
    ]
    counted = count(expressions)
    assert counted == Operations(roots=1, multiplications=2, divisions=1, additions=4, negations=2)
    assert str(counted) == (
        "10 operations: 1 square root, 2 multiplications, 1 division, 4 additions, "
        "2 changes of sign"
    )
    assert str(Operations()) == "no operations"
    assert str(Operations(additions=1)) == "1 operation: 1 addition"


KERNEL = ir.Kernel(
    name="area",
    arguments=(
        ir.KernelArgument(name="q", components=("a", "b"), units=("m", "m"), about="sides"),
    ),
    assignments=(Assignment("x0", Product((Name("a"), Name("b")))),),
    outputs=(Name("x0"),),
    shape=(1,),
    equation=1,
    symbol="S",
    definition="a b",
    about="area",
    unit="m^2",
)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"shape": (2,)}, "area: shape (2,) needs 2 outputs, got 1"),
        ({"assignments": ()}, "area: x0 is used before it is defined"),
        ({"assignments": (*KERNEL.assignments, *KERNEL.assignments)}, "area: x0 is defined twice"),
        ({"assignments": (Assignment("a", Name("b")),)}, "area: a is defined twice"),
        (
            {"outputs": (Product((Name("a"), Call("sin", Name("b")))),)},
            "area: sin is called inside an expression",
        ),
    ],
)
def test_a_kernel_that_is_not_single_assignment_is_refused(changes, message):
    with pytest.raises(KernelError) as caught:
        replace(KERNEL, **changes)
    assert str(caught.value) == message


def test_what_reaches_a_divisor_is_delicate():
    quotient = Product((Name("a"),), (Name("x1"),))
    kernel = replace(
        KERNEL,
        assignments=(
            Assignment("x0", Product((Name("a"), Name("a")))),
            Assignment("x1", Product((Name("x0"), Number(Fraction(2))))),
            Assignment("x2", Product((Name("b"), Name("b")))),
        ),
        outputs=(Sum((quotient, Name("x2"))),),
    )
    assert kernel.divisors == (Name("x1"),)
    assert kernel.delicate == {"x1", "x0", "a"}
    rounded = Assignment("x1", Sum((Name("x0"), Number(Fraction(1)))))
    summed = replace(kernel, assignments=(kernel.assignments[0], rounded, kernel.assignments[2]))
    assert summed.delicate == {"x1"}  # a sum has a rounding of its own
