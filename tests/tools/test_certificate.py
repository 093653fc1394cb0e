"""Certificates: what is printed is what was proved, as a program without rigidsym checks it."""

from __future__ import annotations

import ast
import copy
import json
import os
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
import sympy as sp

import rigidsym as rs
from helpers.command import call
from rigidsym.errors import CheckError
from rigidsym.models.body import given_inertia
from rigidsym.models.rotation_text import rotation_from
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate import checker
from rigidsym.tools.certificate.certificate import certificate_of
from rigidsym.tools.certificate.formal import coq, lean

NAME = "euler_zxz_intrinsic"
CHECKER = Path(checker.__file__)
LECTURE = Path(__file__).parents[2] / "derivations" / "lecture.toml"
BASIC = ("rotation_matrix", "angular_velocity_body", "rate_matrix_body")
FEWER = (*BASIC, "angular_velocity_space", "inverse_rate_matrix_space")
OTHERS = {
    "quaternion": None,
    "gibbs_vector": None,
    "goldstein": None,
    "axis_angle": BASIC,
    "unit_quaternion": None,
    "cayley_klein": None,
    "modified_rodrigues": BASIC,
    "rotation_vector": BASIC[:2],
    "direction_cosines": ("rotation_matrix",),
    "davenport": BASIC,
    "z(phi) [1,1,0](theta) x(pi/4)": BASIC,
    "z(2*phi - psi) x(theta) z(psi/3)": BASIC,
    "x(a_1) y(a_2) z(a_3) x(a_4)": BASIC,
}


@cache
def record_of(text: str, quantities: tuple[str, ...] | None = None) -> dict[str, Any]:
    motion = rs.derive(rotation_from(text), *([quantities] if quantities else []))
    return json.loads(json.dumps(record(motion, {"rotations": [{"sequence": text}]})))


@cache
def certified(text: str, quantities: tuple[str, ...] | None = None) -> str:
    return certificate_of(record_of(text, quantities)).json


def zxz() -> tuple[dict[str, Any], dict[str, Any]]:
    """A record and its certificate, to be changed."""
    return copy.deepcopy(record_of("ZXZ")), json.loads(certified("ZXZ"))


def printed(found: dict[str, Any], name: str) -> dict[str, Any]:
    """A quantity, or the first integral "constant NAME"."""
    group = "first_integrals" if name.startswith("constant ") else "quantities"
    return next(each for each in found[group] if each["name"] == name.removeprefix("constant "))


def test_all_conventions_are_proved_by_the_checker():
    for text in rs.EULER_SEQUENCES:
        quantities = None if text == "ZXZ" else FEWER
        names = [quantity["name"] for quantity in record_of(text, quantities)["quantities"]]
        certificate = json.loads(certified(text, quantities))
        found = checker.verify(record_of(text, quantities), certificate)
        assert list(found) == ["R is a rotation", *names]


@pytest.mark.parametrize(("text", "quantities"), OTHERS.items())
def test_other_rotations_are_proved_by_the_checker(text, quantities):
    certificate = json.loads(certified(text, quantities))
    found = checker.verify(record_of(text, quantities), certificate)
    assert "rotation_matrix" in found
    assert certificate["uncovered"] == []


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
    found, certificate = zxz()
    *rows, last = place
    row = printed(found, quantity)["expression"]
    for index in rows:
        row = row[index]
    assert before in row[last]
    row[last] = row[last].replace(before, after, 1)
    with pytest.raises(checker.BROKEN):
        checker.verify(found, certificate)
    with pytest.raises(CheckError, match="no cofactors were found"):
        certificate_of(found)


def test_a_right_expression_under_the_wrong_name_is_refused():
    found, certificate = zxz()
    space, body = (printed(found, f"angular_velocity_{frame}") for frame in ("space", "body"))
    space["expression"], body["expression"] = body["expression"], space["expression"]
    with pytest.raises(ValueError, match="angular_velocity_space"):
        checker.verify(found, certificate)


def test_another_convention_is_refused():
    found, certificate = zxz()
    found["rotation"]["turns"][1] = "y(theta)"
    with pytest.raises(ValueError, match="R is a rotation: its cofactors do not prove"):
        checker.verify(found, certificate)
    with pytest.raises(CheckError, match="rotation_matrix: no cofactors were found"):
        certificate_of(found)


