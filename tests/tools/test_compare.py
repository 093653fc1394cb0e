"""`compare` names what is wrong with a formula: each kind of error, seeded into known formulas."""

from __future__ import annotations

from functools import cache

import pytest
import sympy as sp

import rigidsym as rs
from rigidsym.errors import ExpressionError
from rigidsym.tools.compare.program import formula_matrix

CASES = [
    ("ZXZ", "rotation_matrix"),
    ("unit_quaternion", "rotation_matrix"),
    ("xyz", "inverse_rate_matrix_body"),
    ("zxz", "angular_velocity_body"),
    ("modified_rodrigues", "inverse_rate_matrix_body"),
    ("unit_quaternion", "rate_matrix_body"),
]


@cache
def right(rotation: str, quantity: str) -> sp.Matrix:
    """The quantity in symbols."""
    motion = rs.derive(rotation, quantity)
    names = {
        symbol: sp.Symbol(name, real=True)
        for argument in motion.arguments
        for name, symbol in zip(argument.names, argument.symbols, strict=True)
    }
    return sp.Matrix(getattr(motion, quantity)).xreplace(names)


def turned_sign(entry: sp.Expr) -> sp.Expr:
    return entry - 2 * sp.Add.make_args(entry)[0]


def other_function(entry: sp.Expr) -> sp.Expr:
    found = sorted(entry.atoms(sp.sin, sp.cos), key=str)[:1]
    return entry.xreplace({f: {sp.sin: sp.cos, sp.cos: sp.sin}[f.func](*f.args) for f in found})


def other_name(entry: sp.Expr) -> sp.Expr:
    """Another name in one function, or in one term."""
    parts = sorted(entry.atoms(sp.sin, sp.cos), key=str) or sorted(sp.Add.make_args(entry), key=str)
    names = sorted(set().union(*(part.free_symbols for part in parts)), key=str)
    if len(names) < 2:
        return entry
    first = min(parts[0].free_symbols or names, key=str)
    changed = parts[0].xreplace({first: next(name for name in names if name != first)})
    if parts[0].is_Function:
        changed = entry.xreplace({parts[0]: changed})
        return entry if changed.is_number else changed
    changed = entry - parts[0] + changed
    return changed if len(changed.args) == len(entry.args) else entry


def added_square(entry: sp.Expr) -> sp.Expr:
    found = sorted(entry.atoms(sp.sin, sp.cos), key=str)[:1]
    return entry.xreplace({f: f**2 for f in found})


def missing_square(entry: sp.Expr) -> sp.Expr:
    found = [p for p in sorted(entry.atoms(sp.Pow), key=str) if p.exp == 2][:1]
    return entry.xreplace({p: p.base for p in found})


def doubled(entry: sp.Expr) -> sp.Expr:
    return entry + sp.Add.make_args(entry)[0]


def half_angle(entry: sp.Expr) -> sp.Expr:
    found = sorted(entry.atoms(sp.sin, sp.cos), key=str)[:1]
    return entry.xreplace({f: f.func(f.args[0] / 2) for f in found})


def lost_factor(entry: sp.Expr) -> sp.Expr:
    terms = sp.Add.make_args(entry)
    factors = [f for f in terms[0].args if isinstance(f, sp.sin | sp.cos)]
    return entry - terms[0] + terms[0] / factors[0] if terms[0].is_Mul and factors else entry


SEEDS = {
    "sign": turned_sign,
    "sine and cosine": other_function,
    "index": other_name,
    "square": added_square,
    "square ": missing_square,
    "factor": doubled,
    "half angle": half_angle,
    "product": lost_factor,
}


def seeded(case, seed):
    """The formula with the error in its last entry that can have it, and where that is; or None."""
    formula = right(*case).as_mutable()
    for i, j in reversed([(i, j) for i in range(formula.rows) for j in range(formula.cols)]):
        changed = seed(formula[i, j])
        if changed != formula[i, j] and formula[i, j] != 0:
            formula[i, j] = changed
            return formula, (i + 1, j + 1)
    return None


ERRORS = [(case, kind) for case in CASES for kind, seed in SEEDS.items() if seeded(case, seed)]


