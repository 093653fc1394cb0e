"""Certificates: a program without rigidsym, and Coq, prove what is printed."""

from __future__ import annotations

import ast
import copy
import subprocess
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import sympy as sp

import rigidsym as rs
from helpers.certificates import plain, printed, record_of, run_coq, spoil
from helpers.command import call
from rigidsym.errors import CheckError
from rigidsym.models.body import given_inertia
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate import checker
from rigidsym.tools.certificate.certificate import certificate_of

NAME = "euler_zxz_intrinsic"
CHECKER = Path(checker.__file__)
BASIC = ("rotation_matrix", "angular_velocity_body", "rate_matrix_body")
FEWER = (*BASIC, "angular_velocity_space", "inverse_rate_matrix_space")
OTHERS = (
    *("quaternion", "gibbs_vector", "goldstein", "axis_angle", "unit_quaternion"),
    *("modified_rodrigues", "z(phi) x(theta) [0,b,c](psi)", "z(phi) [1,1,0](theta) x(pi/4)"),
    *("z(2*phi - psi) x(theta) z(psi/3)", "x(a_1) y(a_2) z(a_3) x(a_4)"),
)
CHAIN = "z(a1) x(a2) y(a3) z(a4) x(a5) y(a6) z(a7) x(a8) y(a9) z(a10)"


def test_all_conventions_are_proved_by_the_checker():
    for text in rs.EULER_SEQUENCES:
        of_rotation = record_of(text, None if text == "ZXZ" else FEWER)
        names = [quantity["name"] for quantity in of_rotation["quantities"]]
        assert checker.verify(of_rotation) == (["R is a rotation", *names], {})


@pytest.mark.parametrize("text", [*OTHERS, CHAIN])
def test_other_rotations_are_proved_by_the_checker(text):
    proved, reasons = checker.verify(record_of(text))
    assert reasons == {}
    assert len(proved) == 1 + len(record_of(text)["quantities"])


def test_lengths_of_vectors_have_derivatives():
    # the second derivative of the length is in the angular acceleration only
    asked = ("rotation_matrix", "angular_velocity_body", "angular_acceleration_body")
    assert checker.verify(record_of("rotation_vector", asked))[1] == {}


def test_conditions_that_are_no_spheres_have_no_certificate():
    certificate = certificate_of(record_of("direction_cosines", BASIC))
    assert certificate.claims == []
    assert f"Without a theorem here: {', '.join(BASIC)}. " in certificate.text
    _, reasons = checker.verify(record_of("direction_cosines", BASIC))
    assert (
        "'r11*r21 + r12*r22 + r13*r23', which is no sum of squares" in reasons["rate_matrix_body"]
    )


@pytest.mark.parametrize(
    ("quantity", "place", "before", "after"),
    [
        ("rotation_matrix", (0, 0), "-sin", "sin"),
        ("rotation_matrix", (2, 2), "cos", "sin"),
        ("angular_velocity_body", (2,), "psi_dot", "phi_dot"),
        ("inverse_rate_matrix_body", (0, 0), "/sin", "/cos"),
        ("angular_acceleration_space", (2,), "phi_ddot", "2*phi_ddot"),
    ],
)
def test_a_changed_expression_is_refused(quantity, place, before, after):
    changed = copy.deepcopy(record_of("ZXZ"))
    *rows, last = place
    row = printed(changed, quantity)["expression"]
    for index in rows:
        row = row[index]
    assert before in row[last]
    row[last] = row[last].replace(before, after, 1)
    with pytest.raises(checker.Refused, match="is false at a real point"):
        checker.verify(changed)
    with pytest.raises(CheckError, match=rf"{NAME}: no certificate, since {quantity}: entry"):
        certificate_of(changed)


def test_a_right_expression_under_the_wrong_name_is_refused():
    changed = copy.deepcopy(record_of("ZXZ"))
    space, body = (printed(changed, f"angular_velocity_{frame}") for frame in ("space", "body"))
    space["expression"], body["expression"] = body["expression"], space["expression"]
    with pytest.raises(checker.Refused, match="angular_velocity_space: entry 1 is false"):
        checker.verify(changed)


