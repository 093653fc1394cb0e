"""Derivation files: what they say, of bodies too, as plain data, and every fault; and junk."""

from __future__ import annotations

import json
from dataclasses import replace
from datetime import timedelta
from pathlib import Path
from runpy import run_path
from textwrap import dedent

import numpy as np
import pytest
import sympy as sp
import trimesh
from hypothesis import given, settings, strategies as st

from helpers.command import call, run
from rigidsym.errors import KernelError, SpecError
from rigidsym.models.body import RigidBody
from rigidsym.models.library import rotation_from, rotation_given
from rigidsym.models.parametrisations import EulerAngles
from rigidsym.pipeline import integrated, output_of
from rigidsym.spec.derivation_file import read_file, read_record, read_spec
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


def test_a_file_comes_before_a_shipped_one_of_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert read_file("euler_zxz") == read_file(str(SHIPPED / "euler_zxz.toml"))
    Path("euler_zxz").write_text('[rotation]\nsequence = "xyz"', encoding="utf-8")
    assert read_file("euler_zxz").models == (EulerAngles("xyz"),)


@pytest.mark.parametrize(
    ("content", "fault"),
    [
        (b"\n\xff", "not UTF-8 text, at line 2"),
        (b"#" * 100_000, "no derivation file is so long; expected less than 100000 bytes"),
        (b"a = " + b"[" * 990, "lists or tables nested too deeply to be read"),
        (b"\n#" + b"a" * 1000, "a line has 1001 characters; expected at most 1000"),
    ],
)
def test_files_that_are_no_text_or_too_large(tmp_path, content, fault):
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
        "rotation.sequence[1]: writes the folder euler_zxz_intrinsic, as entry 0 does"
    ]
    with pytest.raises(SpecError, match="'L' cannot name a body or its file"):
        read('[body]\nprincipal_moments = ["A", "B", "C"]\n', "L")
    with pytest.raises(SpecError, match="rotation: expected at least one"):
        DerivationSpec(name="top", models=())


def test_faulty_records_have_every_fault_at_once_and_name_no_files(answered):
    def answer(text: str) -> str:
        with pytest.raises(SpecError) as caught:
            read_record(json.loads(text), source="top.json")
        return str(caught.value)

    answered("spec/faulty_records.txt", answer)


def test_every_fault_is_named_with_its_path(answered):
    def answer(text: str) -> str:
        with pytest.raises(SpecError) as caught:
            integrated(read_spec(text, source="top.toml", name="top"))
        assert caught.value.exit_code == 3, text
        return str(caught.value)

    answered("spec/faults.txt", answer)


@pytest.mark.parametrize(
    ("name", "fault"),
    [
        ("My File", "expected lower-case .* digits and underscores, .*, got .My File."),
        ("lambda", "lambda is a reserved word of Python"),
        ("numpy", r"numpy\.py would hide the Python module of this name"),
    ],
)
def test_the_name_of_the_file_names_folder_and_module(name, fault):
    with pytest.raises(SpecError, match=fault):
        read('[rotation]\nsequence = "ZXZ"\n', name)


def test_large_files_are_refused_at_once():
    paths = "\n".join([".".join(["a"] * 450) + " = 1"] * 50)
    for text in (paths, "[[rotation]]\n" * 3000, "x = 0x" + "f" * 900, "sequence = 1e999"):
        with pytest.raises(SpecError):  # read to its end, it would take minutes
            read(text)


fields = st.sampled_from(
    ["title", "rotation", "sequence", "angles", "passive", "output", "note", "kernels", "body"]
)
json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(fields | st.text(), inner),
    max_leaves=8,
)
REQUESTED = ("title", "quantities", "note", "theory", "notation", "body", "style", "derivatives")
rotations = st.fixed_dictionaries({"sequence": st.just("ZXZ") | json_values}) | json_values


@settings(max_examples=20, deadline=timedelta(seconds=10))
@given(
    st.fixed_dictionaries(
        {"name": st.just("top"), "rotations": st.lists(rotations)},
        optional=dict.fromkeys(REQUESTED, json_values),
    )
    | json_values
)
def test_any_data_is_read_or_refused(data):
    """Any error but a SpecError goes through."""
    try:
        spec = read_record(data)
    except SpecError:
        return
    assert read_record(spec.to_data()) == spec


def test_a_record_that_is_hard_to_read_is_answered(tmp_path):
    path = tmp_path / "a.json"
    version = '{"schema": "rigidsym.derivation", "schema_version": ' + "9" * 5000 + "}"
    for content in ("[" * 100_000, version):
        path.write_text(content, encoding="utf-8")
        assert run("check", str(path)).returncode in (1, 2)  # any other error goes through


A, C, M = sp.symbols("A C M")


def test_a_symmetric_body_in_symbols():
    text = '[parameters]\nC = { about = "spin", unit = "kg m^2" }\n'
    body = body_in(text + '[body]\nprincipal_moments = ["A", "A", "C"]')
    assert (body.mass, body.inertia) == (M, sp.ImmutableMatrix(sp.diag(A, A, C)))
    assert body.title == "Symmetric body"
    assert [(str(p.symbol), p.about, p.unit) for p in body.parameters] == [
        ("M", "mass", "kg"),
        ("A", "principal moment of inertia", "kg m^2"),
        ("C", "spin", "kg m^2"),
    ]
    body_in("[body]\nprincipal_moments = [1, 1, 2.5]\nallow = true")


