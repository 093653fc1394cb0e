"""The [body] and [parameters] of a derivation file."""

from __future__ import annotations

import json
from runpy import run_path
from textwrap import dedent

import numpy as np
import pytest
import sympy as sp
import trimesh

from helpers.command import call
from rigidsym.errors import KernelError
from rigidsym.models.body import RigidBody
from rigidsym.pipeline import integrated, output_of
from rigidsym.spec.derivation_file import read_file, read_record, read_spec
from rigidsym.spec.derivation_spec import DerivationSpec

A, C, M = sp.symbols("A C M")


def read(text: str) -> DerivationSpec:
    """The specification in a text, with its body integrated."""
    return integrated(read_spec(dedent(text), source="top.toml", name="top"))


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
    assert read("[body]\nprincipal_moments = [1, 1, 2.5]\nallow = true").body is not None


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
    found = read(text).body
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
        output_of(read(text))
    assert list(output_of(read(f"{text}kernels = []")).files) == ["top.tex", "top.json"]


def test_a_tetrahedron_by_its_corners():
    corners = '[["0", "0", "0"], ["a", "0", "0"], ["0", "b", "0"], ["0", "0", "c"]]'
    body = body_in(f'[body]\nshape = "tetrahedron"\nmass = "m"\ncorners = {corners}')
    assert list(body.centre) == [letter / 4 for letter in sp.symbols("a b c")]