@pytest.mark.parametrize(
    ("case", "kind"), ERRORS, ids=lambda v: "-".join(v) if type(v) is tuple else v
)
def test_one_wrong_entry_is_found_and_its_repair_is_proved(case, kind):
    formula, place = seeded(case, SEEDS[kind])
    found = rs.compare(str(formula.tolist()), *case)
    (repair,) = found.repairs
    assert (repair.place, repair.kind, found.is_proved) == (place, kind.strip(), True)
    assert not found.is_equal


def seeded_whole(kind: str, case: tuple[str, str]) -> sp.Matrix:
    formula = right(*case).as_mutable()
    if kind == "transpose":
        return formula.T
    if kind == "sign":
        return -formula
    if kind == "factor":
        return formula / 2
    if kind == "exchange":
        places = [(i, j) for i in range(formula.rows) for j in range(formula.cols)]
        one = next(place for place in places if formula[place] != 0)
        two = next(place for place in places if formula[place] not in (0, formula[one]))
        formula[one], formula[two] = formula[two], formula[one]
        return formula
    if kind == "frame":
        frames = {"body": "space", "space": "body"}
        name, frame = case[1].rsplit("_", 1)
        return right(case[0], f"{name}_{frames[frame]}")
    assert kind == "order of the turns"
    return right(case[0].swapcase(), case[1])


WHOLE = [
    (kind, case)
    for case in [c for c in CASES if c[0].isalpha()]
    for kind in ("transpose", "sign", "factor", "exchange", "frame", "order of the turns")
    if not (kind == "transpose" and "velocity" in case[1])
    and not (kind == "frame" and case[1] == "rotation_matrix")
]


@pytest.mark.parametrize(("kind", "case"), WHOLE, ids=str)
def test_a_change_of_the_whole_formula_is_named(kind, case):
    found = rs.compare(seeded_whole(kind, case), *case)
    (repair,) = found.repairs
    assert found.is_proved
    assert kind in (repair.kind,)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_a_right_formula_is_proved(case):
    found = rs.compare(str(right(*case).tolist()), *case)
    assert found.is_equal
    assert found.is_proved


def test_another_convention_is_named_although_one_sign_would_repair_the_formula():
    found = rs.compare(right("zxz", "angular_velocity_space"), "ZXZ", "angular_velocity_body")
    assert [repair.kind for repair in found.repairs] == ["sign"]
    assert str(found.as_it_stands) == "angular_velocity_space of zxz"
    assert "as it stands this is angular_velocity_space of zxz" in found.text()


def test_constants_of_a_body_are_names_too():
    motion = rs.derive("ZXZ", "inertia_tensor", body=rs.solid("cone"))
    tensor = sp.Matrix(motion.inertia_tensor)
    assert rs.compare(str(tensor.tolist()), motion, "inertia_tensor").is_equal
    assert rs.compare(tensor / 2, motion, "inertia_tensor").repairs[0].kind == "factor"


def test_numbers_that_nearly_agree_are_not_equal():
    text = "[[1, 0, 0], [0, cos(a), -1.0000000000001*sin(a)], [0, sin(a), cos(a)]]"
    assert rs.compare(text).found is None


def test_a_long_wrong_entry_is_not_searched_for_ever():
    formula = right("ZXZ", "rate_matrix_body").as_mutable()
    formula[0, 0] += sum(sp.sin(k * sp.Symbol("psi")) for k in range(1, 80))
    (repair,) = rs.compare(formula, "ZXZ", "rate_matrix_body").repairs
    assert (repair.kind, repair.place) == ("entry", (1, 1))


def test_a_forgotten_operator_is_named_with_its_neighbours():
    with pytest.raises(ExpressionError) as caught:
        formula_matrix("Rz(q1) Ry(q2)")
    assert "operator such as * between 'Rz(q1)' and 'Ry'" in str(caught.value)
    assert caught.value.column == 8
    with pytest.raises(ExpressionError, match="`a or b` is not understood"):
        formula_matrix("a or b")
    with pytest.raises(ExpressionError, match="is nested too deeply"):
        formula_matrix("-" * 3000 + "a")
    with pytest.raises(ExpressionError, match=r"`\* psi` is not understood"):
        formula_matrix("phi + * psi")


