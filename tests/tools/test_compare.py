"""`compare` names what is wrong with a formula: each kind of error, seeded into known formulas."""

from __future__ import annotations

import re
from functools import cache
from itertools import product

import numpy as np
import pytest
import sympy as sp
from scipy.spatial.transform import Rotation

import rigidsym as rs
from rigidsym.errors import ExpressionError
from rigidsym.tools.compare.program import formula_matrix
from rigidsym.tools.compare.quantities import _laws, target


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


ENTRIES = [  # case, place, a part of the entry, what is written in its place, the kind of error
    ("ZXZ", "rotation_matrix", (1, 2), "sin(phi)", "cos(phi)", "sine and cosine"),
    ("ZXZ", "rotation_matrix", (3, 3), "cos(theta)", "cos(psi)", "index"),
    ("ZXZ", "rotation_matrix", (2, 2), "*cos(theta)", "", "product"),
    ("ZXZ", "rotation_matrix", (3, 1), "theta", "theta/2", "half angle"),
    ("unit_quaternion", "rotation_matrix", (2, 3), "-2*w*x", "2*w*x", "sign"),
    ("unit_quaternion", "rotation_matrix", (3, 2), "y*z", "x*z", "index"),
    ("xyz", "inverse_rate_matrix_body", (3, 3), "cos(phi)", "cos(phi)**2", "square"),
    ("zxz", "angular_velocity_body", (3, 1), "psi_dot", "2*psi_dot", "factor"),
    ("modified_rodrigues", "inverse_rate_matrix_body", (1, 1), "s1**2", "s1", "square"),
    ("unit_quaternion", "rate_matrix_body", (1, 1), "-2*", "2*", "sign"),
]


@pytest.mark.parametrize("row", ENTRIES, ids=lambda row: "-".join((row[0], row[1], row[5])))
def test_one_wrong_entry_is_found_and_its_repair_is_proved(row):
    rotation, quantity, place, part, written, kind = row
    formula = right(rotation, quantity).as_mutable()
    i, j = place[0] - 1, place[1] - 1
    text = str(formula[i, j])
    assert part in text, text
    names = {symbol.name: symbol for symbol in formula.free_symbols}
    formula[i, j] = sp.sympify(text.replace(part, written, 1), names)
    found = rs.compare(str(formula.tolist()), rotation, quantity)
    (repair,) = found.repairs
    assert (repair.place, repair.kind, found.is_proved) == (place, kind, True)
    assert not found.is_equal


ZXZ, RATES = ("ZXZ", "rotation_matrix"), ("xyz", "inverse_rate_matrix_body")
OMEGA = ("zxz", "angular_velocity_body")
WHOLE = {  # kind of error: case, and the formula that is written
    "transpose": (ZXZ, lambda: right(*ZXZ).T),
    "sign": (OMEGA, lambda: -right(*OMEGA)),
    "factor": (RATES, lambda: right(*RATES) / 2),
    "exchange": (ZXZ, lambda: sp.Matrix(3, 3, [right(*ZXZ)[k] for k in (1, 0, *range(2, 9))])),
    "convention": (OMEGA, lambda: right("zxz", "angular_velocity_space")),
}


@pytest.mark.parametrize("kind", WHOLE)
def test_a_change_of_the_whole_formula_is_named(kind):
    case, written = WHOLE[kind]
    found = rs.compare(written(), *case)
    (repair,) = found.repairs
    assert (repair.kind, found.is_proved) == (kind, True)


@pytest.mark.parametrize("kind", ["rate_matrix", "inverse_rate_matrix", "angular_velocity"])
@pytest.mark.parametrize("frame", ["body", "space"])
def test_names_of_angles_are_those_of_the_formula_if_nobody_chose_them(kind, frame):
    spelled, quantity = "z(psi) y(theta) x(phi)", f"{kind}_{frame}"
    formula = right(spelled, quantity)
    found = rs.compare(formula, "ZYX", quantity).text()
    assert re.fullmatch(
        f"equal to {quantity} of ZYX with .* as the angles about .* .proved.", found
    )
    assert rs.compare(right("xyz", quantity), "ZYX", quantity).is_equal  # rates backwards
    assert f"of {spelled} (proved)" in rs.compare(formula, spelled, quantity).text()
    for fixed in ("z(phi) y(theta) x(psi)", rs.derive("ZYX", quantity)):
        assert not rs.compare(formula, fixed, quantity).is_equal
    names = "with psi, theta, phi as the angles about z, y, x (proved)"
    formula = right(spelled, "rotation_matrix")
    assert rs.compare(formula, "ZYX", "rotation_matrix").text().endswith(names)