def test_a_changed_cofactor_is_refused():
    found, certificate = zxz()
    cofactor = certificate["claims"]["R is a rotation"][0]["0"]
    cofactor[0][0] = "7"
    with pytest.raises(ValueError, match="R is a rotation: its cofactors"):
        checker.verify(found, certificate)


def test_a_relation_that_does_not_hold_is_refused():
    found, certificate = zxz()
    certificate["relations"][0] = [["1"]]
    with pytest.raises(KeyError, match="'1'"):
        checker.verify(found, certificate)


def test_a_claim_without_cofactors_is_refused():
    found, certificate = zxz()
    del certificate["claims"]["spin_matrix"]
    assert "spin_matrix" not in checker.verify(found, certificate)
    certificate["claims"]["spin_matrix"] = []
    with pytest.raises(ValueError, match="zip"):
        checker.verify(found, certificate)
    del certificate["claims"]["R is a rotation"]
    with pytest.raises(checker.BROKEN):
        checker.verify(found, certificate)


def test_a_rate_matrix_without_rates_is_asked_for():
    found, certificate = zxz()
    W = printed(found, "rate_matrix_body")["expression"]
    W[2] = ["cos(theta) + psi_dot/phi_dot", "0", "0"]
    with pytest.raises(ValueError, match="rate_matrix_body holds phi_dot"):
        checker.verify(found, certificate)


# q times anything is lost in W: without this check each of these would be "proved".
@pytest.mark.parametrize("name", ["w_ddot", "x_dot", "omega_space_2", "anything"])
def test_rates_that_hold_more_than_the_angular_velocity_are_refused(name):
    asked = ("rates_from_angular_velocity_body", "inverse_rate_matrix_body")
    found = copy.deepcopy(record_of("quaternion", asked))
    rates = printed(found, asked[0])["expression"]
    names = [c["name"] for g in found["arguments"] if g["name"] == "q" for c in g["components"]]
    name = name.replace("w", names[0]).replace("x_", f"{names[1]}_")
    for k, coordinate in enumerate(names):
        rates[k] = f"{rates[k]} + {coordinate}*{name}"
    certificate = json.loads(certified("quaternion", asked))
    with pytest.raises(ValueError, match=f"{asked[0]} holds {name}"):
        checker.verify(found, certificate)
    assert asked[0] in certificate_of(found).uncovered


def test_a_division_by_zero_proves_nothing():
    found, certificate = zxz()
    entry = "phi/(sin(phi)**2 + cos(phi)**2 - 1)"
    printed(found, "rotation_matrix")["expression"][0][0] = entry
    with pytest.raises(KeyError, match="1/"):  # a divisor without a value at the point
        checker.verify(found, certificate)
    inverse = "1/(-1 + 1*cos(1*phi)*cos(1*phi) + 1*sin(1*phi)*sin(1*phi))"
    certificate["point"][inverse] = 7
    with pytest.raises(ValueError, match="does not vanish at the point"):
        checker.verify(found, certificate)
    with pytest.raises(CheckError, match="no point was found"):
        certificate_of(found)
    printed(found, "rotation_matrix")["expression"][0][0] = "1/(2 - 2)"
    with pytest.raises(ZeroDivisionError):
        checker.verify(found, certificate)


def test_conditions_that_contradict_each_other_prove_nothing():
    found, certificate = zxz()
    found["rotation"]["conditions"] = ["phi", "phi - 1"]
    certificate["point"] |= {"phi": 0, "phi_dot": 0, "phi_ddot": 0}
    with pytest.raises(ValueError, match="does not vanish at the point"):
        checker.verify(found, certificate)
    # a multiple of the prime vanishes at every point, so it must not be divided out
    found["rotation"]["conditions"] = [str(checker.PRIME)]
    certificate["relations"].append([[str(checker.PRIME)]])
    place = str(len(certificate["relations"]) - 1)
    W = printed(found, "rate_matrix_body")["expression"]
    W[2][0] = "cos(theta) + 1"
    cofactor = [[f"1/{checker.PRIME}", certificate["names"].index("phi_dot")]]
    certificate["claims"]["rate_matrix_body"][2] |= {place: cofactor}
    with pytest.raises(ValueError, match="rate_matrix_body: its cofactors do not prove entry 3"):
        checker.verify(found, certificate)


