"""Certificates: what is printed is what was proved, as a program without rigidsym checks it."""

from __future__ import annotations

import ast
import copy
import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import sympy as sp

import rigidsym as rs
from helpers.certificates import certified, plain, printed, record_of, run_coq, signed, spoil
from helpers.command import call
from rigidsym.errors import CheckError
from rigidsym.models.body import given_inertia
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate import checker
from rigidsym.tools.certificate.certificate import certificate_of
from rigidsym.tools.certificate.formal import coq, theorems

NAME = "euler_zxz_intrinsic"
CHECKER = Path(checker.__file__)
BASIC = ("rotation_matrix", "angular_velocity_body", "rate_matrix_body")
FEWER = (*BASIC, "angular_velocity_space", "inverse_rate_matrix_space")
OTHERS = (
    *("quaternion", "gibbs_vector", "goldstein", "axis_angle", "unit_quaternion", "cayley_klein"),
    *("modified_rodrigues", "z(phi) x(theta) [0,b,c](psi)", "z(phi) [1,1,0](theta) x(pi/4)"),
    *("z(2*phi - psi) x(theta) z(psi/3)", "x(a_1) y(a_2) z(a_3) x(a_4)"),
)


def verified(found: dict[str, Any]) -> list[str]:
    """What the checker proves of a record with a certificate of its own."""
    return checker.verify(found, json.loads(certificate_of(found).json))


def test_all_conventions_are_proved_by_the_checker():
    for text in rs.EULER_SEQUENCES:
        found = record_of(text, None if text == "ZXZ" else FEWER)
        names = [quantity["name"] for quantity in found["quantities"]]
        assert verified(found) == ["R is a rotation", *names]


@pytest.mark.parametrize("text", OTHERS)
def test_other_rotations_are_proved_by_the_checker(text):
    found = record_of(text)
    certificate = json.loads(certified(text))
    assert certificate["uncovered"] == []
    assert len(checker.verify(found, certificate)) == 1 + len(found["quantities"])


def test_entries_of_r_under_nine_conditions_are_proved():
    certificate = json.loads(certified("direction_cosines"))
    proved = checker.verify(record_of("direction_cosines"), certificate)
    assert {"R is a rotation", "angular_velocity_body", "inverse_rate_matrix_space"} <= {*proved}


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
    found = copy.deepcopy(record_of("ZXZ"))
    *rows, last = place
    row = printed(found, quantity)["expression"]
    for index in rows:
        row = row[index]
    assert before in row[last]
    row[last] = row[last].replace(before, after, 1)
    with pytest.raises(checker.Refused, match="is false at a real point"):
        checker.verify(found, signed(found, certified("ZXZ")))
    with pytest.raises(CheckError, match="no cofactors were found"):
        certificate_of(found)


def test_a_right_expression_under_the_wrong_name_is_refused():
    found = copy.deepcopy(record_of("ZXZ"))
    space, body = (printed(found, f"angular_velocity_{frame}") for frame in ("space", "body"))
    space["expression"], body["expression"] = body["expression"], space["expression"]
    with pytest.raises(checker.Refused, match="angular_velocity_space: entry 1 is false"):
        checker.verify(found, signed(found, certified("ZXZ")))


def test_what_is_true_in_numbers_but_not_proved_exactly_is_refused(monkeypatch):
    # cofactors that prove nothing, and claims of which only the exact half is asked
    found = copy.deepcopy(record_of("unit_quaternion"))
    certificate = json.loads(certified("unit_quaternion"))
    name = next(iter(certificate["cofactors"]))
    wrong = copy.deepcopy(certificate)
    wrong["cofactors"][name] = {}
    with pytest.raises(checker.Refused, match="is not proved"):
        checker.verify(found, wrong)
    printed(found, "angular_velocity_space")["expression"][0] += " + 1"
    monkeypatch.setattr(checker, "agree_in_numbers", lambda *_: None)
    with pytest.raises(checker.Refused, match="angular_velocity_space: entry 1 is not proved"):
        checker.verify(found, signed(found, certificate))


def test_numbers_refuse_without_the_exact_half(monkeypatch):
    found = copy.deepcopy(record_of("ZXZ"))
    printed(found, "angular_velocity_space")["expression"][0] += " + sin(phi)/10**30"
    monkeypatch.setattr(checker, "exactly", lambda *_: [])
    with pytest.raises(checker.Refused, match="angular_velocity_space: entry 1 is false"):
        checker.verify(found, signed(found, certified("ZXZ")))


