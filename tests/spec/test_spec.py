"""Derivation files: what they say, the shipped ones, and their form as plain data."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from textwrap import dedent

import pytest

from rigidsym.errors import SpecError
from rigidsym.models.library import rotation_from, rotation_given
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.pipeline import read_file, read_record, read_spec
from rigidsym.spec.derivation_spec import DerivationSpec
from rigidsym.system import resources

SHIPPED = Path(__file__).resolve().parents[2] / "derivations"


def read(text: str, name: str = "top") -> DerivationSpec:
    return read_spec(dedent(text), source="top.toml", name=name)


def test_a_full_file():
    spec = read(
        """
        title = "Ω of a ship"
        [rotation]
        sequence = "zyx"
        angles = ["ψ", "theta", "λ"]
        passive = true
        [output]
        quantities = ["angular_velocity_body", "rotation_matrix"]
        kernels = ["numpy", "c"]
        note = ["tex", "pdf"]
        style = "audit"
        conversions = true
        certificates = true
        derivatives = ["angular_velocity_body:q"]
        [output.c]
        lean = "float"
        """
    )
    assert spec == DerivationSpec(
        name="top",
        title="Ω of a ship",
        models=(EulerAngles("zyx", ("psi", "theta", "lambda"), passive=True),),
        quantities=("angular_velocity_body", "rotation_matrix"),
        kernels=("numpy", "c"),
        target_options={"c": {"lean": "float"}},
        note=("tex", "pdf"),
        style="audit",
        conversions=True,
        certificates=True,
        derivatives=("angular_velocity_body by q",),
    )
    assert read_record(spec.to_data()) == spec
    # a small file asks for everything
    small = DerivationSpec(name="top", models=(EulerAngles("ZXZ"),), note=("tex", "html"))
    assert read('[rotation]\nsequence = "ZXZ"') == small
    assert small.to_data() == {
        "name": "top",
        "title": None,
        "rotations": [{"sequence": "ZXZ", "angles": ["phi", "theta", "psi"], "passive": False}],
        "quantities": None,
        "kernels": ["numpy"],
        "note": ["tex", "html"],
    }


@pytest.mark.parametrize(
    ("sequence", "options"),
    [("quaternion", {"scalar_last": True}), ("z(phi) x(incline)", {"constants": ["incline"]})],
)
def test_a_rotation_has_the_options_of_its_kind(sequence, options):
    ((key, value),) = options.items()
    text = f'[rotation]\nsequence = "{sequence}"\n{key} = {json.dumps(value)}'
    assert read(text).models == (rotation_from(sequence, **options),)
    assert read(f'[rotation]\nsequence = "{sequence}"').models != read(text).models


def test_a_matrix_of_its_own_has_conditions_and_an_example():
    own = {"coordinates": ["c", "s"], "constraints": ["c**2 + s**2 - 1"], "passive": True}
    rows, example = [["c", "-s", "0"], ["s", "c", "0"], ["0", "0", "1"]], {"c": "3/5", "s": "4/5"}
    spec = read_record({"name": "own", "rotations": [{"matrix": rows, "example": example, **own}]})
    assert spec.models == (rotation_given(rows, name="own", example=example, **own),)
    assert spec.models[0].passive
    assert spec.models[0].constraints


def test_a_byte_order_mark_and_other_line_ends_do_no_harm():
    plain = '[rotation]\nsequence = "ZXZ"\n'
    assert read("\ufeff" + plain.replace("\n", "\r\n")) == read(plain)


def test_files_are_read_by_path_or_shipped_name():
    assert read_file("euler_zxz") == read_file(str(SHIPPED / "euler_zxz.toml"))


def test_a_file_comes_before_a_shipped_one_of_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("euler_zxz").write_text('[rotation]\nsequence = "xyz"', encoding="utf-8")
    assert read_file("euler_zxz").models == (EulerAngles("xyz"),)


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"\n\xff", "not UTF-8 text, at line 2"),
        (b"#" * 200_001, "cannot be read: it has more than 200000 bytes"),
    ],
)
def test_files_that_are_no_text(tmp_path, content, fault):
    file = tmp_path / "top.toml"
    file.write_bytes(content)
    with pytest.raises(SpecError) as caught:
        read_file(str(file))
    assert str(caught.value) == f"{file}: 1 fault, nothing written\n  {fault}"
    with pytest.raises(SpecError, match=r"cannot be read: Is a directory$"):
        read_file(str(tmp_path))
    with pytest.raises(SpecError, match=r"no shipped derivation .*; did you mean euler_zxz or"):
        read_file("euler_xzx")


@pytest.mark.parametrize("name", resources.names("derivations", ".toml"))
def test_shipped_files_are_good_and_explained(name):
    spec = read_file(name)
    assert spec.title
    assert (SHIPPED / f"{name}.toml").read_text(encoding="utf-8").startswith("# ")
    assert read_record(spec.to_data()) == spec


def test_a_specification_checks_itself():
    model = EulerAngles("ZXZ")
    with pytest.raises(SpecError) as caught:
        DerivationSpec(name="top", models=(model, replace(model, passive=True)))
    assert [str(fault) for fault in caught.value.faults] == [
        "models[1]: writes the folder euler_zxz_intrinsic, as entry 0 does",
    ]
    with pytest.raises(SpecError, match=r"name: numpy\.py would hide the Python module"):
        DerivationSpec(name="numpy", models=(model,))
    with pytest.raises(SpecError, match="models: expected at least one rotation"):
        DerivationSpec(name="top", models=())


def test_wrong_data_has_every_fault_at_once():
    rotations = [{"sequence": "ZZX"}, {"angles": None, "seqence": 1}]
    with pytest.raises(SpecError) as caught:
        read_record({"rotations": rotations, "note": 1, "nam": ""}, source="top.json")
    assert [str(fault) for fault in caught.value.faults] == [
        "nam: unknown key; did you mean name?",
        "name: missing; expected a text in quotes",
        'note: expected a list such as ["tex"], got the number 1',
        "rotations[0].sequence: 'ZZX' is not an Euler sequence: consecutive axes must differ: Z "
        "follows Z; did you mean ZYZ or ZYX?",
        "rotations[1].seqence: unknown key; did you mean sequence?",
        'rotations[1].sequence: missing; expected a sequence such as "ZXZ", or a list of sequences',
    ]
