"""Wrong derivation files: every fault at once, with its path; and junk."""

from __future__ import annotations

from datetime import timedelta
from pathlib import Path
from textwrap import dedent

import click
import pytest
from click.testing import CliRunner
from hypothesis import example, given, settings, strategies as st

from rigidsym.commands.cli import commands
from rigidsym.errors import RigidsymError, SpecError
from rigidsym.pipeline import integrated, read_file, read_record, read_spec
from rigidsym.spec.derivation_spec import DerivationSpec


def read(text: str, name: str = "top") -> DerivationSpec:
    return read_spec(dedent(text), source="top.toml", name=name)


def faults(text: str, name: str = "top") -> list[str]:
    with pytest.raises(SpecError) as caught:
        read(text, name)
    return [str(fault) for fault in caught.value.faults]


ZXZ = '[rotation]\nsequence = "ZXZ"\n'


def test_every_fault_is_named_with_its_path(answered):
    def answer(text: str) -> str:
        with pytest.raises(SpecError) as caught:
            integrated(read_spec(text, source="top.toml", name="top"))
        assert caught.value.exit_code == 3, text
        return str(caught.value)

    answered("spec/faults.txt", answer)


def test_a_file_has_bounds():
    for text, fault in (
        ("a = " + "[" * 990, "lists or tables nested too deeply to be read"),
        ("\n#" + "a" * 1000, "line 2 has 1001 characters; expected at most 1000"),
        (
            "\n" * 50_001,
            "a file of 50001 characters, which is no derivation file; expected at most 50000",
        ),
    ):
        assert faults(text) == [fault]


A_NAME = "expected a lower-case letter, then lower-case letters, digits or underscores, got "


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("My File", f'{A_NAME}"My File"'),
        ("lambda", "lambda is a reserved word of Python"),
        ("numpy", "numpy.py would hide the Python module of this name"),
    ],
)  # fmt: skip
def test_the_name_of_the_file_names_folder_and_module(name, fault):
    assert faults(ZXZ, name) == [f"the file name is the name of the derivation: {fault}"]


def test_large_files_are_refused_at_once():
    for text in ("\n".join([".".join(["a"] * 450) + " = 1"] * 50), "[[rotation]]\n" * 3000):
        assert faults(text)  # read to its end, it would take minutes


def is_read_or_refused(read_it, *arguments) -> None:
    """Any error but a SpecError goes through."""
    try:
        spec = read_it(*arguments)
    except SpecError:
        return
    assert read_record(spec.to_data()) == spec


fields = st.sampled_from(
    ["title", "rotation", "sequence", "angles", "passive", "output", "note", "kernels", "body"]
)
toml_values = st.recursive(
    st.sampled_from(["1", "true", "-nan", "07:32:00", '"ZXZ"', '"zyx"', '"tex"', '"φ"', '"numpy"'])
    | st.text(alphabet="xyz(abφ)* ^\u202e", max_size=20).map('"{}"'.format),
    lambda inner: (
        st.lists(inner, max_size=4).map(lambda parts: f"[{', '.join(parts)}]")
        | st.tuples(fields, inner).map(lambda pair: "{{ {} = {} }}".format(*pair))
    ),
    max_leaves=5,
)
lines = st.one_of(
    st.tuples(fields, toml_values).map(" = ".join),
    st.tuples(fields, fields, toml_values).map(lambda t: "{}.{} = {}".format(*t)),
    st.sampled_from(["[rotation]", "[output]", "[body]", "[[rotation]]", 'sequence = "ZXZ"']),
)


@settings(max_examples=50, deadline=timedelta(seconds=10))
@given(st.lists(lines, max_size=8).map("\n".join) | st.text(max_size=80))
@example("x = 0x" + "f" * 900)
@example("[rotation]\nsequence = 1e999")
def test_any_text_is_read_or_refused(text):
    is_read_or_refused(read, text)


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(fields | st.text(), inner),
    max_leaves=8,
)


REQUESTED = ("title", "quantities", "note", "theory", "notation", "body", "style", "derivatives")
rotations = st.fixed_dictionaries({"sequence": st.just("ZXZ") | json_values}) | json_values


@settings(max_examples=50, deadline=timedelta(seconds=10))
@given(
    st.fixed_dictionaries(
        {"name": st.just("top"), "rotations": st.lists(rotations)},
        optional=dict.fromkeys(REQUESTED, json_values),
    )
    | json_values
)
def test_any_data_is_read_or_refused(data):
    is_read_or_refused(read_record, data)


def is_answered(path: Path, content: str) -> None:
    path.write_text(content, encoding="utf-8")
    error = CliRunner().invoke(commands, ["check", str(path)]).exception
    assert error is None or isinstance(error, RigidsymError | SystemExit | click.ClickException)


def test_a_record_that_is_hard_to_read_is_answered(tmp_path):
    version = '{"schema": "rigidsym.derivation", "schema_version": ' + "9" * 5000 + "}"
    for content in ("[" * 100_000, version):
        is_answered(tmp_path / "a.json", content)


def test_a_record_names_no_files():
    request = {"name": "a", "rotations": [{"sequence": "ZXZ"}]}
    with pytest.raises(SpecError) as caught:
        read_record({**request, "body": {"particles": "/etc/passwd"}})
    assert "body.particles: expected numbers: a record names no files" in str(caught.value)


def test_a_file_elsewhere_is_not_quoted(tmp_path):
    secret = tmp_path / "secret.csv"
    secret.write_text("root:x:0:0:very secret\n")
    file = tmp_path / "inside" / "top.toml"
    file.parent.mkdir()
    for path in (secret, "../secret.csv", "..", "/dev/null", "../none"):
        file.write_text(f'[body]\nparticles = "{path}"\n')
        with pytest.raises(SpecError) as caught:
            read_file(str(file))
        assert [str(f) for f in caught.value.faults] == [
            "body.particles: no body can be read from this file"
        ]
    file.write_text('[body]\nmesh = "none.stl"\ndensity = 1.0\n')
    with pytest.raises(SpecError, match=r"none\.stl: no such"):
        read_file(str(file))