def test_a_record_that_was_edited_after_its_certificate_is_refused():
    found = copy.deepcopy(record_of("ZXZ"))
    found["title"] = "another title"
    with pytest.raises(checker.Refused, match="the record is not the one of this certificate"):
        checker.verify(found, json.loads(certified("ZXZ")))
    found = copy.deepcopy(record_of("ZXZ"))
    found["files"] = {"a": "b"}  # the record names its certificate, which is written before
    assert checker.verify(found, json.loads(certified("ZXZ")))


def test_a_rate_matrix_without_rates_is_asked_for():
    found = copy.deepcopy(record_of("ZXZ"))
    printed(found, "rate_matrix_body")["expression"][2] = ["cos(theta) + psi_dot/phi_dot", "0", "0"]
    with pytest.raises(ValueError, match="phi_dot must not be in"):
        checker.verify(found, signed(found, certified("ZXZ")))


# q times anything is lost in W: without this check each of these would be "proved".
@pytest.mark.parametrize("name", ["w_ddot", "x_dot", "omega_space_2", "anything"])
def test_rates_that_hold_more_than_the_angular_velocity_are_refused(name):
    asked = ("rates_from_angular_velocity_body", "inverse_rate_matrix_body")
    found = copy.deepcopy(record_of("quaternion", asked))
    rates = printed(found, asked[0])["expression"]
    for k, coordinate in enumerate("wxyz"):
        rates[k] = f"{rates[k]} + {coordinate}*{name}"
    with pytest.raises(ValueError, match=f"{name} must not be in"):
        checker.verify(found, signed(found, certified("quaternion", asked)))
    assert asked[0] in certificate_of(found).uncovered


def test_rates_that_leave_the_conditions_are_refused():
    # they turn the body rightly, but q would lose its length
    asked = ("rates_from_angular_velocity_body",)
    found = copy.deepcopy(record_of("unit_quaternion", asked))
    rates = printed(found, asked[0])["expression"]
    for k, coordinate in enumerate("wxyz"):
        rates[k] = f"{rates[k]} + {coordinate}*omega_body_1"
    with pytest.raises(checker.Refused, match="is false at a real point"):
        checker.verify(found, signed(found, certified("unit_quaternion", asked)))


def test_a_claim_about_what_is_not_printed_is_refused():
    certificate = json.loads(certified("ZXZ"))
    certificate["claims"].append("kinetic_energy")
    with pytest.raises(checker.Refused, match="not printed"):
        checker.verify(record_of("ZXZ"), certificate)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os')",
        "phi.real",
        "phi[0]",
        "exp(phi)",
        "cos(phi",
        "cos phi",
        "2**phi",
        "2**(1/3)",
        "x**999",
        "((phi**90)**90)**90",
        "-" * 50_000 + "phi",
        "(" * 5_000 + "phi" + ")" * 5_000,
        "",
        None,
        {},
    ],
)
def test_an_expression_in_another_language_is_refused(text):
    found = copy.deepcopy(record_of("ZXZ", BASIC))
    printed(found, "rotation_matrix")["expression"][0][0] = text
    with pytest.raises(checker.BROKEN):
        checker.verify(found, signed(found, certified("ZXZ", BASIC)))


OF_BODY = ("rotation_matrix", "inertia_tensor", "inertia_tensor_space", "moment_of_inertia")
OF_BODY += ("radii_of_gyration", "kinetic_energy", "angular_momentum")


@pytest.fixture(scope="module")
def box() -> tuple[dict[str, Any], str]:
    found = plain(record(rs.derive("ZXZ", OF_BODY, body=rs.solid("box")), {}))
    return found, certificate_of(found).json


def test_energy_and_momentum_of_a_body_are_proved(box):
    found, certificate = box
    covered = [name for name in OF_BODY if name != "radii_of_gyration"]
    assert {*checker.verify(found, json.loads(certificate))} == {"R is a rotation", *covered}
    assert json.loads(certificate)["uncovered"] == ["radii_of_gyration"]