@pytest.mark.parametrize(
    ("text", "entries"),
    [
        ("+[[a, b], [c, d]].T", "[[a, c], [b, d]]"),
        ("[[a, b], [c, d]]**2", "[[a**2 + b*c, a*b + b*d], [a*c + c*d, b*c + d**2]]"),
        ("pow(a, 3) - sq(b)", "[[a**3 - b**2]]"),
    ],
)
def test_a_formula_may_use_operations_of_matrices(text, entries):
    names = {name: sp.Symbol(name, real=True) for name in "abcd"}
    difference = formula_matrix(text) - sp.Matrix(sp.sympify(entries, names))
    assert difference.expand().is_zero_matrix


def test_the_finding_is_said_in_one_sentence():
    matrix, unknown = right("ZYX", "rotation_matrix"), "[[cos(phi), 2, psi], [3, 0, 1], [0, 0, 7]]"
    end = "and no single change makes it one"
    for found, sentence in (
        (rs.compare(matrix), "equal to rotation_matrix of ZYX (proved)"),
        (rs.compare(matrix.T), "transposed (passive, the direction cosine matrix)"),
        (rs.compare(unknown), f"not a known quantity, {end}"),
        (rs.compare(unknown, "ZYX", "rotation_matrix"), f"not rotation_matrix of ZYX, {end}"),
        (rs.compare(matrix, "xyx", "rotation_matrix"), "this is rotation_matrix of ZYX"),
    ):
        assert sentence in found.text()


def test_a_rotation_is_compared_with_a_quantity():
    with pytest.raises(ExpressionError, match="expected a rotation and a quantity"):
        rs.compare("[[1, 0], [0, 1]]", "ZYX")


@pytest.mark.parametrize("last", [False, True], ids=["first", "last"])
@pytest.mark.parametrize("factor", [1, 2])
def test_the_matrix_that_takes_a_quaternion_to_its_rates_is_known(last, factor):
    a, b, c = sp.symbols("omega_1:4", real=True)
    rates = sp.Matrix([[0, -a, -b, -c], [a, 0, c, -b], [b, -c, 0, a], [c, b, -a, 0]]) * factor / 2
    places = [1, 2, 3, 0] if last else [0, 1, 2, 3]
    found = rs.compare(rates.extract(places, places))
    words = filter(None, ("scalar last" if last else "", "twice" if factor == 2 else ""))
    end = "".join(f", {word}" for word in words)
    assert (
        found.text() == f"equal to quaternion_rate_operator_body of unit_quaternion{end} (proved)"
    )


OF_QUATERNION = [  # in Python, in C with the scalar last, and in LaTeX
    "[2*(q0*dq1 - q1*dq0 - q2*dq3 + q3*dq2), 2*(q0*dq2 - q2*dq0 - q3*dq1 + q1*dq3), "
    "2*(q0*dq3 - q3*dq0 - q1*dq2 + q2*dq1)]",
    "{2*(q[3]*qd[0]-q[0]*qd[3]-q[1]*qd[2]+q[2]*qd[1]), 2*(q[3]*qd[1]-q[1]*qd[3]-q[2]*qd[0]+"
    "q[0]*qd[2]), 2*(q[3]*qd[2]-q[2]*qd[3]-q[0]*qd[1]+q[1]*qd[0])}",
    r"2\begin{pmatrix} q_0 \dot q_1 - q_1 \dot q_0 - q_2\dot q_3 + q_3\dot q_2 \\ q_0\dot q_2 - "
    r"q_2\dot q_0 - q_3\dot q_1 + q_1\dot q_3 \\ q_0\dot q_3 - q_3\dot q_0 - q_1\dot q_2 + "
    r"q_2\dot q_1\end{pmatrix}",
]


@pytest.mark.parametrize("text", OF_QUATERNION, ids=["python", "c", "latex"])
def test_the_angular_velocity_of_a_quaternion_is_known_unaided(text):
    found = rs.compare(text)
    assert str(found.found) == "angular_velocity_body of unit_quaternion"
    assert (found.is_equal, found.is_proved, len(found.record()["names"])) == (True, True, 8)