# W times q is 0: without a list of names that may be in it, each of these would be proved
@pytest.mark.parametrize("name", ["w_ddot", "x_dot", "omega_space_2", "anything"])
def test_rates_that_hold_more_than_the_angular_velocity_are_refused(name):
    changed = copy.deepcopy(record_of("quaternion", ("rates_from_angular_velocity_body",)))
    rates = printed(changed, "rates_from_angular_velocity_body")["expression"]
    for k, coordinate in enumerate("wxyz"):
        rates[k] = f"{rates[k]} + {coordinate}*{name}"
    with pytest.raises(ValueError, match=f"{name} must not be in"):
        checker.verify(changed)


def test_a_rate_matrix_that_holds_rates_is_refused():
    changed = copy.deepcopy(record_of("ZXZ"))
    row = ["cos(theta) + psi_dot/phi_dot", "0", "0"]
    printed(changed, "rate_matrix_body")["expression"][2] = row
    with pytest.raises(ValueError, match="_dot must not be in"):
        checker.verify(changed)


def test_rates_that_leave_the_conditions_are_refused():
    # they turn the body rightly, since R does not depend on the length of q, but q would lose it
    changed = copy.deepcopy(record_of("quaternion", ("rates_from_angular_velocity_body",)))
    changed["rotation"]["conditions"] = ["w**2 + x**2 + y**2 + z**2 - 1"]
    assert checker.verify(changed)[1] == {}
    rates = printed(changed, "rates_from_angular_velocity_body")["expression"]
    for k, coordinate in enumerate("wxyz"):
        rates[k] = f"{rates[k]} + {coordinate}*omega_body_1"
    with pytest.raises(checker.Refused, match="is false at a real point"):
        checker.verify(changed)


@pytest.mark.parametrize(
    "text",
    [
        *("__import__('os')", "phi.real", "phi[0]", "exp(phi)", "cos(phi", "cos phi", "2**phi"),
        *("2**(1/3)", "x**999", "((phi**90)**90)**90", "", None, {}, "True", "1.0", "cos(*phi)"),
        *("-" * 50_000 + "phi", "(" * 5_000 + "phi" + ")" * 5_000, "cos(phi, phi)", "phi\n"),
    ],
)
def test_an_expression_in_another_language_is_refused(text):
    changed = copy.deepcopy(record_of("ZXZ", BASIC))
    printed(changed, "rotation_matrix")["expression"][0][0] = text
    with pytest.raises(checker.BROKEN):
        checker.verify(changed)


# Numbers and angles: identities that need the arithmetic of the checker


@pytest.mark.parametrize(
    ("one", "two", "is_true"),
    [
        ("sqrt(2)*sqrt(6)", "2*sqrt(3)", True),
        ("1/(1 + sqrt(2) + sqrt(3))", "1/2 + sqrt(2)/4 - sqrt(6)/4", True),
        ("1/sqrt(8)", "sqrt(2)/4", True),
        ("sqrt(2) + sqrt(3)", "sqrt(10)", False),
        ("cos(2*phi)", "1 - 2*sin(phi)**2", True),
        ("sin(phi - theta/2)", "sin(phi)*cos(theta/2) - cos(phi)*sin(theta/2)", True),
        ("tan(phi)*cot(phi)", "1", True),
        ("sin(1)**2 + cos(theta + 1)**2", "1 - cos(1)**2 + cos(1 + theta)**2", True),
        ("cos(2*phi)", "1 - sin(phi)**2", False),
        ("cos(theta + 1)", "cos(theta)", False),
    ],
)
def test_roots_and_sums_of_angles_are_exact(one, two, is_true):
    changed = copy.deepcopy(record_of("ZXZ", BASIC))
    row = printed(changed, "rotation_matrix")["expression"][0]
    row[0] = f"{row[0]} + {one} - ({two})"
    if is_true:
        assert checker.verify(changed)[1] == {}
    else:
        with pytest.raises(checker.Refused, match="rotation_matrix: entry 1 is false"):
            checker.verify(changed)