def test_parts_of_angles_cannot_turn_a_sine_round():
    found, certificate = zxz()
    certificate["parts"] = {"phi": -1}
    with pytest.raises(checker.BROKEN):
        checker.verify(found, certificate)
    certificate["parts"] = {"phi": 10**9}
    with pytest.raises(ValueError, match="cannot take the cosine"):
        checker.verify(found, certificate)


def test_a_quantity_that_is_printed_twice_is_refused():
    found, certificate = zxz()
    wrong = copy.deepcopy(printed(found, "angular_velocity_space"))
    wrong["expression"][0] = "phi_dot"
    found["quantities"].insert(0, wrong)
    with pytest.raises(ValueError, match="two claims have one name"):
        checker.verify(found, certificate)


def test_a_quantity_with_the_name_of_a_claim_is_refused():
    found, certificate = zxz()
    printed(found, "spin_matrix")["name"] = "R is a rotation"
    with pytest.raises(ValueError, match="two claims have one name"):
        checker.verify(found, certificate)


def test_the_root_of_a_fraction_is_not_that_of_a_whole_number():
    # sqrt(9/2) was read as 2
    known = checker.Language(record_of("ZXZ"), {})
    assert str(known.read("sqrt(9/2)")) == "1*sqrt(9/2)"
    assert str(known.read("sqrt(6)")) == "1*sqrt(2)*sqrt(3)"


def test_rates_in_another_order_are_refused():
    found, certificate = zxz()
    rates = next(group for group in found["arguments"] if group["name"] == "q_dot")
    rates["components"].reverse()
    for row in printed(found, "rate_matrix_body")["expression"]:
        row.reverse()  # right for rates in this order, but named after the coordinates
    with pytest.raises(ValueError, match="rate_matrix_body: its cofactors do not prove"):
        checker.verify(found, certificate)


def test_a_claim_about_what_is_not_printed_is_not_called_proved():
    found, certificate = zxz()
    certificate["claims"]["kinetic_energy"] = [{}]
    assert "kinetic_energy" not in checker.verify(found, certificate)


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os')",
        "phi.real",
        "phi[0]",
        "exp(phi)",
        "cos(phi",
        "2**phi",
        "2**(1/3)",
        "x**999",
        "((phi**90)**90)**90",
        "-" * 50_000 + "phi",
        None,
        {},
    ],
)
def test_an_expression_in_another_language_is_refused(text):
    found, certificate = zxz()
    printed(found, "rotation_matrix")["expression"][0][0] = text
    with pytest.raises(checker.BROKEN):
        checker.verify(found, certificate)


OF_BODY = ("rotation_matrix", "inertia_tensor", "inertia_tensor_space", "moment_of_inertia")
OF_BODY += ("radii_of_gyration", "kinetic_energy", "angular_momentum")


@pytest.fixture(scope="module")
def box() -> tuple[dict[str, Any], dict[str, Any]]:
    found = record(rs.derive("ZXZ", OF_BODY, body=rs.solid("box")), {})
    found = json.loads(json.dumps(found))
    return found, json.loads(certificate_of(found).json)


def test_energy_and_momentum_of_a_body_are_proved(box):
    found, certificate = box
    covered = [name for name in OF_BODY if name != "radii_of_gyration"]
    assert set(checker.verify(found, certificate)) == {"R is a rotation", *covered}
    assert certificate["uncovered"] == ["radii_of_gyration"]


def test_euler_s_equations_are_proved_and_a_lost_gyroscopic_term_is_refused():
    name = "angular_acceleration_from_torque"
    body = rs.principal_moments(*sp.symbols("A B C", positive=True))
    motion = rs.derive("ZXZ", ["rotation_matrix", name], body=body, potential=0)
    found = json.loads(json.dumps(record(motion, {})))
    certificate = json.loads(certificate_of(found).json)
    assert name in checker.verify(found, certificate)
    entries = printed(found, name)["expression"]
    entries[0] = entries[0].replace("B - C", "B + C")
    with pytest.raises(ValueError, match=f"{name}: its cofactors do not prove entry 1"):
        checker.verify(found, certificate)


def spoil(found: dict[str, Any], quantity: str, before: str, after: str) -> None:
    """Change what is printed of a quantity, once."""
    text = json.dumps(printed(found, quantity)["expression"])
    assert before in text
    printed(found, quantity)["expression"] = json.loads(text.replace(before, after, 1))


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
    with pytest.raises(ValueError, match=f"{quantity}: its cofactors do not prove"):
        checker.verify(found, certificate)


