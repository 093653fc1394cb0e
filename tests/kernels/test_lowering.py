"""Lowering: exact, each sine once, no more operations than SymPy's own pass; names and notation."""

from __future__ import annotations

import pytest
import sympy as sp
from hypothesis import given, settings, strategies as st

from rigidsym.algebra.stable_forms import Stumpff
from rigidsym.errors import KernelError
from rigidsym.kernels import ir
from rigidsym.kernels.lowering.graph import Graph, write
from rigidsym.kernels.lowering.lower import MARGIN, lower
from rigidsym.kernels.lowering.naming import Names, identifier
from rigidsym.kernels.lowering.rounding import guarded
from rigidsym.kernels.targets.infix import infix
from rigidsym.kernels.targets.remarks import count
from rigidsym.mechanics.conversions.function import Where
from rigidsym.models.body import principal_moments
from rigidsym.models.library import rotation_from
from rigidsym.motion import derive

A, B, C, D = sp.symbols("a b c d")
INPUTS = {symbol: symbol.name for symbol in (A, B, C, D)}
OBLIQUE = "z(phi) x(theta) [1,1,0](psi)"


def lower_all(expressions, *, constants=None):
    """Assignments and outputs, with sums factored anew unless `constants` is None."""
    graph = Graph("test", INPUTS)
    weighted = [graph.weighted(sp.sympify(e)) for e in expressions]
    roots = [node for _, node in weighted]
    graph = (None if constants is None else graph.factored(roots, constants)) or graph
    graph.share(roots)
    return write(graph, weighted, Names(INPUTS.values()))


EXACT = {"nan": "nan", "choice": "{1} if {0} else {2}", "or_nan": "guarded({})", "abs": "Abs({})"}
NAMES = {"Abs": sp.Abs, "sin": sp.sin, "cos": sp.cos, "sqrt": sp.sqrt, "Q": sp.Rational}


def restored(assignments, outputs, values):
    """The outputs as SymPy expressions, with every assignment put back: what is printed, run."""
    scope = {**NAMES, "guarded": lambda value, *_: value, **values}
    for name, value in assignments:
        scope[name] = eval(infix(value, EXACT, "Q({})"), scope)
    return [eval(infix(output, EXACT, "Q({})"), scope) for output in outputs]


def without_quotients(expression):
    """tan and cot written as quotients, so that only rearrangement is left to undo."""
    expression = expression.replace(sp.tan, lambda x: sp.sin(x) / sp.cos(x))
    return expression.replace(sp.cot, lambda x: sp.cos(x) / sp.sin(x))


def test_kernels_are_exact_single_and_short(motion):
    """Put back; each sine once, and no more operations than SymPy finds."""
    for kernel in lower(motion).kernels:
        margin = [sp.Abs(motion.singularities.determinant)]
        entries = margin if kernel.name == MARGIN else motion.step(kernel.name).expression
        plain = [without_quotients(entry) for entry in entries]
        symbols = {}
        for argument in kernel.arguments:
            symbols |= zip(argument.components, motion.argument(argument.name).symbols, strict=True)
        pairs = zip(restored(kernel.assignments, kernel.outputs, symbols), plain, strict=True)
        assert not any(sp.expand(one - other) for one, other in pairs)
        calls = [a.value for a in kernel.assignments if isinstance(a.value, ir.Call)]
        assert len(calls) == len(set(calls))
        assert {a.name for a in kernel.assignments} <= kernel.used
        shared, rest = sp.cse(plain, order="none")
        theirs = map(sp.count_ops, (*dict(shared).values(), *rest))
        assert count(kernel.values).total() <= sum(theirs), kernel.name


def test_conventions_that_differ_by_the_names_of_axes_are_lowered_once():
    both = zip(*(lower(derive(rotation_from(a))).kernels for a in ("ZXZ", "XYX")), strict=True)
    assert all(one in (other, other.original) for one, other in both)