OF_BODY = ("rotation_matrix", "inertia_tensor", "inertia_tensor_space", "moment_of_inertia")
OF_BODY += ("radii_of_gyration", "kinetic_energy", "angular_momentum")
OF_MOTION = ("potential_energy", "lagrangian", "energy", "generalised_momenta", "mass_matrix")
OF_MOTION += ("bias_vector", "accelerations", "hamiltonian")
PRINCIPAL = ("principal_moments", "principal_axes")
A, B, C, M = sp.symbols("A B C M", positive=True)
NEEDS: dict[str, Callable[[], rs.Motion]] = {
    "box": lambda: rs.derive("ZXZ", OF_BODY, body=rs.solid("box")),
    "euler": lambda: rs.derive(
        "ZXZ",
        ["rotation_matrix", "angular_acceleration_from_torque"],
        body=rs.principal_moments(A, B, C),
        potential=0,
    ),
    "top": lambda: rs.derive(
        "ZXZ",
        [*BASIC[:2], *OF_MOTION, *PRINCIPAL, "coriolis_matrix", "inertia_ellipsoid"],
        body=rs.principal_moments(A, A, C),
        potential="m*g*l*cos(theta)",
        forces={"psi": "-k*psi_dot"},
    ),
    "free top": lambda: rs.derive(
        "ZXZ", ["energy"], body=rs.principal_moments(A, A, C), potential="m*g*l*cos(theta)"
    ),
    "torque": lambda: rs.derive(
        "ZYX",
        ["angular_velocity_body", "accelerations"],
        body=rs.principal_moments(A, A, C),
        torque=["l*F", "0", "k*F"],
    ),
    # moments 6 and 6 ± 2√2 about axes that lie between those of the description
    "oblique axes": lambda: rs.derive(
        "ZXZ",
        PRINCIPAL,
        body=given_inertia(sp.Matrix([[6, -2, 0], [-2, 6, -2], [0, -2, 6]]), mass=M),
    ),
}
UNCOVERED = {
    "box": ["radii_of_gyration"],
    "top": ["coriolis_matrix", "inertia_ellipsoid"],
}


@cache
def of_motion(name: str) -> dict[str, Any]:
    return plain(record(NEEDS[name](), {}))


@pytest.mark.parametrize("name", NEEDS)
def test_bodies_and_their_motions_are_proved(name):
    proved, reasons = checker.verify(of_motion(name))
    assert {*reasons} == {*UNCOVERED.get(name, ())}
    assert {*proved} == {"R is a rotation", *checker.printed_in(of_motion(name))} - {*reasons}
    if name == "free top":
        assert {"constant energy", "constant momentum_phi", "constant momentum_psi"} < {*proved}


@pytest.mark.parametrize(
    ("name", "quantity", "before", "after"),
    [
        ("box", "kinetic_energy", "/24", "/12"),
        ("box", "angular_momentum", "X_dot", "Y_dot"),
        ("box", "moment_of_inertia", "p_x", "p_y"),
        ("box", "inertia_tensor_space", "cos", "sin"),
        ("euler", "angular_acceleration_from_torque", "B - C", "B + C"),
        ("top", "lagrangian", "- g*l*m*cos", "+ g*l*m*cos"),
        ("top", "potential_energy", "cos", "sin"),
        ("top", "generalised_momenta", "C*(", "A*("),
        ("top", "mass_matrix", "C", "A"),
        ("top", "bias_vector", "g*l*m", "2*g*l*m"),
        ("top", "accelerations", "k*", "2*k*"),
        ("top", "hamiltonian", "p_theta**2", "p_psi**2"),
        ("top", "hamiltonian", "2*p_phi*p_psi", "p_phi*p_psi"),
        ("top", "hamiltonian", "g*l*m", "-g*l*m"),
        ("top", "constant momentum_phi", "sin(theta)**2", "sin(theta)"),
        ("free top", "constant energy", "cos(theta)", "sin(theta)"),
        ("free top", "constant energy", "g*l*m", "2*g*l*m"),
        ("free top", "constant energy", "A", "C"),
        ("oblique axes", "principal_moments", "6", "12"),
        ("oblique axes", "principal_axes", "1/2", "-1/2"),
    ],
)
def test_a_wrong_expression_of_a_motion_is_refused(name, quantity, before, after):
    changed = copy.deepcopy(of_motion(name))
    spoil(changed, quantity, before, after)
    with pytest.raises(ValueError, match=r"is false at a real point|must not be in"):
        checker.verify(changed)


def test_a_hamiltonian_in_the_rates_is_refused():
    # the energy itself would satisfy H(q, p(q, q̇)) = E(q, q̇)
    changed = copy.deepcopy(of_motion("top"))
    printed(changed, "hamiltonian")["expression"] = printed(changed, "energy")["expression"]
    with pytest.raises(ValueError, match="_dot must not be in"):
        checker.verify(changed)