@pytest.mark.parametrize("rotation", ["unit_quaternion", "gibbs_vector"])
def test_p_q_r_are_body_rates_beside_components_called_q(rotation):
    rates = right(rotation, "rates_from_angular_velocity_body")
    motion = rs.derive(rotation, "rates_from_angular_velocity_body")
    old = [n for argument in motion.arguments for n in argument.names]
    new = [f"q{k}" for k in range(1, len(old) - 2)] + [*"pqr"]
    names = {sp.Symbol(a, real=True): sp.Symbol(b) for a, b in zip(old, new, strict=True)}
    found = rs.compare(str(rates.xreplace(names).tolist()))
    assert str(found.found) == f"rates_from_angular_velocity_body of {rotation}"


@pytest.mark.parametrize("rotation", ["gibbs_vector", "modified_rodrigues"])
@pytest.mark.parametrize("quantity", ["angular_velocity_space", "rates_from_angular_velocity_body"])
def test_quantities_of_vectors_are_known_unaided(rotation, quantity):
    found = rs.compare(right(rotation, quantity))
    assert (str(found.found), found.is_proved) == (f"{quantity} of {rotation}", True)


def test_the_jacobian_of_a_rotation_vector_is_known_by_the_name_of_its_angle():
    skew = "C([x, y, z])"
    text = f"one(3) + (1 - cos(theta))/theta**2*{skew} + (theta - sin(theta))/theta**3*{skew}**2"
    found = rs.compare(text)
    assert str(found.found) == "rate_matrix_space of rotation_vector"
    assert found.is_equal


@pytest.mark.parametrize(
    ("case", "change", "kind"),
    [
        (("unit_quaternion", "angular_velocity_body"), lambda m: -m, "sign"),
        (("unit_quaternion", "angular_velocity_body"), lambda m: m / 2, "factor"),
        (("xyz", "rate_matrix_body"), lambda m: m.T, "transpose"),
    ],
)
def test_a_change_of_all_entries_is_named_unaided(case, change, kind):
    found = rs.compare(change(right(*case)))
    assert [repair.kind for repair in found.repairs] == [kind]
    assert (found.found.quantity, found.is_equal, found.is_proved) == (case[1], False, True)


@pytest.mark.parametrize(
    ("text", "read"),
    [
        ("hello", "hello is a single expression; expected a matrix of 3x3, "),
        ("3", "3 is a single expression"),
        ("[c -s; s c]", "the formula is a 2x2 matrix"),
        ("[1, 2, 3]", "a vector of 3 entries of numbers only; expected a formula with names"),
    ],
)
def test_what_is_no_formula_is_said(text, read):
    with pytest.raises(ExpressionError, match=f"^{read}"):
        rs.compare(text)
    found = rs.compare(text, "ZYX", "rate_matrix_body").text()
    expected = "" if "vector" in read and "3x3" in read else "; expected a 3x3 matrix)"
    assert found.endswith(expected)


@pytest.mark.parametrize(
    ("change", "place", "after"),
    [
        (lambda m: m.T, (2, 3), 1),
        (lambda m: 2 * m[[1, 2, 3, 0], [1, 2, 3, 0]], (4, 3), 2),
        (lambda m: m[:, [1, 2, 3, 0]] / 2, (1, 2), sp.Rational(1, 2)),
    ],
    ids=["transposed", "scalar last, twice", "scalar last, half"],
)
def test_the_wrong_entry_is_that_of_the_formula_however_it_is_written(change, place, after):
    if after == 1:
        matrix = right("ZXZ", "rotation_matrix")
    elif after == 2:
        a, b, c = sp.symbols("w_1:4", real=True)
        rows = [[0, -a, -b, -c], [a, 0, c, -b], [b, -c, 0, a], [c, b, -a, 0]]
        matrix = sp.Matrix(rows) / 2
    else:
        matrix = right("unit_quaternion", "rate_matrix_body")
    written = sp.Matrix(change(matrix))
    i, j = place[0] - 1, place[1] - 1
    wanted = written[i, j]
    written[i, j] = turned_sign(wanted)
    found = rs.compare(written)
    (repair,) = found.repairs
    assert (repair.place, repair.kind, found.is_proved) == (place, "sign", True)
    assert (repair.before, repair.after) == (written[i, j], wanted)