def test_numbers_with_a_point_are_values_of_parameters():
    body = body_in("[body]\nprincipal_moments = [1.5, 1.5, 2]\nmass = 3.25")
    assert body.inertia == sp.ImmutableMatrix(sp.diag(A, A, 2))
    assert {str(p.symbol): p.value for p in body.parameters} == {"M": 3.25, "A": 1.5}
    body = body_in('[body]\nshape = "sphere"\nradius = 0.5\ndensity = "rho"')
    assert {str(p.symbol): p.value for p in body.parameters} == {"a": 0.5, "rho": None}
    body = body_in('[body]\nprincipal_moments = [1.5, "A", 2.5]')  # A means something else here
    assert (body.in_numbers(body.inertia) - sp.diag(1.5, A, 2.5)).is_zero_matrix


BOX = trimesh.creation.box(extents=(1.0, 2.0, 3.0))
BRACKET = """
body.parts = [{ shape = "box", sides = [0.2, 0.1, 0.05], mass = 3.0 },
    { shape = "cylinder", radius = 0.02, height = 0.05, mass = 0.4, hole = true, at = [
        0.05, 0.0, 0], turned = "z(pi/4)" }]
"""


def body_in(text: str) -> RigidBody:
    found = integrated(read(text)).body
    assert found is not None
    return found


def test_particles_in_symbols():
    body = body_in(
        '[body]\nparticles = [{ mass = "m", at = ["a", 0, 0] }, { mass = "m", at = ["-a", 0, 0] }]'
    )
    assert body.inertia == sp.diag(0, *[2 * sp.Symbol("m") * sp.Symbol("a") ** 2] * 2)
    body = body_in("[body]\nparticles = [{ mass = 1.5, at = [0.5, 0, 0] }]")
    assert (body.mass, body.centre[0], body.parameters) == (sp.Rational(3, 2), sp.S.Half, ())


def test_parts_in_numbers_become_numbers():
    body = body_in('[body]\nshape = "cylinder"')
    assert body.inertia[2, 2] == M * sp.Symbol("a") ** 2 / 2
    meanings = {"M": "mass", "a": "radius", "h": "height"}
    assert {str(p.symbol): p.about for p in body.parameters} == meanings
    body = body_in('[body]\nparts = [{ shape = "sphere" }, { shape = "sphere" }]')
    assert {str(symbol) for symbol in body.inertia.free_symbols} == {"M_1", "a_1", "M_2", "a_2"}
    body = body_in(BRACKET)
    assert body.title == "Composite body"
    assert {str(symbol) for symbol in body.inertia.free_symbols} == {"I_11", "I_22", "I_33"}
    values = {str(p.symbol): p.value for p in body.parameters}
    assert values["M"] == 2.6
    assert values["x_C"] == pytest.approx(-0.4 * 0.05 / 2.6, rel=1e-14)


def test_a_part_is_turned_by_any_rotation():
    turned = '"z(pi/4) x(0) [0,0,1](pi/4)"'
    part = f'{{ shape = "box", sides = [1, 2, 3], mass = 12, turned = {turned} }}'
    assert body_in(f"[body]\nparts = [{part}]").inertia == sp.diag(10, 13, 5)


def test_one_command_from_a_file_to_energies_kernels_and_note(tmp_path):
    """I, principal axes, energies, kernels and note; and the record asks for the same again."""
    BOX.export(tmp_path / "box.stl")
    np.save(tmp_path / "cloud.npy", np.random.default_rng(3).uniform(0.5, 2, size=(50, 4)))
    (tmp_path / "mesh.toml").write_text('[body]\nmesh = "box.stl"\ndensity = 2.0\n')
    parts = '[body]\nparts = [{ mesh = "box.stl", mass = 6.0 }, { particles = "cloud.npy" }]\n'
    (tmp_path / "both.toml").write_text(parts)
    shown = call("run", str(tmp_path / "both.toml"), cwd=tmp_path).stdout
    assert "principal moment " in shown
    assert "unproved" not in shown
    made = tmp_path / "out" / "both"
    record = json.loads((made / "both.json").read_text(encoding="utf-8"))
    assert record["is_proved"]
    assert str(tmp_path) not in json.dumps(record)
    names = {quantity["name"] for quantity in record["quantities"]}
    assert {"inertia_tensor", "kinetic_energy", "angular_momentum"} <= names
    assert "Principal moments" in (made / "both.html").read_text(encoding="utf-8")
    values = [p["value"] for p in record["body"]["parameters"]]
    tensor = run_path(str(made / "both.py"))["inertia_tensor"](values)
    assert np.allclose(tensor, record["body"]["in_numbers"]["inertia_tensor"], rtol=1e-13)
    body = integrated(read_file(str(tmp_path / "mesh.toml"))).body
    assert np.allclose(np.array(body.in_numbers(body.inertia), float), 2 * BOX.moment_inertia)
    again = integrated(read_record(record["request"])).body
    assert again is not None
    assert [p.value for p in again.parameters] == pytest.approx(values, rel=1e-14)


def test_what_depends_on_nothing_has_no_function():
    output = '\n[output]\nnote = ["tex"]\nquantities = ["inertia_tensor"]\n'
    text = f"[body]\nprincipal_moments = [1, 1, 2]\nmass = 2{output}"
    with pytest.raises(KernelError, match=r"top: no function to write.*: inertia_tensor; expected"):
        output_of(integrated(read(text)))
    assert list(output_of(integrated(read(f"{text}kernels = []"))).files) == ["top.tex", "top.json"]


def test_a_tetrahedron_by_its_corners():
    corners = '[["0", "0", "0"], ["a", "0", "0"], ["0", "b", "0"], ["0", "0", "c"]]'
    body = body_in(f'[body]\nshape = "tetrahedron"\nmass = "m"\ncorners = {corners}')
    assert list(body.centre) == [letter / 4 for letter in sp.symbols("a b c")]