def test_a_hamiltonian_of_a_thin_rod_is_refused():
    # its p_psi is 0 for all rates, so that any term with p_psi would do
    changed = copy.deepcopy(of_motion("top"))
    changed["body"]["inertia"][2][2], changed["first_integrals"] = "0", []
    hamiltonian = "(p_theta**2 + p_phi**2/sin(theta)**2)/(2*A) + g*l*m*cos(theta) + p_psi**2"
    changed["quantities"] = [{"name": "hamiltonian", "unit": "J", "expression": hamiltonian}]
    with pytest.raises(checker.Refused, match="a divisor is zero"):
        checker.verify(changed)


@pytest.mark.parametrize(
    ("name", "place", "value"),
    [
        ("top", ("motion", "potential"), "0"),
        ("top", ("motion", "forces"), ["0", "0", "0"]),
        ("top", ("body", "inertia", 0), ["C", "0", "0"]),
        ("top", ("body", "inertia", 0), ["1/(A - A)", "0", "0"]),
        ("top", ("body", "inertia", 0), ["A + 0*phi", "0", "0"]),
        ("torque", ("motion", "torque"), ["l*F", "k*F", "0"]),
    ],
)
def test_another_cause_of_the_motion_is_refused(name, place, value):
    changed = copy.deepcopy(of_motion(name))
    *path, last = place
    part = changed
    for key in path:
        part = part[key]
    part[last] = value
    with pytest.raises(checker.BROKEN):
        checker.verify(changed)


def test_a_tensor_that_is_not_symmetric_is_refused():
    # it is printed as it is described, so that nothing else is false
    changed = copy.deepcopy(of_motion("box"))
    changed["quantities"] = [printed(changed, "inertia_tensor")]
    changed["body"]["inertia"] = changed["quantities"][0]["expression"]
    checker.verify(changed)
    changed["body"]["inertia"][0][1] = changed["body"]["inertia"][0][0]
    with pytest.raises(checker.Refused, match="the inertia tensor is not symmetric"):
        checker.verify(changed)


def test_accelerations_without_the_lagrangian_have_no_theorem():
    body = rs.principal_moments(A, A, C)
    motion = rs.derive("ZXZ", [*BASIC[:2], "accelerations"], body=body, potential="cos(theta)")
    certificate = certificate_of(plain(record(motion, {})))
    assert "accelerations" in certificate.uncovered
    assert certificate.claims == [*BASIC[:2]]


def test_names_that_proofs_use_get_an_underscore():
    # Coq refused to call a derivative d beside the coordinate d
    text = certificate_of(record_of("z(d) x(e) z(phi)", BASIC)).text
    assert "Variables d_ e_ phi : R -> R." in text


def times(factor: str, rows: list[list[str]], column: int) -> None:
    for row in rows:
        row[column] = f"{factor}*({row[column]})"


def stretched(axes: list[list[str]], _: list[str]) -> None:
    times("2", axes, 0)
    times("1/2", axes, 1)


def unturned(axes: list[list[str]], moments: list[str]) -> None:
    axes[:] = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
    moments[:] = ["6", "6", "6"]


WRONG_AXES: dict[str, Callable[[Any, Any], None]] = {
    "they are left-handed": lambda axes, _: times("-1", axes, 0),
    "right-handed eigenvectors with a volume of 1, not unit vectors": stretched,
    "orthonormal, but no eigenvectors": unturned,
    "moments are exchanged": lambda _, moments: moments.reverse(),
}


@pytest.mark.parametrize("fault", WRONG_AXES)
def test_wrong_principal_axes_are_refused(fault):
    changed = copy.deepcopy(of_motion("oblique axes"))
    WRONG_AXES[fault](*(printed(changed, name)["expression"] for name in reversed(PRINCIPAL)))
    with pytest.raises(checker.Refused):
        checker.verify(changed)


@pytest.mark.parametrize("expression", ["0", "1", "A", "momentum", "phi", "energy"])
def test_a_constant_that_is_no_energy_is_not_called_the_energy(expression):
    changed = copy.deepcopy(of_motion("top"))
    changed["first_integrals"].append({"name": "energy", "expression": expression})
    with pytest.raises(checker.BROKEN):
        checker.verify(changed)