def test_euler_s_equations_are_proved_and_a_lost_gyroscopic_term_is_refused():
    name = "angular_acceleration_from_torque"
    body = rs.principal_moments(*sp.symbols("A B C", positive=True))
    motion = rs.derive("ZXZ", ["rotation_matrix", name], body=body, potential=0)
    found = plain(record(motion, {}))
    certificate = certificate_of(found).json
    assert name in checker.verify(found, json.loads(certificate))
    entries = printed(found, name)["expression"]
    entries[0] = entries[0].replace("B - C", "B + C")
    with pytest.raises(ValueError, match=f"{name}: entry 1 is false"):
        checker.verify(found, signed(found, certificate))


@pytest.mark.parametrize(
    ("quantity", "before", "after"),
    [
        ("kinetic_energy", "/24", "/12"),
        ("angular_momentum", "X_dot", "Y_dot"),
        ("moment_of_inertia", "p_x", "p_y"),
        ("inertia_tensor_space", "cos", "sin"),
    ],
)
def test_a_wrong_energy_momentum_or_tensor_is_refused(box, quantity, before, after):
    found, certificate = copy.deepcopy(box)
    spoil(found, quantity, before, after)
    with pytest.raises(ValueError, match=f"{quantity}: entry . is false"):
        checker.verify(found, signed(found, certificate))


OF_MOTION = ("potential_energy", "lagrangian", "energy", "generalised_momenta", "mass_matrix")
OF_MOTION += ("bias_vector", "accelerations", "coriolis_matrix", "hamiltonian")
PRINCIPAL = ("principal_moments", "principal_axes")


@pytest.fixture(scope="module")
def top() -> tuple[dict[str, Any], str]:
    """A heavy symmetric top on which a torque acts: all of Lagrange's equations."""
    A, C = sp.symbols("A C", positive=True)
    motion = rs.derive(
        "ZXZ",
        [*BASIC[:2], *OF_MOTION, *PRINCIPAL, "inertia_ellipsoid"],
        body=rs.principal_moments(A, A, C),
        potential="m*g*l*cos(theta)",
        forces={"psi": "-k*psi_dot"},
    )
    found = plain(record(motion, {}))
    return found, certificate_of(found).json


def test_lagrange_s_equations_are_proved(top):
    found, certificate = top
    proved = {"R is a rotation", *BASIC[:2], *OF_MOTION, *PRINCIPAL, "constant momentum_phi"}
    assert {*checker.verify(found, json.loads(certificate))} == proved
    assert json.loads(certificate)["uncovered"] == ["inertia_ellipsoid"]
    with pytest.raises(checker.Unreadable, match="inertia_ellipsoid has no law here"):
        checker.verify(found, signed(found, certificate, claims=["inertia_ellipsoid"]))


@pytest.mark.parametrize(
    ("quantity", "before", "after"),
    [
        ("lagrangian", "- g*l*m*cos", "+ g*l*m*cos"),
        ("potential_energy", "cos", "sin"),
        ("generalised_momenta", "C*(", "A*("),
        ("mass_matrix", "C", "A"),
        ("bias_vector", "g*l*m", "2*g*l*m"),
        ("accelerations", "k*", "2*k*"),
        ("coriolis_matrix", "/2", "/4"),
        ("hamiltonian", "p_theta**2", "p_psi**2"),
        ("hamiltonian", "2*p_phi*p_psi", "p_phi*p_psi"),
        ("hamiltonian", "g*l*m", "-g*l*m"),
        ("constant momentum_phi", "sin(theta)**2", "sin(theta)"),
    ],
)
def test_a_wrong_equation_of_motion_is_refused(top, quantity, before, after):
    found, certificate = copy.deepcopy(top)
    spoil(found, quantity, before, after)
    with pytest.raises(ValueError, match=r"is false at a real point|holds|must not be in"):
        checker.verify(found, signed(found, certificate))


def test_a_hamiltonian_in_the_rates_is_refused(top):
    # the energy itself would satisfy H(q, p(q, q̇)) = E(q, q̇)
    found, certificate = copy.deepcopy(top)
    energy = printed(found, "energy")["expression"]
    printed(found, "hamiltonian")["expression"] = energy
    with pytest.raises(ValueError, match="phi_dot must not be in"):
        checker.verify(found, signed(found, certificate))


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("motion", "potential"), "0"),
        (("motion", "forces"), ["0", "0", "0"]),
        (("body", "inertia", 0), ["C", "0", "0"]),
        (("body", "inertia", 0), ["1/(A - A)", "0", "0"]),
        (("body", "inertia", 0), ["A + 0*phi", "0", "0"]),
    ],
)
def test_another_cause_of_the_motion_is_refused(top, place, value):
    found, certificate = copy.deepcopy(top)
    *path, last = place
    part = found
    for key in path:
        part = part[key]
    part[last] = value
    with pytest.raises(checker.BROKEN):
        checker.verify(found, signed(found, certificate))