def test_a_transpose_is_said_of_the_convention_that_a_formula_is():
    matrix = right("xyz", "rotation_matrix").T
    found = rs.compare(matrix, "ZYX", "rotation_matrix")
    assert "this is rotation_matrix of xyz, transposed (passive" in found.text()


def test_texts_call_the_versine_v_and_the_length_by_the_letter_of_its_components():
    rodrigues = (
        "[[x*x*v + c, x*y*v - z*s, x*z*v + y*s], [x*y*v + z*s, y*y*v + c, y*z*v - x*s], "
        "[x*z*v - y*s, y*z*v + x*s, z*z*v + c]]"
    )
    assert str(rs.compare(rodrigues).found) == "rotation_matrix of axis_angle"
    s = "col(s_1, s_2, s_3)"
    found = rs.compare(f"((1 - s**2)*one(3) + 2*C({s}) + 2*outer({s}, {s}))/4")
    assert str(found.found) == "inverse_rate_matrix_body of modified_rodrigues"
    assert found.is_equal


def test_a_p_before_an_index_is_no_rate():
    """mrp_1 is a coordinate, although p may end the name of a rate"""
    formula = right("modified_rodrigues", "angular_velocity_body")
    names = {s: sp.Symbol(f"mrp_{s.name[1:]}") for s in formula.free_symbols}
    assert {name.name for name in names.values()} >= {"mrp_1", "mrp_1_dot"}
    found = rs.compare(formula.xreplace(names), "modified_rodrigues", "angular_velocity_body")
    assert found.is_equal


Z = "[cos(psi), -{0}, 0; {0}, {1}, 0; 0, 0, 1]"


@pytest.mark.parametrize(
    ("sine", "cosine"),
    [
        ("sqrt(1 - cos(psi)^2)", "cos(psi)"),
        ("sin(abs(psi))", "cos(psi)"),
        ("sin(psi)", "sqrt(cos(psi)^2)"),
        ("sin(psi)", "abs(cos(psi))"),
        ("sin(asin(sin(psi)))", "sqrt(1 - sin(psi)^2)"),
    ],
)
def test_a_formula_that_is_right_for_some_angles_only_is_wrong_with_a_counterexample(sine, cosine):
    for asked in ((), ("z(psi)", "rotation_matrix")):
        found = rs.compare(Z.format(sine, cosine), *asked)
        assert not found.is_equal
        assert "for all angles: wrong at psi = " in found.text()


def test_a_reflection_is_no_rotation_with_wrong_signs():
    mirror = "[[cos(a), sin(a), 0], [sin(a), -cos(a), 0], [0, 0, 1]]"
    for asked in ((), ("z(a)", "rotation_matrix")):
        found = rs.compare(mirror, *asked)
        assert (found.is_equal, found.repairs, found.is_reflection) == (False, (), True)
        assert "a reflection, since det = −1" in found.text()


@pytest.mark.parametrize("font", ["mathrm", "text", "operatorname", "mathsf"])
def test_functions_in_upright_letters_are_functions_in_latex(font):
    rows = r"\begin{pmatrix}C\psi&-S\psi&0\\ S\psi&C\psi&0\\0&0&1\end{pmatrix}"
    text = rows.replace("C", rf"\{font}{{cos}}").replace("S", rf"\{font}{{sin}}")
    assert rs.compare(text, "z(psi)", "rotation_matrix").is_proved
    unknown = text.replace(rf"\{font}{{cos}}\psi", rf"\{font}{{foo}}(\psi)")
    with pytest.raises(ExpressionError, match="foo is not a function that is known"):
        rs.compare(unknown)
    named = rows.replace("C", r"\cos ").replace("S", r"\sin ").replace(r"\psi", r"\text{yaw}")
    assert rs.compare(named, "z(yaw)", "rotation_matrix").is_proved