def test_our_names_fix_proper_euler_angles_and_the_order_of_rates():
    aerospace, quantity = "z(psi) y(theta) x(phi)", "rotation_matrix"
    exchanged = right(aerospace.replace("y", "x").replace("x(phi)", "z(phi)"), quantity)
    assert not rs.compare(exchanged, "ZXZ", quantity).is_equal
    for axes, name in product(("ZXZ", "xyz"), ("rate_matrix_body", "inverse_rate_matrix_space")):
        written = right(axes, name)
        backwards = written[::-1, :] if "inverse" in name else written[:, ::-1]
        assert not rs.compare(backwards, axes, name).is_equal
    said = rs.compare(right(aerospace, quantity), rs.derive("ZYX", quantity), quantity).text()
    assert said.startswith(
        f"not {quantity} of ZYX with phi, theta, psi as the angles about z, y, x:"
    )


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


def test_a_change_that_divides_by_zero_is_left_out():
    formula = right("ZXZ", "rotation_matrix").as_mutable()
    formula[2, 2] /= sp.Symbol("phi", real=True) - sp.Symbol("psi", real=True)
    (repair,) = rs.compare(formula, "ZXZ", "rotation_matrix").repairs
    assert (repair.place, repair.after) == ((3, 3), sp.cos(sp.Symbol("theta", real=True)))


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
    ("text", "said"),
    [
        ("[[cos(a), -sin(a)], [sin(a), cos(a)]", "'[' at character 1 is not closed"),
        (r"\begin{pmatrix}\cos(\phi\\1\end{pmatrix}", "'(' at character 20 is not closed"),
        ("[c, -s)", "')' at character 7 closes '[' at character 1"),
        ("[[1, 0]], [0, c]]", "']' at character 17 closes nothing"),
    ],
)
def test_a_bracket_without_its_other_half_is_named_with_its_place(text, said):
    with pytest.raises(ExpressionError, match=re.escape(said)):
        rs.compare(text)


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
        (rs.compare(matrix.T), "transposed (passive, for row vectors, or by columns)"),
        (rs.compare(unknown), f"not a known quantity, {end}"),
        (rs.compare(unknown, "ZYX", "rotation_matrix"), f"not rotation_matrix of ZYX, {end}"),
        (rs.compare(matrix.T, "xyx", "rotation_matrix"), "this is rotation_matrix of ZYX, tr"),
    ):
        assert sentence in found.text()