@pytest.fixture(scope="module")
def top() -> tuple[dict[str, Any], dict[str, Any]]:
    """A heavy symmetric top on which a torque acts: all of Lagrange's equations."""
    A, C = sp.symbols("A C", positive=True)
    motion = rs.derive(
        "ZXZ",
        [*BASIC[:2], *OF_MOTION, *PRINCIPAL, *NOT_COVERED],
        body=rs.principal_moments(A, A, C),
        potential="m*g*l*cos(theta)",
        forces={"psi": "-k*psi_dot"},
    )
    found = json.loads(json.dumps(record(motion, {})))
    return found, json.loads(certificate_of(found).json)


OF_MOTION = ("potential_energy", "lagrangian", "energy", "generalised_momenta", "mass_matrix")
OF_MOTION += ("bias_vector", "accelerations", "coriolis_matrix", "hamiltonian")
PRINCIPAL = ("principal_moments", "principal_axes")
NOT_COVERED = ("inertia_ellipsoid",)


def test_lagrange_s_equations_are_proved(top):
    found, certificate = top
    proved = {"R is a rotation", *BASIC[:2], *OF_MOTION, *PRINCIPAL, "constant momentum_phi"}
    assert {*checker.verify(found, certificate)} == proved
    assert {*certificate["uncovered"]} == {*NOT_COVERED}


@pytest.mark.parametrize("name", NOT_COVERED)
def test_a_claim_that_the_checker_does_not_know_is_refused(top, name):
    found, certificate = copy.deepcopy(top)
    certificate["claims"][name] = [{}]
    with pytest.raises(KeyError, match=name):
        checker.verify(found, certificate)


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
    with pytest.raises(ValueError, match="its cofactors do not prove"):
        checker.verify(found, certificate)


def principal(*rows: tuple[Any, Any, Any], rotation: str = "ZXZ") -> dict[str, Any]:
    """The record of a body with a given tensor, with its principal axes and moments."""
    body = given_inertia(sp.Matrix(rows), mass=sp.Symbol("M", positive=True))
    return json.loads(json.dumps(record(rs.derive(rotation, PRINCIPAL, body=body), {})))


@pytest.fixture(scope="module")
def oblique() -> dict[str, Any]:
    """Moments 6 and 6 ± 2√2 about axes that lie between those of the description."""
    return principal((6, -2, 0), (-2, 6, -2), (0, -2, 6))


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


def test_principal_axes_and_moments_are_proved(oblique):
    certificate = json.loads(certificate_of(oblique).json)
    assert {*PRINCIPAL} < {*checker.verify(oblique, certificate)}
    assert certificate["uncovered"] == []
    del certificate["claims"]["principal_axes"]
    with pytest.raises(KeyError, match="principal_moments"):
        checker.verify(oblique, certificate)


@pytest.mark.parametrize("fault", WRONG_AXES)
def test_wrong_principal_axes_or_moments_are_refused(oblique, fault):
    found = copy.deepcopy(oblique)
    certificate = json.loads(certificate_of(found).json)
    axes, moments = (printed(found, name)["expression"] for name in reversed(PRINCIPAL))
    WRONG_AXES[fault](axes, moments)
    with pytest.raises(CheckError, match="principal_axes: no cofactors were found"):
        certificate_of(found)
    with pytest.raises(checker.BROKEN):
        checker.verify(found, certificate)


def test_principal_axes_in_symbols_are_proved_also_by_coq(tmp_path):
    # a root holds the inverse of another one, which comes back after it was cleared
    a, b, c, d = sp.symbols("a b c d", positive=True)
    found = principal((a, d, 0), (d, b, 0), (0, 0, c))
    certificate = certificate_of(found)
    assert {*PRINCIPAL} < {*checker.verify(found, json.loads(certificate.json))}
    assert run_coq(tmp_path, coq(certificate)) == 0
    # one point in two has a root of ½ + (a − b)/2n; with nine entries of R only one was tried
    of_entries = principal((a, d, 0), (d, b, 0), (0, 0, c), rotation="direction_cosines")
    assert {*PRINCIPAL} < {*certificate_of(of_entries).claims}


