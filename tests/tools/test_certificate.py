"""Certificates: a program without rigidsym, and Coq, prove what is printed."""

from __future__ import annotations

import ast
import copy
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

import rigidsym as rs
from helpers.certificates import NEEDS, of_motion, of_top, plain, printed, record_of, run_coq
from helpers.command import call
from rigidsym.commands.cli import commands
from rigidsym.errors import CheckError
from rigidsym.notes.formats.record import record
from rigidsym.tools.certificate import checker
from rigidsym.tools.certificate.certificate import certificate_of, printed_in, theorems

NAME = "euler_zxz_intrinsic"
CHECKER = Path(checker.__file__)
BASIC = ("rotation_matrix", "angular_velocity_body", "rate_matrix_body")
FEWER = (*BASIC, "angular_velocity_space", "inverse_rate_matrix_space")
OTHERS = (
    *("quaternion", "gibbs_vector", "goldstein", "axis_angle", "unit_quaternion"),
    *("modified_rodrigues", "z(phi) x(theta) [0,b,c](psi)", "z(phi) [3,4,0](theta) x(pi/2)"),
    *("z(2*phi - psi) x(theta) z(psi)", "x(a_1) y(a_2) z(a_3) x(a_4)", "z(phi/2) x(theta)"),
    *("z(phi) x(alpha0)", "z(phi) [a,b,c](beta0)", "z(alpha0) x(phi - beta0)"),
)
VELOCITY = "angular_velocity_space"
NAMED = "z(y) x(by) y(is) z(in_body) x(exists2) z(transposed)"  # words of Coq and of Rotation.v
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


def test_conditions_that_are_no_spheres_have_no_certificate():
    certificate = certificate_of(record_of("direction_cosines", BASIC))
    assert certificate.claims == []
    assert f"Without a theorem here: {', '.join(BASIC)}. " in certificate.text
    _, reasons = checker.verify(record_of("direction_cosines", BASIC))
    assert "which gives no vector the length 1" in reasons["rate_matrix_body"]


def test_a_matrix_that_holds_rates_has_no_theorem():
    # W q̇ = Ω is true of it, but for the rates of one motion only
    changed = copy.deepcopy(record_of("ZXZ", BASIC))
    row = printed(changed, "rate_matrix_body")["expression"][2]
    row[0], row[1] = f"{row[0]} + theta_dot", f"{row[1]} - phi_dot"
    assert theorems(changed, BASIC).uncovered == ["rate_matrix_body"]


@pytest.mark.parametrize("text", ["rotation_vector", "z(phi) x(pi/4)", "z(phi/3) x(theta)"])
def test_roots_and_other_parts_of_angles_have_no_certificate(text):
    assert certificate_of(record_of(text, BASIC[:1])).uncovered == ["rotation_matrix"]


@pytest.mark.parametrize(
    ("one", "two", "is_true"),
    [
        ("cos(2*phi)", "1 - 2*sin(phi)**2", True),
        ("sin(phi - 2*theta)", "sin(phi)*cos(2*theta) - cos(phi)*sin(2*theta)", True),
        ("tan(phi)*cot(phi)", "1", True),
        ("sin(1)**2 + cos(theta + 1)**2", "1 - cos(1)**2 + cos(1 + theta)**2", True),
        ("cos(2*phi)", "1 - sin(phi)**2", False),
        ("cos(theta + 1)", "cos(theta)", False),
    ],
)
def test_sums_of_angles_are_exact(one, two, is_true):
    changed = copy.deepcopy(record_of("ZXZ", BASIC))
    row = printed(changed, "rotation_matrix")["expression"][0]
    row[0] = f"{row[0]} + {one} - ({two})"
    if is_true:
        assert checker.verify(changed)[1] == {}
    else:
        with pytest.raises(checker.Refused, match="rotation_matrix: entry 1, 1 is false"):
            checker.verify(changed)
        with pytest.raises(CheckError, match=rf"{NAME}: no certificate, since rotation_matrix"):
            certificate_of(changed)


UNCOVERED = {"whole top": ["effective_potential"]}


@pytest.mark.parametrize("name", NEEDS)
def test_bodies_and_their_motions_are_proved(name):
    proved, reasons = checker.verify(of_motion(name))
    assert {*reasons} == {*UNCOVERED.get(name, ())}
    assert {*proved} == {"R is a rotation", *printed_in(of_motion(name))} - {*reasons}
    if name == "whole top":
        assert {"constant energy", "constant momentum_phi", "constant momentum_psi"} < {*proved}


