"""The folder of a derivation: its record speaks for what every run has left there."""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path

import pytest

from helpers.command import call, run
from rigidsym.system.files import whole_file

NAME = "euler_zxz_intrinsic"
ONLY = "--only", "rotation_matrix"


def _run(*arguments: str) -> str:
    return call(*arguments, cwd=Path.cwd()).stderr


def _checked(out: Path) -> set[str]:
    """The files that `check` finds up to date."""
    lines = [line.partition(": ") for line in run("check", str(out)).stdout.splitlines()]
    return {Path(name).name for name, _, finding in lines if finding == "up to date"}


def _files(out: Path) -> set[str]:
    return {path.name for path in (out / NAME).iterdir()}


def test_another_target_or_page_joins_what_is_there(tmp_path):
    for words in (("derive", "ZXZ"), ("derive", "ZXZ", "--target", "c"), ("page", "ZXZ")):
        assert _run(*words, "--out", str(tmp_path)) == ""
        assert _checked(tmp_path) == _files(tmp_path)
    assert {f"{NAME}.py", f"{NAME}.c", f"{NAME}_page.html"} < _files(tmp_path)


def test_another_rotation_replaces_what_was_printed_but_not_what_was_edited(tmp_path):
    out = *ONLY, "--out", str(tmp_path)
    each = "--target", "numpy", "--target", "javascript"  # as "numpy,javascript"
    _run("derive", "ZXZ", *each, "--certificates", *out)
    edited = tmp_path / NAME / f"{NAME}.d.mts"
    edited.write_text(edited.read_text() + "// mine")
    said = _run("derive", "ZXZ", "--angles", "a,b,c", *out)
    assert said == (
        f"rigidsym: replacing {tmp_path / NAME}, which held another rotation (use --out to keep "
        "both)\n"
    )
    assert _checked(tmp_path) == {f"{NAME}.{e}" for e in ("py", "tex", "html", "json")}
    assert _files(tmp_path) == _checked(tmp_path) | {edited.name}
    assert _run("derive", "ZXZ", "--angles", "a,b,c", "--conversions", *out) == ""


def test_a_record_of_a_stranger_removes_nothing_elsewhere(tmp_path):
    outside = tmp_path / "precious.txt"
    outside.write_text("mine")
    out = *ONLY, "--out", str(tmp_path / "out")
    _run("derive", "ZXZ", *out)
    record = tmp_path / "out" / NAME / f"{NAME}.json"
    content = json.loads(record.read_text())
    for name in ("../../precious.txt", str(outside)):
        content["files"][name] = sha256(b"mine").hexdigest()
    record.write_text(json.dumps(content))
    _run("derive", "ZXZ", "--angles", "a,b,c", *out)
    assert outside.read_text() == "mine"


def test_what_is_refused_or_would_lose_an_edit_writes_over_nothing(tmp_path):
    out = "--out", str(tmp_path)
    _run("derive", "ZXZ", *out)
    wrong = "--angles", "a,b,c", "--derivative", "angular_velocity_body:z"
    before = (tmp_path / NAME / f"{NAME}.json").read_bytes()
    assert "replacing" not in call("derive", "ZXZ", *wrong, *out, cwd=tmp_path, status=2).stderr
    assert (tmp_path / NAME / f"{NAME}.json").read_bytes() == before
    module = tmp_path / NAME / f"{NAME}.py"
    before = {path: path.read_bytes() for path in (tmp_path / NAME).iterdir()} | {
        module: module.read_bytes() + b"# mine\n"
    }
    module.write_bytes(before[module])
    for words in (("derive", "ZXZ"), ("derive", "ZXZ", "--angles", "a,b,c"), ("page", "ZXZ")):
        done = call(*words, *out, cwd=tmp_path, status=1)
        assert done.stderr.startswith(f"rigidsym: {module} changed since it was generated")
        assert {path: path.read_bytes() for path in (tmp_path / NAME).iterdir()} == before
    _run("derive", "ZXZ", *out, "--force")
    assert b"# mine" not in module.read_bytes()
    _run("derive", "ZXZ", "--angles", "a,b,c", *out)  # nothing is edited now
    assert _checked(tmp_path) == _files(tmp_path)


def test_a_damaged_record_is_named_and_keeps_no_other_from_being_checked(tmp_path):
    for rotation in ("xyz", "ZXZ"):
        _run("derive", rotation, *ONLY, "--out", str(tmp_path))
    record = tmp_path / "euler_xyz_extrinsic" / "euler_xyz_extrinsic.json"
    content = json.loads(record.read_text())
    content["request"] = {"rotation": {"sequence": 1}}
    record.write_text(json.dumps(content))
    half = tmp_path / "half.json"
    half.write_text('{"schema":\n')
    (tmp_path / "old.json").write_text(json.dumps(content | {"schema_version": 1}))
    printed = call("check", str(tmp_path), str(half), cwd=tmp_path, status=1).stdout
    assert "old.json: its schema version is 1, expected 2; derive it again" in printed
    assert f"{record}: its request cannot be derived: " in printed
    assert f"{half}: cannot be read as the record of a derivation" in printed
    assert f"{NAME}.py: up to date" in printed


def test_an_error_of_writing_names_the_file_and_not_its_draft(tmp_path):
    path = tmp_path / ("a" * 249)  # for which there is room, but not for the name of a draft
    with pytest.raises(OSError, match=r"too long") as caught, whole_file(path):
        pass
    assert caught.value.filename == str(path)