def principal(*rows: tuple[Any, Any, Any], rotation: str = "ZXZ") -> dict[str, Any]:
    """The record of a body with a given tensor, with its principal axes and moments."""
    body = given_inertia(sp.Matrix(rows), mass=sp.Symbol("M", positive=True))
    return plain(record(rs.derive(rotation, PRINCIPAL, body=body), {}))


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
    "one entry has the other sign": lambda axes, _: times("-1", axes[1:2], 0),
    "they are left-handed": lambda axes, _: times("-1", axes, 0),
    "right-handed eigenvectors with a volume of 1, not unit vectors": stretched,
    "orthonormal, but no eigenvectors": unturned,
    "moments are exchanged": lambda _, moments: moments.reverse(),
    "a moment is doubled": lambda _, moments: times("2", [moments], 2),
}


@pytest.mark.parametrize("fault", [None, *WRONG_AXES])
def test_principal_axes_and_moments_are_proved_and_wrong_ones_refused(fault):
    # moments 6 and 6 ± 2√2 about axes that lie between those of the description
    found = principal((6, -2, 0), (-2, 6, -2), (0, -2, 6))
    certificate = certificate_of(found).json
    if fault is None:
        assert {*PRINCIPAL} < {*checker.verify(found, json.loads(certificate))}
        return
    axes, moments = (printed(found, name)["expression"] for name in reversed(PRINCIPAL))
    WRONG_AXES[fault](axes, moments)
    with pytest.raises(CheckError, match="no cofactors were found"):
        certificate_of(found)
    with pytest.raises(checker.BROKEN):
        checker.verify(found, signed(found, certificate))


def test_principal_axes_in_symbols_are_proved():
    # a root holds the inverse of another one, which comes back after it was cleared
    a, b, c, d = sp.symbols("a b c d", positive=True)
    assert {*PRINCIPAL} < {*verified(principal((a, d, 0), (d, b, 0), (0, 0, c)))}


def test_a_torque_along_the_axes_of_the_body_is_proved_to_act():
    motion = rs.derive(
        "ZYX",
        ["angular_velocity_body", "accelerations"],
        body=rs.principal_moments(*sp.symbols("A A C", positive=True)),
        torque=["l*F", "0", "k*F"],
    )
    found = plain(record(motion, {}))
    certificate = certificate_of(found).json
    assert "accelerations" in checker.verify(found, json.loads(certificate))
    found["motion"]["torque"] = ["l*F", "k*F", "0"]
    with pytest.raises(ValueError, match=r"accelerations: entry . is false"):
        checker.verify(found, signed(found, certificate))


def test_the_energy_is_proved_constant_and_a_wrong_one_is_refused():
    A, C = sp.symbols("A C", positive=True)
    body = rs.principal_moments(A, A, C)
    found = plain(record(rs.derive("ZXZ", ["energy"], body=body, potential="m*g*l*cos(theta)"), {}))
    certificate = certificate_of(found).json
    constants = {"constant energy", "constant momentum_phi", "constant momentum_psi"}
    proved = {*checker.verify(found, json.loads(certificate))}
    assert proved == {"R is a rotation", "energy", *constants}
    wrongs = [("cos(theta)", "sin(theta)"), ("g*l*m", "2*g*l*m"), ("A", "C")]
    for before, after in wrongs:
        wrong = copy.deepcopy(found)
        spoil(wrong, "constant energy", before, after)
        with pytest.raises(ValueError, match="constant energy: entry 1 is false"):
            checker.verify(wrong, signed(wrong, certificate))


