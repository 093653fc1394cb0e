"""`rigidsym check` names what became of certificates beside a record."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner

from rigidsym.commands.cli import commands

NAME = "euler_{}_intrinsic"
ZXZ, ZYX = NAME.format("zxz"), NAME.format("zyx")
WRITTEN = "--only", "rotation_matrix,angular_velocity_body", "--certificates", "--quiet"


def run(*words: str) -> tuple[int, str]:
    done = CliRunner().invoke(commands, words, catch_exceptions=False)
    return done.exit_code, done.output


@pytest.fixture(scope="module")
def certified(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("certified")
    for rotation in ("ZXZ", "ZYX"):
        assert run("derive", rotation, *WRITTEN, "--out", str(out))[0] == 0
    return out


@pytest.fixture
def folder(certified, tmp_path) -> Path:
    return shutil.copytree(certified, tmp_path / "out") / ZXZ


def problems(out: Path) -> dict[str, str]:
    """What `check` says of each file that is not as derived."""
    status, said = run("check", str(out))
    lines = (line.split(": ", 1) for line in said.splitlines() if line.startswith(str(out)))
    found = {Path(name).name: finding for name, finding in lines if finding != "up to date"}
    assert status == bool(found)
    return found


def edited(name: str, before: str, after: str) -> Callable[[Path], None]:
    def edit(folder: Path) -> None:
        text = (folder / name).read_text(encoding="utf-8")
        assert before in text
        (folder / name).write_text(text.replace(before, after, 1), encoding="utf-8")

    return edit


def exchanged(ending: str) -> Callable[[Path], None]:
    def exchange(folder: Path) -> None:
        shutil.copy(folder.parent / ZYX / f"{ZYX}.{ending}", folder / f"{ZXZ}.{ending}")

    return exchange


def removed(*names: str) -> Callable[[Path], None]:
    def remove(folder: Path) -> None:
        for name in names:
            (folder / name).unlink()

    return remove


COQ, RECORD = f"{ZXZ}.v", f"{ZXZ}.json"


@pytest.mark.parametrize(
    ("damage", "expected"),
    [
        (lambda _: None, {}),
        (
            edited(RECORD, "cos(phi)*cos(psi)", "sin(phi)*cos(psi)"),
            {
                COQ: f"{RECORD} is refused: rotation_matrix: entry 1 is false",
                RECORD: "differs from the derivation",
            },
        ),
        (edited(COQ, "Qed.", "Admitted."), {COQ: "differs from the derivation at line"}),
        (removed(COQ), {COQ: "missing"}),
        (exchanged("v"), {COQ: "differs from the derivation at line 1"}),
        (
            lambda folder: (folder / RECORD).write_text("{"),
            {RECORD: "cannot be read as the record"},
        ),
        (
            lambda folder: (folder / RECORD).write_text(""),
            {RECORD: "cannot be read as the record"},
        ),
    ],
)
def test_a_damaged_exchanged_or_missing_file_is_named(folder, damage, expected):
    damage(folder)
    found = problems(folder.parent)
    assert found.keys() == expected.keys()
    assert all(found[name].startswith(problem) for name, problem in expected.items())


def test_a_certificate_joins_what_is_derived_again(folder):
    only = WRITTEN[:2]
    run("derive", "ZXZ", *only, "--target", "c", "--out", str(folder.parent))
    assert problems(folder.parent) == {}
    assert json.loads((folder / RECORD).read_text())["files"].keys() >= {COQ, "Rotation.v"}


@pytest.mark.parametrize("is_edited", [False, True])
def test_a_certificate_of_other_angles_leaves_unless_it_was_edited(folder, is_edited):
    if is_edited:
        edited(COQ, "Qed.", "Admitted.")(folder)
    run("derive", "ZXZ", "--angles", "a,b,c", "--quiet", "--out", str(folder.parent))
    assert (folder / COQ).exists() == is_edited
    unknown = {COQ: f"unknown to {RECORD}: derive again with --certificates"}
    assert problems(folder.parent) == (unknown if is_edited else {})


def test_a_theorem_that_was_edited_is_not_overwritten(folder):
    edited(COQ, "Qed.", "Admitted.")(folder)
    words = "derive", "ZXZ", *WRITTEN, "--out", str(folder.parent)
    done = CliRunner().invoke(commands, words)
    assert done.exit_code != 0
    assert COQ in str(done.exception)
    assert run(*words, "--force")[0] == 0
    assert problems(folder.parent) == {}


def test_a_derivation_file_asks_for_certificates(tmp_path):
    file = tmp_path / "a.toml"
    file.write_text(
        '[rotation]\nsequence = "ZXZ"\n[output]\nquantities = ["rotation_matrix"]\n'
        "certificates = true\n"
    )
    assert run("run", str(file), "--quiet", "--out", str(tmp_path / "out"))[0] == 0
    assert problems(tmp_path / "out") == {}
    assert (tmp_path / "out" / "a" / "a.v").is_file()