def test_accelerations_without_the_lagrangian_have_no_theorem():
    motion = of_top(*BASIC[:2], "accelerations")
    certificate = certificate_of(plain(record(motion, {})))
    assert "accelerations" in certificate.uncovered
    assert certificate.claims == [*BASIC[:2]]


def test_rates_have_a_theorem_without_their_matrix():
    only = ("rates_from_angular_velocity_body",)
    assert certificate_of(record_of("ZXZ", only)).claims == [*only]


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"rotation": None}, "a key is missing, or of another type: AttributeError"),
        ({"presentation": "Passive"}, "KeyError('Passive')"),
        ({"definitions": [{"name": "a"}]}, "KeyError('expression')"),
        ({"rotation_matrix": []}, "neither a vector nor the rows of a matrix"),
        ({"rotation_matrix": [["phi // 1"]]}, "the expression 'phi // 1' cannot be read"),
        ({"rotation_matrix": [["whole"]]}, "the name 'whole' is unknown here"),
        ({"angular_velocity_body": ["0"] * 3}, "angular_velocity_body: entry 1 is false"),
        ({"rate_matrix_body": [["0"] * 3] * 3}, "rate_matrix_body: equation 1 is false"),
    ],
)
def test_a_message_says_what_is_wrong(change, fault):
    changed = copy.deepcopy(record_of("ZXZ", BASIC))
    for name, value in change.items():
        if name in BASIC:
            printed(changed, name)["expression"] = value
        else:
            changed[name] = value
    with pytest.raises(checker.BROKEN) as error:
        checker.verify(changed)
    assert fault in checker.reason(error.value)


def test_a_long_chain_is_not_checked_and_the_reason_is_plain():
    turns = [f"{'xyz'[k % 3]}(a{k})" for k in range(26)]
    of_chain = record_of("ZXZ", BASIC) | {"quantities": [], "arguments": []}
    of_chain["rotation"] = {"turns": turns, "conditions": []}
    assert checker.verify(of_chain) == ([], {"R is a rotation": "more than 25 turns"})


def test_names_that_are_not_plain_get_an_underscore():
    # Coq refused to call a derivative d beside the coordinate d
    text = certificate_of(record_of("z(d) x(by) z(phi_1)", BASIC)).text
    assert "Variables d_ by_ phi_1 : R -> R." in text
    assert "Variables d_dot by_dot_ phi_1_dot : R -> R." in text


def test_the_checker_needs_only_the_standard_library_and_no_binary_fractions():
    text = CHECKER.read_text(encoding="utf-8")
    nodes = [*ast.walk(ast.parse(text))]
    assert not any(isinstance(n, ast.Constant) and isinstance(n.value, float) for n in nodes)
    modules = {*re.findall(r"^ *(?:from|import) (\w+)", text, re.MULTILINE)}
    assert modules <= sys.stdlib_module_names