@pytest.mark.parametrize("expression", ["0", "1", "A", "momentum", "phi", "energy"])
def test_a_constant_that_is_no_energy_is_not_called_the_energy(top, expression):
    found, certificate = copy.deepcopy(top)
    found["first_integrals"].append({"name": "energy", "expression": expression})
    claims = [*json.loads(certificate)["claims"], "constant energy"]
    with pytest.raises(checker.BROKEN):
        checker.verify(found, signed(found, certificate, claims=claims))


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
    expected = {f"{NAME}.cert.json", f"{NAME}.v", "Rotation.v"}
    assert expected <= {file.name for file in folder.iterdir()}
    assert f"{NAME}.cert.json: up to date" in call("check", "out", cwd=tmp_path).stdout
    alone = [sys.executable, "-I", "-S", str(CHECKER), "out"]
    done = subprocess.run(alone, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "proved for R by {'turns': ['z(phi)', 'x(theta)', 'z(psi)']" in done.stdout
    assert "'R is a rotation', 'rotation_matrix'" in done.stdout
    path = folder / f"{NAME}.json"
    path.write_text(path.read_text().replace("-sin(phi)*sin(psi)", "sin(phi)*sin(psi)"))
    done = subprocess.run(alone, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "REFUSED: the record is not the one of this certificate" in done.stdout
    path.write_text(path.read_text().replace('"title"', '"title": "", "title"', 1))
    done = subprocess.run(alone, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert "REFUSED: a key is there twice" in done.stdout
    nothing = [*alone[:-1], "none"]
    assert subprocess.run(nothing, cwd=tmp_path, check=False).returncode == 0


@pytest.mark.usefixtures("coq")
def test_coq_accepts_all_kinematics_and_refuses_a_wrong_one(tmp_path):
    found = record_of("ZXZ")
    text = coq(found, json.loads(certified("ZXZ"))["claims"])
    assert "Without a theorem here: nothing." in text
    assert run_coq(tmp_path, text) == 0
    wrong = text.replace("((phi_dot t) * (cos (theta t)))", "((phi_dot t) * (sin (theta t)))")
    assert wrong != text
    assert run_coq(tmp_path, wrong) != 0


@pytest.mark.usefixtures("coq")
def test_coq_accepts_a_heavy_symmetric_top_and_nothing_false_about_it(tmp_path):
    """Energies, L, p, M, h, q, Hamilton's function, Euler's equations and first integrals."""
    moments = sp.symbols("A C", positive=True)
    body = rs.principal_moments(moments[0], *moments)
    motion = rs.derive("ZXZ", body=body, potential="m*g*l*cos(theta)")
    found = plain(record(motion, {}))
    claims = json.loads(certificate_of(found).json)["claims"]
    assert {*claims} - {*theorems(found, claims)[1]} == {"coriolis_matrix"}
    assert run_coq(tmp_path, coq(found, claims)) == 0
    wrong = copy.deepcopy(found)
    spoil(wrong, "constant momentum_psi", "cos", "sin")
    assert "constant momentum_psi" in theorems(wrong, claims)[1]
    assert run_coq(tmp_path, coq(wrong, claims)) != 0


@pytest.mark.usefixtures("coq")
def test_coq_accepts_a_quaternion_and_its_theorems_rest_on_the_real_numbers_alone(tmp_path):
    found = record_of("unit_quaternion")
    claims = json.loads(certified("unit_quaternion"))["claims"]
    text = coq(found, claims)
    assert "Without a theorem here: nothing." in text
    assert run_coq(tmp_path, text) == 0
    question = "Require Import claims. Print Assumptions angular_velocity_body."
    (tmp_path / "question.v").write_text(question, encoding="utf-8")
    answer = subprocess.run(
        ["coqc", "question.v"], cwd=tmp_path, check=True, capture_output=True, encoding="utf-8"
    )
    axioms = {line.split(" ")[0] for line in answer.stdout.splitlines() if line[0].isalpha()}
    of_the_reals = {
        "Axioms:",
        "ClassicalDedekindReals.sig_not_dec",
        "ClassicalDedekindReals.sig_forall_dec",
        "FunctionalExtensionality.functional_extensionality_dep",
    }
    assert {"Axioms:"} < axioms <= of_the_reals


@pytest.mark.usefixtures("coq")
def test_coq_accepts_a_chain_with_a_constant_turn_and_an_oblique_axis(tmp_path):
    found = record_of("z(phi) [1,1,0](theta) x(pi/4)", BASIC)
    text = coq(found, [quantity["name"] for quantity in found["quantities"]])
    assert "Without a theorem here: nothing." in text
    assert run_coq(tmp_path, text) == 0
