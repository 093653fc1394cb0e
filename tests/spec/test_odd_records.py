"""Records and files of strangers: every odd one is answered with a message, never a traceback."""

from __future__ import annotations

import copy
import json
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from rigidsym.commands.cli import commands
from rigidsym.errors import RigidsymError, SpecError
from rigidsym.pipeline import integrated, output_of, read_file, read_record, read_spec

ODD = [None, True, -1, 1e999, 10**30, "", "\x00", [], {}, [[]], [["numpy"]], {"numpy": 1}, [None]]
KEYS = ("name", "rotations", "quantities", "kernels", "note", "theory", "notation", "body")


@pytest.fixture(scope="module")
def record() -> dict:
    spec = read_spec('[rotation]\nsequence = "ZXZ"\n', source="a.toml", name="a")
    return json.loads(output_of(spec).record_text)


def is_answered(path: Path, content: str) -> None:
    path.write_text(content, encoding="utf-8")
    error = CliRunner().invoke(commands, ["check", str(path)]).exception
    assert error is None or isinstance(error, RigidsymError | SystemExit | click.ClickException)


@pytest.mark.parametrize("key", KEYS)
def test_a_record_with_an_odd_request_is_answered(tmp_path, record, key):
    for value in ODD:
        changed = copy.deepcopy(record)
        changed["request"][key] = value
        is_answered(tmp_path / "a.json", json.dumps(changed))


@pytest.mark.parametrize("key", ["sequence", "angles", "passive", "constants", "matrix"])
def test_a_record_with_an_odd_rotation_is_answered(tmp_path, record, key):
    for value in ODD:
        changed = copy.deepcopy(record)
        changed["request"]["rotations"][0][key] = value
        is_answered(tmp_path / "a.json", json.dumps(changed))


def test_a_record_of_two_rotations_is_refused(tmp_path, record):
    record["request"]["rotations"] = [{"sequence": "ZXZ"}, {"sequence": "ZYZ"}]
    is_answered(tmp_path / "a.json", json.dumps(record))


@pytest.mark.parametrize(
    "content",
    [
        '{"a":' * 3000 + "1" + "}" * 3000,
        "[" * 100_000,
        '{"schema": "rigidsym.derivation", "schema_version": ' + "9" * 5000 + "}",
    ],
    ids=["deep", "open", "long number"],
)
def test_a_record_that_is_hard_to_read_is_answered(tmp_path, content):
    is_answered(tmp_path / "a.json", content)


def test_a_record_names_no_files():
    request = {"name": "a", "rotations": [{"sequence": "ZXZ"}]}
    with pytest.raises(SpecError) as caught:
        read_record({**request, "body": {"particles": "/etc/passwd"}})
    assert "body.particles: expected numbers: a record names no files" in str(caught.value)


@pytest.mark.parametrize("key", ["particles", "mesh"])
def test_a_file_elsewhere_is_described_and_not_quoted(tmp_path, key):
    secret = tmp_path / "secret.csv"
    secret.write_text("root:x:0:0:very secret\n")
    (tmp_path / "inside").mkdir()
    file = tmp_path / "inside" / "top.toml"
    more = "density = 1.0\n" if key == "mesh" else ""
    for path in (secret, "../secret.csv"):
        file.write_text(f'[body]\n{key} = "{path}"\n{more}')
        with pytest.raises(SpecError) as caught:
            read_file(str(file))
        assert f"body.{key}: expected a file with a body, got a file of 23 bytes" in str(
            caught.value
        )
        assert "very secret" not in str(caught.value)


def test_an_impossible_body_is_reported_with_its_line():
    text = '[[body.parts]]\nshape = "sphere"\n[[body.parts]]\nshape = "sphere"\nhole = true\n'
    text += "mass = 2.0\n[output]\nnote = []\n"
    spec = read_spec(text.replace('"sphere"\n[[', '"sphere"\nmass = 1.0\n[['), source="a", name="a")
    with pytest.raises(SpecError, match=r"body\.parts: .*the mass is -1 kg"):
        integrated(spec)


def test_reading_integrates_nothing():
    spec = read_file("composite_body")
    assert not hasattr(spec.body, "inertia")
    assert hasattr(integrated(spec).body, "inertia")