total, part, small, root, twice, one, same, again = sp.symbols(
    "total part small root twice one same again"
)
LENGTH = sp.sqrt(A**2 + B**2)
LESS = A / 2 + B / 4 - C
QUOTIENT = sp.sin(A) / sp.cos(A)
FORMS = {  # expressions of a, b, c, d
    "a product that several outputs hold is computed once": (A * B * C, A * B * D, A * B),
    "a sum is shared with its negative": (C * (A - B), D * (B - A), -B + A),
    "parts of sums are shared up to a number": (A + 2 * B + C, 3 * A + 6 * B + D),
    "a multiple of the common part is a product": (A + 2 * B, 3 * A + 6 * B, C + A + 2 * B),
    "a sum that does not hold the common part is left alone": (
        *(A + 2 * B + C, 3 * A + 6 * B + D, A + B, C - D, 2 * C + 2 * D, C + D),
    ),
    "the sign of most terms is taken out of a sum": (D * (C - A - B), A + B - C),
    "but not where the numbers of most are positive": (D * LESS, LESS),
    "nor that of one of two": (D * (A / 2 - B), A / 2 - B),
    "a difference is written once": (D * (B - A), A * (B - A)),
    "of equal pairs one that is asked for is shared": (A * B * C, A * B * D, B * C),
    "a minus turns one sum of a product around": (-(A - B) * (C - D) * C, 2 + A, sp.Integer(2)),
    "functions of inputs come first and a sine before its cosine": (
        *(sp.cos(A + B), sp.sin(A + B) + sp.sin(2 * C), sp.cos(D)),
    ),
    "an arctangent comes after the sum that it is of": (sp.atan2(A, B + C), sp.sin(D)),
    "a choice is assigned": (Where(A < B, C, D),),
    "a sine that goes away is not taken": (sp.sin(A) * sp.cot(A),),
    "a square is shared as any product is": (A**2 * B, A**2 * C, A * D),
    "a tangent and the quotient are one thing": (
        *(sp.tan(A) + QUOTIENT, sp.tan(A) - QUOTIENT, sp.tan(A) - QUOTIENT + B),
    ),
    "a product that is part of another is its own common part": (A * B * C, A * B * C * D, A * B),
    "a quotient that is part of a product stays one": (A * B * D / C, A * B / C),
    "powers become products": (A**4 * B,),
    "one reciprocal replaces three divisions": (A / D, B / D, C / D),
    "fractions over a name": (-1 / (3 * A), 2 / (3 * A), 1 / (4 * A)),
    "one fraction over a name": (-1 / (3 * A),),
    "two divisions stay": (A / D, B / D),
    "divisors stand together": (A / (B * C), 1 / (D * (A + B))),
    "numbers": (A / 2, 2 * A / 3, A / 3, sp.Rational(1, 3), sp.Integer(0), sp.Integer(-1)),
    "fixed roots are numbers": (sp.sqrt(2) * A / 2,),
    "angles that are sums get a name": (sp.sin(A + B) * C, sp.cos(A + B)),
    "tangents and secants share a cosine": (sp.tan(A), sp.sec(A), sp.csc(B)),
    "roots are taken once": (A / LENGTH, B * LENGTH, LENGTH**3),
}
HELD = {  # values that are assigned in their order by their names, and expressions of them
    "a value with a name is assigned as it is": (
        *({"total": A + B, "part": C * total}, part - total, total * D),
    ),
    "a multiple is as good as the value": ({"total": 2 * A + 2 * B, "small": -total / 4}, small),
    "what nothing asks for is left out": (
        *({"small": A * B, "total": A + B, "part": C * D}, total, small),
    ),
    "a call is assigned once and its multiple again": (
        *({"root": sp.sqrt(A), "twice": 2 * sp.sin(A)}, root + twice),
    ),
    "a number, an input and a name need no other name": (
        {"one": sp.S.One, "same": A, "total": A + B, "again": total},
        one + same * again,
    ),
}


def test_assignments_are_few_and_in_order(golden):
    """What is shared, what is left alone, and in which form."""
    lines = []
    for title, (values, *outputs) in ({k: ({}, *v) for k, v in FORMS.items()} | HELD).items():
        graph = Graph("test", INPUTS)
        for name, value in values.items():
            graph.hold(sp.Symbol(name), value)
        weighted = list(map(graph.weighted, outputs))
        if not values:
            graph.share(node for _, node in weighted)
        assignments, written = write(graph, weighted, Names(INPUTS.values()))
        lines += [title, *(f"    {a.name} = {infix(a.value)}" for a in assignments)]
        lines += [f"    -> {infix(output)}" for output in written]
    golden("kernels/lowered.txt", "\n".join(lines) + "\n")


LENGTHS = [1 / Stumpff(k, A) for k in range(3)]
QUOTIENT_OF_C = C / sp.sin(A)
GUARDED = {  # divisors, which are NaN where rounding leaves no digit of them
    "a sine that divides is zero up to the rounding of its angle": (
        *(B / sp.sin(A), C / sp.cos(A) + 1 / sp.sin(A)),
    ),
    "squares and a number never vanish": (C / (A**2 + 1), C / (A**2 + B**2 + sp.Rational(1, 2))),
    "inputs and their products have no rounding": (C / A, C / (A * B)),
    "squares of inputs vanish where they underflow": (C / (A**2 + B**2), 1 / (2 * A**2 + 3 * B**2)),
    "a difference is told from zero by the sizes of its terms": (C / (A - B),),
    "squares are their own sizes": (C / (A**2 - B), C / (A**2 - 1)),
    "so are no odd powers and products": (C / (A * B + 1), C / (2 * A * B + 1), C / (A**3 + 1)),
    "squares of sines are told from zero by the squares of their angles": (
        *(C / (sp.sin(A) ** 2 + B**2), 1 / (B**2 * sp.sin(A) ** 2 + C**2)),
    ),
    "functions c_k are zero up to the rounding of their argument": LENGTHS,
    "what divides by nothing or a number stays": (A * sp.sin(B), A / 3),
    "a divisor behind a name is guarded once": (
        *(B + QUOTIENT_OF_C, -C * (B + QUOTIENT_OF_C), 1 / (1 + QUOTIENT_OF_C**2)),
    ),
    "a divisor of a divisor is guarded first": (C / (B + 1 / sp.sin(A)),),
}