def test_the_checker_needs_only_the_standard_library_and_no_binary_fractions():
    tree = ast.parse(CHECKER.read_text(encoding="utf-8"))
    assert not any(
        isinstance(n, ast.Constant) and isinstance(n.value, float) for n in ast.walk(tree)
    )
    modules = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    modules |= {
        a.name for node in ast.walk(tree) if isinstance(node, ast.Import) for a in node.names
    }
    assert {module.split(".")[0] for module in modules} <= sys.stdlib_module_names


def test_the_files_are_written_and_checked(tmp_path):
    call("derive", "ZXZ", "--certificates", cwd=tmp_path)
    folder = tmp_path / "out" / NAME
    assert {f"{NAME}.v", "Rotation.v"} <= {file.name for file in folder.iterdir()}
    assert f"{NAME}.v: up to date\n  proved: R is a" in call("check", "out", cwd=tmp_path).stdout
    alone = [sys.executable, "-I", "-S", str(CHECKER), "out"]
    done = subprocess.run(alone, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "R is {'turns': ['z(phi)', 'x(theta)', 'z(psi)']" in done.stdout
    assert "  proved: R is a rotation, rotation_matrix" in done.stdout
    path = folder / f"{NAME}.json"
    text = path.read_text()
    for before, after, message in (
        ("-sin(phi)*sin(psi)", "sin(phi)*sin(psi)", "rotation_matrix: entry 1 is false"),
        ('"title"', '"title": "", "title"', "a name is there twice"),
    ):
        path.write_text(text.replace(before, after, 1))
        done = subprocess.run(alone, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 1
        assert f"REFUSED: {message}" in done.stdout
    nothing = [*alone[:-1], "none"]
    assert subprocess.run(nothing, cwd=tmp_path, check=False).returncode == 1


@pytest.mark.usefixtures("coq")
@pytest.mark.parametrize(
    ("text", "quantities"),
    [("ZXZ", None), ("unit_quaternion", None), (OTHERS[8], BASIC), ("gibbs_vector", None)],
)
def test_coq_accepts_kinematics_and_refuses_a_wrong_one(tmp_path, text, quantities):
    certificate = certificate_of(record_of(text, quantities))
    assert certificate.uncovered == []
    assert run_coq(tmp_path, certificate.text) == 0
    if text == "ZXZ":
        wrong = certificate.text.replace(
            "((phi_dot t) * (cos (theta t)))", "((phi_dot t) * (sin (theta t)))"
        )
        assert wrong != certificate.text
        assert run_coq(tmp_path, wrong) != 0
    if text == "unit_quaternion":
        assert _axioms(tmp_path) <= {
            "ClassicalDedekindReals.sig_not_dec",
            "ClassicalDedekindReals.sig_forall_dec",
            "FunctionalExtensionality.functional_extensionality_dep",
        }


def _axioms(folder: Path) -> set[str]:
    """What the theorem about Ω' rests on; the real numbers only."""
    question = "Require Import claims. Print Assumptions angular_velocity_body."
    (folder / "question.v").write_text(question, encoding="utf-8")
    answer = subprocess.run(
        ["coqc", "question.v"], cwd=folder, check=True, capture_output=True, encoding="utf-8"
    )
    head, *lines = answer.stdout.splitlines()
    assert head == "Axioms:"
    return {line.split(" ")[0] for line in lines if line[0].isalpha()}


@pytest.mark.usefixtures("coq")
def test_coq_accepts_a_heavy_symmetric_top_and_nothing_false_about_it(tmp_path):
    """Energies, L, p, M, h, q̈, Hamilton's function, Euler's equations and first integrals."""
    body = rs.principal_moments(A, A, C)
    of_top = plain(record(rs.derive("ZXZ", body=body, potential="m*g*l*cos(theta)"), {}))
    certificate = certificate_of(of_top)
    uncovered = ["inertia_ellipsoid", "coriolis_matrix", "effective_potential"]
    assert sorted(certificate.uncovered) == sorted(uncovered)
    assert run_coq(tmp_path, certificate.text) == 0
    integral = next(
        line for line in certificate.text.splitlines() if "constant_momentum_psi" in line
    )
    wrong = certificate.text.replace(
        integral, integral.replace("(cos (theta s))", "(sin (theta s))")
    )
    assert wrong != certificate.text
    assert run_coq(tmp_path, wrong) != 0