def test_a_torque_along_the_axes_of_the_body_is_proved_to_act():
    motion = rs.derive(
        "ZYX",
        ["angular_velocity_body", "accelerations"],
        body=rs.principal_moments(*sp.symbols("A A C", positive=True)),
        torque=["l*F", "0", "k*F"],
    )
    found = json.loads(json.dumps(record(motion, {})))
    certificate = json.loads(certificate_of(found).json)
    assert "accelerations" in checker.verify(found, certificate)
    found["motion"]["torque"] = ["l*F", "k*F", "0"]
    with pytest.raises(ValueError, match="accelerations: its cofactors do not prove"):
        checker.verify(found, certificate)


def test_the_energy_is_proved_constant_and_a_wrong_one_is_refused():
    A, C = sp.symbols("A C", positive=True)
    motion = rs.derive(
        "ZXZ", ["energy"], body=rs.principal_moments(A, A, C), potential="m*g*l*cos(theta)"
    )
    found = json.loads(json.dumps(record(motion, {})))
    certificate = json.loads(certificate_of(found).json)
    constants = {"constant energy", "constant momentum_phi", "constant momentum_psi"}
    assert {*checker.verify(found, certificate)} == {"R is a rotation", "energy", *constants}
    for before, after in ("cos(theta)", "sin(theta)"), ("g*l*m", "2*g*l*m"), ("A", "C"):
        wrong = copy.deepcopy(found)
        spoil(wrong, "constant energy", before, after)
        with pytest.raises(ValueError, match="constant energy: its cofactors do not prove"):
            checker.verify(wrong, certificate)


def test_a_hamiltonian_in_the_rates_is_refused(top):
    # the energy itself would satisfy H(q, p(q, q̇)) = E(q, q̇)
    found, certificate = copy.deepcopy(top)
    energy = printed(found, "energy")["expression"]
    printed(found, "hamiltonian")["expression"] = energy
    certificate["claims"]["hamiltonian"] = certificate["claims"]["energy"]
    with pytest.raises(ValueError, match="hamiltonian holds phi_dot"):
        checker.verify(found, certificate)


def test_the_momenta_of_a_hamiltonian_are_those_of_its_coordinates(top):
    found, certificate = copy.deepcopy(top)
    group = next(group for group in found["arguments"] if group["name"] == "momenta")
    group["components"].reverse()
    spoil(found, "hamiltonian", "p_theta**2", "p_phi**2")
    with pytest.raises(ValueError, match="hamiltonian: its cofactors do not prove"):
        checker.verify(found, certificate)


def test_a_wrong_angular_velocity_proves_nothing_about_the_energy(top):
    # the kinetic energy is stated in the printed Ω′, which is why this has to be proved as well
    found, certificate = copy.deepcopy(top)
    spoil(found, "angular_velocity_body", "psi_dot", "2*psi_dot")
    for quantity in ("energy", "lagrangian"):
        spoil(found, quantity, "psi_dot", "2*psi_dot")
    with pytest.raises(ValueError, match="angular_velocity_body: its cofactors do not prove"):
        checker.verify(found, certificate)


@pytest.mark.parametrize("expression", ["0", "1", "A", "momentum", "phi", "energy"])
def test_a_constant_that_is_no_energy_is_not_called_the_energy(top, expression):
    found, certificate = copy.deepcopy(top)
    found["first_integrals"].append({"name": "energy", "expression": expression})
    certificate["claims"]["constant energy"] = [{}]
    with pytest.raises(checker.BROKEN):
        checker.verify(found, certificate)


def test_euler_s_equations_of_a_quaternion_have_a_certificate():
    # their energy holds Ω′, which was compared with the energy in the rates, and refused
    body = rs.principal_moments(*sp.symbols("A B C", positive=True))
    asked = ["rotation_matrix", *PRINCIPAL, "energy"]
    motion = rs.derive("unit_quaternion", asked, body=body, potential=0)
    certificate = certificate_of(json.loads(json.dumps(record(motion, {}))))
    assert {"rotation_matrix", *PRINCIPAL} <= {*certificate.claims}
    assert {"energy", "constant energy"} <= {*certificate.uncovered}


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("motion", "potential"), "0"),
        (("motion", "forces"), ["0", "0", "0"]),
        (("body", "inertia", 0), ["C", "0", "0"]),
        (("body", "inertia", 0), ["1/(A - A)", "0", "0"]),
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
        checker.verify(found, certificate)