UNAIDED = {
    "{2*(q[3]*qd[0]-q[0]*qd[3]-q[1]*qd[2]+q[2]*qd[1]), 2*(q[3]*qd[1]-q[1]*qd[3]-q[2]*qd[0]+q[0]*"
    "qd[2]), 2*(q[3]*qd[2]-q[2]*qd[3]-q[0]*qd[1]+q[1]*qd[0])}": (
        "angular_velocity_body of unit_quaternion"
    ),
    "[[x*x*v + c, x*y*v - z*s, x*z*v + y*s], [x*y*v + z*s, y*y*v + c, y*z*v - x*s], "
    "[x*z*v - y*s, y*z*v + x*s, z*z*v + c]]": "rotation_matrix of axis_angle",
    # ros/geometry2, tf2/LinearMath/Matrix3x3.h: d is the square of the length
    "[[1 - 2*(y*y + z*z)/d, 2*(x*y - w*z)/d, 2*(x*z + w*y)/d], [2*(x*y + w*z)/d, "
    "1 - 2*(x*x + z*z)/d, 2*(y*z - w*x)/d], [2*(x*z - w*y)/d, 2*(y*z + w*x)/d, "
    "1 - 2*(x*x + y*y)/d]]": "rotation_matrix of quaternion",
    # d-ronin/dRonin, coordinate_conversions.c: latitude counts from the equator
    "[[-sin(e0)*cos(e1), -sin(e0)*sin(e1), cos(e0)], [-sin(e1), cos(e1), 0], [-cos(e0)*cos(e1), "
    "-sin(e1)*cos(e0), -sin(e0)]]": "rotation_matrix of y(first) z(second)",
    # bulletphysics/bullet3, btQuaternion.h: a vector is a quaternion without a scalar
    "[q.w*v.x + q.y*v.z - q.z*v.y, q.w*v.y - q.x*v.z + q.z*v.x, q.w*v.z + q.x*v.y - q.y*v.x, "
    "-q.x*v.x - q.y*v.y - q.z*v.z]": "quaternion_product",
    # gazebosim/gz-math, Inertial.hh
    "[J0 - m*d0*d1, J1 - m*d0*d2, J2 - m*d1*d2]": "parallel_axis_theorem",
    "[[0, -p, -q, -r], [p, 0, r, -q], [q, -r, 0, p], [r, q, -p, 0]]": "quaternion_rate_operator",
}


@pytest.mark.parametrize(("text", "name"), UNAIDED.items(), ids=UNAIDED.values())
def test_a_formula_is_known_unaided_by_the_names_that_texts_use(text, name):
    found = rs.compare(text)
    assert (str(found.found), found.is_equal) == (name, True)


@pytest.mark.parametrize("rotation", ["unit_quaternion", "gibbs_vector"])
def test_p_q_r_are_body_rates_beside_components_called_q(rotation):
    rates = right(rotation, "rates_from_angular_velocity_body")
    motion = rs.derive(rotation, "rates_from_angular_velocity_body")
    old = [n for argument in motion.arguments for n in argument.names]
    new = [f"q{k}" for k in range(1, len(old) - 2)] + [*"pqr"]
    names = {sp.Symbol(a, real=True): sp.Symbol(b) for a, b in zip(old, new, strict=True)}
    found = rs.compare(str(rates.xreplace(names).tolist()))
    assert str(found.found) == f"rates_from_angular_velocity_body of {rotation}"


def test_a_change_of_all_entries_is_named_unaided():
    found = rs.compare(right("xyz", "rate_matrix_body").T)
    assert [repair.kind for repair in found.repairs] == ["transpose"]
    assert (str(found.found), found.is_proved) == ("rate_matrix_body of xyz", True)


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


def test_the_wrong_entry_is_that_of_the_formula_however_it_is_written():
    written = sp.Matrix(right("unit_quaternion", "rate_matrix_body")[:, [1, 2, 3, 0]] / 2)
    wanted, written[0, 1] = written[0, 1], -written[0, 1]
    (repair,) = rs.compare(written).repairs
    assert (repair.place, repair.kind, repair.after) == ((1, 2), "sign", wanted)


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
        assert abs(float(found.text().partition("for all angles: wrong at psi = ")[2])) < np.pi


def test_a_reflection_is_no_rotation_with_wrong_signs():
    mirror = "[[cos(a), sin(a), 0], [sin(a), -cos(a), 0], [0, 0, 1]]"
    for asked in ((), ("z(a)", "rotation_matrix")):
        found = rs.compare(mirror, *asked)
        assert (found.is_equal, found.repairs, found.is_reflection) == (False, (), True)
        assert "a reflection, since det = −1" in found.text()


def test_functions_in_upright_letters_are_functions_in_latex():
    rows = r"\begin{pmatrix}C\psi&-S\psi&0\\ S\psi&C\psi&0\\0&0&1\end{pmatrix}"
    for font in ("mathrm", "text", "operatorname", "mathsf"):
        text = rows.replace("C", rf"\{font}{{cos}}").replace("S", rf"\{font}{{sin}}")
        assert rs.compare(text, "z(psi)", "rotation_matrix").is_proved
    own = rs.compare("[c s 0; s c 0; 0 0 1]", "z(a)", "rotation_matrix").text()
    assert "entry (1, 2): sin(a) should be -sin(a)" in own
    with pytest.raises(ExpressionError, match="foo is not a function that is known"):
        rs.compare(text.replace(rf"\{font}{{cos}}\psi", rf"\{font}{{foo}}(\psi)"))
    named = rows.replace("C", r"\cos ").replace("S", r"\sin ").replace(r"\psi", r"\text{yaw}")
    assert rs.compare(named, "z(yaw)", "rotation_matrix").is_proved