def kernel_of(assignments, outputs):
    """A kernel of a, b, c and d."""
    q = ir.KernelArgument(name="q", components=tuple("abcd"), units=("",) * 4, about="", shape=(4,))
    lines = {"assignments": assignments, "outputs": outputs}
    return ir.Kernel(name="area", arguments=(q,), shape=(len(outputs),), **lines)


def test_divisors_are_guarded_where_they_can_vanish(golden):
    lines = []
    for title, expressions in GUARDED.items():
        plain = kernel_of(*lower_all(expressions))
        whole = guarded(plain, Names([*"abcd", *(a.name for a in plain.assignments)]))
        lines += [title, *(f"    {a.name} = {infix(a.value)}" for a in whole.assignments)]
        lines += [f"    -> {infix(output)}" for output in whole.outputs]
    golden("kernels/guarded.txt", "\n".join(lines) + "\n")


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
@settings(max_examples=60, deadline=None)
def test_lowering_is_exact_for_any_sum_of_products_and_quotients(expressions):
    values = {symbol.name: symbol for symbol in INPUTS}
    for constants in (None, "", "ac"):
        found = restored(*lower_all(expressions, constants=constants), values)
        assert all(sp.expand(x - y) == 0 for x, y in zip(found, expressions, strict=True))


NEW = {  # lines of what is factored anew, and its expressions
    "a * c + b * (a + d)": (A * (B + C) + B * D,),
    "-0.0": (A * (B + C) - A * B - A * C,),
    "x0 = a + d; a * b + c * x0; x0; b / (a * (b + d) + c * d)": (  # what divides stays
        *(A * (B + C) + C * D, A + D, B / (A * (B + D) + C * D)),
    ),
    "x0 = b + c; a * (d + x0 * x0)": (A * (B + C) ** 2 + A * (C + D) - A * C,),  # and a power
}


OF_CONSTANTS = {  # the same with the constants a and b
    "x0 = a * b; c * x0 + d * (a + x0)": (A * (B * C + D) + A * B * D,),
    "x0 = a * b; c + d * (b + c) + x0": (A * (C / A + B) + D * (C + B),),  # a / a is no step
}


@pytest.mark.parametrize(("forms", "constants"), [(NEW, ""), (OF_CONSTANTS, "ab")])
def test_sums_are_multiplied_out_and_factored_anew(forms, constants):
    for lines, expressions in forms.items():
        assignments, outputs = lower_all(expressions, constants=constants)
        text = [f"{a.name} = {infix(a.value)}" for a in assignments]
        assert "; ".join([*text, *map(infix, outputs)]) == lines


def test_the_equations_of_a_top_take_few_operations():
    acting = {"body": principal_moments(A, A, C), "potential": "m*g*l*cos(theta)"}
    (kernel,) = lower(derive(rotation_from("ZXZ"), ["state_derivative"], **acting)).kernels
    assert count(kernel.values).total() == 20
    # what is computed once for many tops
    assert {"c / a", "g * l * m / a"} < {infix(value) for value in kernel.values}


def test_what_no_kernel_can_compute_is_named():
    message = r"^test: no kernel can compute exp\(a\) \(exp\); expected .* cosines of a, b, c, d$"
    with pytest.raises(KernelError, match=message):
        lower_all([sp.exp(A) * B])


def test_a_kernel_that_is_not_single_assignment_is_refused():
    area = ir.Assignment("x0", ir.Product((ir.Name("a"), ir.Name("b"))))
    for times, message in (0, "x0 is used before it is defined"), (2, "x0 is defined twice"):
        with pytest.raises(KernelError, match=f"^area: {message}$"):
            kernel_of((area,) * times, (ir.Name("x0"),))


@pytest.mark.parametrize(
    ("name", "value"),
    [("ZYX", "abs_cos_theta"), ("rotation_vector", "2.0 * abs_c2_x0"), (OBLIQUE, "0.5 * abs_x0")],
)
def test_the_margin_is_scaled_to_one_if_its_largest_value_is_known(name, value):
    program = lower(derive(rotation_from(name), only=["inverse_rate_matrix_space"]))
    assert program.kernels[-1].name == MARGIN
    assert infix(program.kernels[-1].outputs[0]) == value


def test_names_become_identifiers_that_are_given_once():
    texts = {"phi": "phi", "θ": "θ", "ϕ": "φ", r"\theta'": "theta", "2nd": "v2nd", "_": "v"}
    assert {text: identifier(text) for text in texts} == texts
    names = Names(["lambda", "x0"])
    fresh = [names.fresh(n) for n in ("lambda", "phi", "phi", "lambda")]
    assert fresh == ["lambda_", "phi", "phi_", "lambda__"]
    assert [names.numbered("x"), names.numbered("x")] == ["x1", "x2"]