def test_the_checker_is_short_and_needs_only_the_standard_library():
    text = CHECKER.read_text(encoding="utf-8")
    assert text.count("\n") <= 300
    tree = ast.parse(text)
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
    assert {f"{NAME}.{ending}" for ending in ("cert.json", "v", "lean")} <= {
        file.name for file in folder.iterdir()
    }
    assert f"{NAME}.cert.json: up to date" in call("check", "out", cwd=tmp_path).stdout
    alone = [sys.executable, "-I", "-S", str(CHECKER), "out"]
    done = subprocess.run(alone, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "proved for R by {'turns': ['z(phi)', 'x(theta)', 'z(psi)']" in done.stdout
    assert "'R is a rotation', 'rotation_matrix'" in done.stdout
    path = folder / f"{NAME}.json"
    path.write_text(path.read_text().replace("-sin(phi)*sin(psi)", "sin(phi)*sin(psi)"))
    done = subprocess.run(alone, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "REFUSED: rotation_matrix" in done.stdout
    nothing = [*alone[:-1], "none"]
    assert subprocess.run(nothing, cwd=tmp_path, check=False).returncode == 0
    done = call("check", "out", cwd=tmp_path, status=1)
    assert f"{NAME}.cert.json: refused: rotation_matrix" in done.stdout


def run_coq(folder: Path, text: str) -> int:
    coqc = shutil.which("coqc")
    if coqc is None and os.environ.get("RIGIDSYM_REQUIRE_COQ") != "1":
        pytest.skip("Coq is not installed")
    (folder / "claims.v").write_text(text)
    found = subprocess.run([coqc, "claims.v"], cwd=folder, check=False, capture_output=True)
    return found.returncode


def test_coq_accepts_the_quantities_of_the_lecture(tmp_path):
    names = tomllib.loads(LECTURE.read_text(encoding="utf-8"))["output"]["quantities"]
    body = rs.principal_moments(*sp.symbols("A B C", positive=True))
    certificate = certificate_of(
        json.loads(json.dumps(record(rs.derive("ZXZ", names, body=body), {})))
    )
    assert {*names} <= certificate.claims.keys()
    assert run_coq(tmp_path, coq(certificate)) == 0


def test_coq_accepts_the_theorems_and_refuses_a_wrong_one(tmp_path):
    text = coq(certificate_of(record_of("ZXZ", BASIC)))
    assert " = cos_theta.\n" in text
    assert run_coq(tmp_path, text) == 0
    assert run_coq(tmp_path, text.replace(" = cos_theta.\n", " = sin_theta.\n", 1)) != 0


RATES = ("rotation_matrix", "rate_matrix_body")


def test_coq_accepts_the_lagrangian_and_the_mass_matrix(tmp_path):
    # a Hamiltonian takes Coq half a minute, q̈ minutes
    names = ("angular_velocity_body", "lagrangian", "mass_matrix")
    body = rs.principal_moments(*sp.symbols("A A C", positive=True))
    motion = rs.derive("ZXZ", names, body=body, potential="m*g*l*cos(theta)")
    found = json.loads(json.dumps(record(motion, {}))) | {"first_integrals": []}
    certificate = certificate_of(found)
    assert certificate.claims.keys() == {"R is a rotation", *names}
    assert run_coq(tmp_path, coq(certificate)) == 0


def test_coq_accepts_each_rotation_of_the_catalogue(tmp_path):
    # all quantities take Coq two minutes: `python benchmarks/run.py certificates`
    text = "".join(
        f"Module {name}.\n{coq(certificate_of(record_of(name, RATES)))}End {name}.\n"
        for name in rs.EULER_SEQUENCES
    )
    assert run_coq(tmp_path, text) == 0


def test_lean_gets_each_entry_with_its_cofactors():
    text = lean(certificate_of(record_of("ZXZ", BASIC)))
    proved = json.loads(certified("ZXZ", BASIC))["claims"].values()
    assert sum(map(len, proved)) == 10 + 9 + 3 + 3
    # each equation once: R Rᵀ = 1 is symmetric, and zeros repeat
    assert text.count("theorem ") == text.count("linear_combination") == 19
    assert "has not been compiled" in text


def test_the_inverse_of_a_square_is_the_square_of_an_inverse():
    # 1/n² beside 1/n took minutes: each needs a relation of its own, and sums of squares to a power
    names = json.loads(certified("rotation_vector", ("rotation_matrix", "rate_matrix_body")))[
        "names"
    ]
    assert sum(name.startswith("1/(") for name in names) == 1