# Laws in vectors, and quaternions of Euler angles: right, wrong in one entry, and look-alikes

PRODUCT = (
    "[a0*b0 - a1*b1 - a2*b2 - a3*b3, a0*b1 + a1*b0 + a2*b3 - a3*b2, "
    "a0*b2 - a1*b3 + a2*b0 + a3*b1, a0*b3 + a1*b2 - a2*b1 + a3*b0]"
)
ROTATED = (
    "[v.x + 2*(q.w*(q.y*v.z - q.z*v.y) + q.y*(q.x*v.y - q.y*v.x) - q.z*(q.z*v.x - q.x*v.z)), "
    "v.y + 2*(q.w*(q.z*v.x - q.x*v.z) + q.z*(q.y*v.z - q.z*v.y) - q.x*(q.x*v.y - q.y*v.x)), "
    "v.z + 2*(q.w*(q.x*v.y - q.y*v.x) + q.x*(q.z*v.x - q.x*v.z) - q.y*(q.y*v.z - q.z*v.y))]"
)
EULER = "[(tx - (Izz - Iyy)*q*r)/Ixx, (ty - (Ixx - Izz)*p*r)/Iyy, (tz - (Iyy - Ixx)*p*q)/Izz]"
TORQUE = "[I1*a1 + (I3 - I2)*w2*w3, I2*a2 + (I1 - I3)*w3*w1, I3*a3 + (I2 - I1)*w1*w2]"
TENSOR = (
    "[[Ixx + m*(dy^2 + dz^2), Ixy - m*dx*dy, Ixz - m*dx*dz], [Ixy - m*dx*dy, "
    "Iyy + m*(dx^2 + dz^2), Iyz - m*dy*dz], [Ixz - m*dx*dz, Iyz - m*dy*dz, Izz + m*(dx^2 + dy^2)]]"
)
HALF = (
    "[cos(r/2)*cos(p/2)*cos(y/2) + sin(r/2)*sin(p/2)*sin(y/2), "
    "sin(r/2)*cos(p/2)*cos(y/2) - cos(r/2)*sin(p/2)*sin(y/2), "
    "cos(r/2)*sin(p/2)*cos(y/2) + sin(r/2)*cos(p/2)*sin(y/2), "
    "cos(r/2)*cos(p/2)*sin(y/2) - sin(r/2)*sin(p/2)*cos(y/2)]"
)
RIGHT = {  # formula: its law, a change that makes one entry wrong, and the kind of the repair
    PRODUCT: ("quaternion_product", ("- a1*b3", "+ a1*b3"), "sign"),
    ROTATED: ("rotated_vector", ("(q.y*v.z - q.z*v.y) +", "(q.y*v.z + q.z*v.y) +"), "sign"),
    EULER: ("euler_equations_acceleration", ("(Ixx - Izz)", "(Izz - Ixx)"), "sign"),
    TORQUE: ("euler_equations_torque", ("w3*w1", "w3*w2"), "index"),
    TENSOR: ("parallel_axis_theorem", ("m*(dx^2 + dy^2)", "m*(dx^2 - dy^2)"), "sign"),
    HALF: ("quaternion of ZYX", ("- cos(r/2)*sin(p/2)", "- sin(r/2)*sin(p/2)"), "sine and cosine"),
}