def test_the_files_are_written_and_checked(tmp_path):
    call("derive", "ZXZ", "--certificates", cwd=tmp_path)
    folder = tmp_path / "out" / NAME
    assert {f"{NAME}.v", "Rotation.v"} <= {file.name for file in folder.iterdir()}
    assert f"  proved in {NAME}.json: R is a" in call("check", "out", cwd=tmp_path).stdout
    alone = [sys.executable, "-I", "-S", str(CHECKER), "out"]
    done = subprocess.run(alone, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "R is {'turns': ['z(phi)', 'x(theta)', 'z(psi)']" in done.stdout
    assert "  proved: R is a rotation, rotation_matrix" in done.stdout
    (folder / "other.JSON").write_text("{}")
    (folder / "odd.json").write_text('{"schema": "rigidsym.derivation", "name": "\\ud800"}')
    edit(folder / RECORD, '"title": "', '"title": "My ')
    edited = call("check", "out", cwd=tmp_path, status=1).stdout
    assert f"  proved in {RECORD} as it was edited: R is a rotation" in edited
    edit(folder / RECORD, "-sin(phi)*sin(psi)", "sin(phi)*sin(psi)")
    done = subprocess.run(alone, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "REFUSED: rotation_matrix: entry 1, 1 is false" in done.stdout
    assert "other.JSON: skipped" in done.stdout
    (tmp_path / "empty").mkdir()
    for words, status in ((["none"], 1), (["out", "empty"], 2), ([], 2)):
        command = [*alone[:-1], *words]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stderr[:6]) == (status, "usage:" * (status == 2))


def test_a_record_of_which_nothing_is_proved_is_refused_and_its_path_is_one_line(folder, tmp_path):
    said = answered("check", str(folder.rename(tmp_path / "a\nproved: all")))[1]
    assert "a\\nproved: all" in said
    assert "a\nproved" not in said
    forged = tmp_path / "b\nproved: all.json"
    undecided = {"turns": ["z(phi)", "x(theta)", "z(psi)"], "conditions": ["1"]}
    forged.write_text(json.dumps(record_of("ZXZ", BASIC) | {"rotation": undecided}))
    alone = [sys.executable, "-I", "-S", str(CHECKER), str(forged)]
    done = subprocess.run(alone, capture_output=True, text=True, check=False)
    (line,) = done.stdout.splitlines()
    assert r"b\nproved: all.json: REFUSED: nothing is proved: a condition" in line
    assert done.returncode == 1


@pytest.mark.usefixtures("coq")
@pytest.mark.parametrize(
    ("text", "quantities"),
    [
        *((text, None) for text in ("ZXZ", "z(phi) x(phi+psi) z(psi)", "unit_quaternion")),
        *((OTHERS[8], BASIC), (OTHERS[10], BASIC), ("gibbs_vector", None)),
        *((text, None) for text in ("z(2*phi) x(phi)", "z(phi/2) x(alpha0) z(-phi)")),
        *(("z(derivable_pt_lim) x(SProp) z(v1)", BASIC), (NAMED, (*BASIC[:2], VELOCITY))),
    ],
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


@pytest.mark.usefixtures("coq")
def test_coq_accepts_a_chain_of_ten_turns_and_refuses_a_wrong_one(tmp_path):
    of_chain = copy.deepcopy(record_of(CHAIN))
    certificate = certificate_of(of_chain)
    assert certificate.uncovered == ["rate_matrix_body"]
    assert run_coq(tmp_path, certificate.text) == 0
    omega = printed(of_chain, "angular_velocity_body")["expression"]
    omega[:2] = omega[1::-1]
    assert run_coq(tmp_path, theorems(of_chain, certificate.claims).text) != 0


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
def test_coq_accepts_the_rates_of_a_passive_rotation_and_refuses_a_wrong_one(tmp_path):
    rates = ("angular_velocity_space", "angular_velocity_body", "rotation_rate", "spin_matrix")
    passive = record(rs.derive(rs.EulerAngles("ZXZ", passive=True), rates), {})
    certificate = certificate_of(plain(passive))
    assert certificate.uncovered == []
    assert run_coq(tmp_path, certificate.text) == 0
    wrong = certificate.text.replace("(cos (theta t))", "(sin (theta t))")
    assert wrong != certificate.text
    assert run_coq(tmp_path, wrong) != 0


@pytest.mark.usefixtures("coq")
def test_coq_accepts_a_heavy_symmetric_top_and_nothing_false_about_it(tmp_path):
    """Energies, L, p, M, h, q̈, Hamilton's function, Euler's equations and first integrals."""
    certificate = certificate_of(of_motion("whole top"))
    assert sorted(certificate.uncovered) == sorted(UNCOVERED["whole top"])
    assert run_coq(tmp_path, certificate.text) == 0
    integral = next(
        line for line in certificate.text.splitlines() if "constant_momentum_psi" in line
    )
    wrong = certificate.text.replace(
        integral, integral.replace("(cos (theta s))", "(sin (theta s))")
    )
    assert wrong != certificate.text
    assert run_coq(tmp_path, wrong) != 0


# Files of certificates beside a record

WRITTEN = "--only", "rotation_matrix,angular_velocity_body", "--certificates", "--quiet"


def answered(*words: str) -> tuple[int, str]:
    done = CliRunner().invoke(commands, words, catch_exceptions=False)
    return done.exit_code, done.output


@pytest.fixture(scope="module")
def certified(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("certified")
    assert answered("derive", "ZXZ", *WRITTEN, "--out", str(out))[0] == 0
    return out


@pytest.fixture
def folder(certified, tmp_path) -> Path:
    return shutil.copytree(certified, tmp_path / "out") / NAME


def problems(out: Path) -> dict[str, str]:
    """What `check` says of each file that is not as derived."""
    status, said = answered("check", str(out))
    lines = (line.split(": ", 1) for line in said.splitlines() if line.startswith(str(out)))
    found = {Path(name).name: finding for name, finding in lines if finding != "up to date"}
    assert status == bool(found)
    return found


def edit(path: Path, before: str, after: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after, 1), encoding="utf-8")


COQ, RECORD = f"{NAME}.v", f"{NAME}.json"
STRANGE = dict.fromkeys((COQ, "Rotation.v"), "belongs to no record here")


@pytest.mark.parametrize(
    ("name", "before", "after", "expected"),
    [
        (COQ, "", "", {}),
        (
            *(RECORD, "cos(phi)*cos(psi)", "sin(phi)*cos(psi)"),
            {
                COQ: f"{RECORD} is refused: rotation_matrix: entry 1, 1 is false",
                RECORD: "differs from the derivation",
            },
        ),
        (COQ, "Qed.", "Admitted.", {COQ: "differs from the derivation"}),
        (COQ, None, "", {COQ: "missing"}),
        (RECORD, '"title"', "{", {RECORD: "cannot be read as the record", **STRANGE}),
    ],
)
def test_a_damaged_or_missing_file_is_named(folder, name, before, after, expected):
    if before is None:
        (folder / name).unlink()
    else:
        edit(folder / name, before, after)
    found = problems(folder.parent)
    assert found.keys() == expected.keys()
    assert all(found[name].startswith(problem) for name, problem in expected.items())


def test_a_record_under_another_name_or_schema_is_named(folder):
    text = (folder / RECORD).read_text()
    (folder / "copy.json").write_text(text)
    expected = f"the record of {RECORD} under another name"
    assert problems(folder.parent)["copy.json"].startswith(expected)
    assert expected in answered("check", str(folder / "copy.json"))[1]
    other = folder.parent / "other" / "false.json"
    other.parent.mkdir()
    other.write_text(text.replace("rigidsym.derivation", "rigidsym.derivation "))
    (other.parent / "robot.json").write_text('{"rotation": 90}')
    (problem,) = problems(other.parent).values()  # a robot is no record
    assert problem.startswith("cannot be read as the record")
    alone = [sys.executable, "-I", "-S", str(CHECKER), str(folder / RECORD), str(other.parent)]
    done = subprocess.run(alone, capture_output=True, text=True, check=False)
    assert "false.json: REFUSED: the schema is not rigidsym.derivation" in done.stdout
    assert "robot.json: skipped" in done.stdout
    assert done.returncode == 1


def test_a_certificate_joins_what_is_derived_again(folder):
    only = WRITTEN[:2]
    answered("derive", "ZXZ", *only, "--target", "c", "--out", str(folder.parent))
    (folder / "Rotation.vo").write_text("")  # compiled
    assert problems(folder.parent) == {}
    (folder / "Rotation.vio").write_text("")  # which Coq would load instead
    assert problems(folder.parent) == {"Rotation.vio": "belongs to no record here"}
    (folder / "Rotation.vio").unlink()
    assert json.loads((folder / RECORD).read_text())["files"].keys() >= {COQ, "Rotation.v"}


@pytest.mark.parametrize("is_edited", [False, True])
def test_a_certificate_of_other_angles_leaves_unless_it_was_edited(folder, is_edited):
    if is_edited:
        edit(folder / COQ, "Qed.", "Admitted.")
    answered("derive", "ZXZ", "--angles", "a,b,c", "--quiet", "--out", str(folder.parent))
    assert (folder / COQ).exists() == is_edited
    (folder / "other.v").write_text("")  # theorems about something else
    strangers = {f"Reals.{end}" for end in ("vo", "vio", "vok", "vos")}
    for name in strangers:
        (folder / name).write_text("")  # and other real numbers
    (folder.parent / "cpu.v").write_text("")  # and Verilog
    assert {*problems(folder.parent)} == {"other.v", *strangers} | ({COQ} if is_edited else set())


@pytest.mark.parametrize("name", [f"{NAME}.copy.json", f"{NAME}.JSON", f"{NAME}.old.py"])
def test_a_file_that_no_record_derives_is_named_if_it_is_asked_for(folder, name):
    (folder / name).write_bytes((folder / RECORD).read_bytes())
    assert problems(folder / name) == {name: "belongs to no record here"}
    assert {*problems(folder.parent)} == ({name} - {f"{NAME}.old.py"})


def test_a_theorem_that_was_edited_is_not_overwritten(folder):
    edit(folder / COQ, "Qed.", "Admitted.")
    words = "derive", "ZXZ", *WRITTEN, "--out", str(folder.parent)
    done = CliRunner().invoke(commands, words)
    assert COQ in str(done.exception)
    assert answered(*words, "--force")[0] == 0
    assert problems(folder.parent) == {}


def test_a_derivation_file_asks_for_certificates(tmp_path):
    file = tmp_path / "a.toml"
    file.write_text(
        '[rotation]\nsequence = "ZXZ"\n[output]\nquantities = ["rotation_matrix"]\n'
        "certificates = true\n"
    )
    assert answered("run", str(file), "--quiet", "--out", str(tmp_path / "out"))[0] == 0
    assert problems(tmp_path / "out") == {}
    assert (tmp_path / "out" / "a" / "a.v").is_file()