@pytest.mark.parametrize("text", RIGHT, ids=[name for name, _, _ in RIGHT.values()])
def test_a_law_is_proved_and_one_wrong_entry_is_named(text):
    name, change, kind = RIGHT[text]
    right, wrong = rs.compare(text), rs.compare(text.replace(*change, 1))
    assert (str(right.found), right.is_equal, right.is_proved) == (name, True, True)
    assert (str(wrong.found), wrong.is_equal, wrong.is_proved) == (name, False, True)
    assert [repair.kind for repair in wrong.repairs] == [kind]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (PRODUCT.replace("a0*b0 - ", "a0*b0 + ").replace("+ a", "- a"), ""),
        ("[tx/Ixx, ty/Iyy, tz/Izz]", ""),  # a small body may be spun without gyroscopic torque
        ("[a2*b3 - a3*b2, a3*b1 - a1*b3, a1*b2 - a2*b1]", ""),
        ("[[m*y*y, -m*x*y, -m*x*z], [-m*x*y, m*z*z, -m*y*z], [-m*x*z, -m*y*z, m*x*x]]", ""),
        (HALF.replace("/2", ""), ""),
        (TENSOR.replace("+ m", "! m").replace("- m", "+ m").replace("!", "-"), "to the centre"),
        (PRODUCT.replace("a1", "(-a1)").replace("a2", "(-a2)").replace("a3", "(-a3)"), "the first"),
        (  # Hipparchus-Math/hipparchus, geometry/euclidean/threed/Rotation.java, composeInverse
            "[-r.q0*q0 - r.q1*q1 - r.q2*q2 - r.q3*q3, -r.q1*q0 + r.q0*q1 + r.q2*q3 - r.q3*q2, "
            "-r.q2*q0 + r.q0*q2 + r.q3*q1 - r.q1*q3, -r.q3*q0 + r.q0*q3 + r.q1*q2 - r.q2*q1]",
            "negative",
        ),
        (HALF.replace("sin(r/2)", "-sin(r/2)"), "with the opposite sense of r"),
    ],
)
def test_look_alikes_and_other_ways_of_writing_are_not_called_wrong(text, words):
    found = rs.compare(text)
    assert found.repairs == ()
    assert words in found.arrangement if words else not found.is_equal or found.is_proved


@pytest.mark.parametrize("axes", ["ZYX", "ZXZ", "xyz"])
def test_quaternions_of_angles_are_those_of_scipy(axes):
    goal, angles = target(axes, "quaternion"), [0.3, -0.8, 1.1]
    values = dict(zip(goal.inputs["q"], angles, strict=True))
    ours = np.array(goal.matrix.xreplace(values).evalf(), float).ravel()
    x, y, z, w = Rotation.from_euler(axes, angles).as_quat()
    assert ours == pytest.approx([w, x, y, z])
    last = goal.matrix.extract([1, 2, 3, 0], [0])
    names = {s: sp.Symbol(name) for name, s in goal.names.items()}
    assert rs.compare(-last.xreplace(names)).arrangement == "scalar last, negative"


def test_laws_hold_in_numbers():
    """The product, the rotated vector and Steiner's theorem by SciPy and by the sum over a body."""
    rng = np.random.default_rng(3)
    a, b, v = Rotation.random(random_state=1), Rotation.random(random_state=2), rng.normal(size=3)
    by_name = {law[0].quantity: law[0] for law in _laws()[::-1]}

    def value(name, *vectors):
        law = by_name[name]
        numbers = dict(zip(sum(law.inputs.values(), ()), np.concatenate(vectors), strict=True))
        return np.array(law.matrix.xreplace(numbers), float).squeeze()

    first = lambda turn: np.roll(turn.as_quat(), 1)  # noqa: E731
    products = value("quaternion_product", first(a), first(b))
    assert np.abs(products @ first(a * b)) == pytest.approx(1)
    assert value("rotated_vector", first(a), v) == pytest.approx(a.apply(v))
    term = value("parallel_axis_theorem", [2.5], v, np.zeros(6))
    assert term == pytest.approx(2.5 * (v @ v * np.eye(3) - np.outer(v, v)))
    w, moments, torque = rng.normal(size=(3, 3))
    rate = value("euler_equations_acceleration", w, moments, torque)
    assert moments * rate + np.cross(w, moments * w) == pytest.approx(torque)
    assert value("euler_equations_torque", w, moments, rate) == pytest.approx(torque)
