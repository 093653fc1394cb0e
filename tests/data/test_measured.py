"""Units in headers; clouds and meshes in numbers, against 50 digits and trimesh; broken files."""

from __future__ import annotations

import doctest
import importlib
from itertools import product
from math import pi
from pathlib import Path

import mpmath
import numpy as np
import polars as pl
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.command import call
from rigidsym.data.columns import ColumnNames, conversion, is_unit, names_for, unit_of
from rigidsym.data.mass import inertia_of, mesh_inertia, principal_axes_of, read_mesh_file
from rigidsym.errors import BodyError, DataError, MissingExtra, RigidsymError
from rigidsym.tools.evaluate import evaluate
from rigidsym.tools.identify.identification import identify_file

EPS = np.finfo(float).eps


def rows(count: int = 500, *, far: float = 0.0, size: float = 1.0, seed: int = 4) -> np.ndarray:
    """m, x, y, z of particles; `far` from the origin."""
    random = np.random.default_rng(seed)
    places = random.normal(size=(count, 3)) * size * (1.0, 2.0, 0.5) + (far, -far, 2 * far)
    return np.column_stack([random.uniform(0.1, 2, count), places])


def exactly(table: np.ndarray) -> tuple[mpmath.mpf, np.ndarray, np.ndarray]:
    """Mass, centre and inertia tensor with 50 digits, by the sums of the lecture."""
    with mpmath.workdps(50):
        m, *x = (np.array([mpmath.mpf(float(v)) for v in column]) for column in table.T)
        mass = sum(m)
        centre = np.array([sum(m * axis) / mass for axis in x])
        x = [axis - c for axis, c in zip(x, centre, strict=True)]
        square = sum(axis * axis for axis in x)
        inertia = np.array(
            [[sum(m * ((i == j) * square - x[i] * x[j])) for j in range(3)] for i in range(3)]
        )
    return mass, centre, inertia


@pytest.mark.parametrize(
    "table",
    [
        rows(far=1e12),  # where the centre of mass is rounded to 0.1 mm
        np.vstack([[1e-3, 0, 0, 0], rows(far=1e9)]),  # the first particle is an outlier
    ],
    ids=["far", "outlier first"],
)
def test_a_cloud_loses_nothing_that_the_data_hold(table):
    mass, centre, inertia = exactly(table)
    found = inertia_of(table)
    # A sum of n terms, in any order, is off by at most n eps of the sum of their sizes, and few
    # operations come on top. About the origin it would be eps far²/size².
    bound = (len(table) + 32) * EPS
    size = float(np.abs(table[:, 1:] - np.median(table[:, 1:], axis=0)).max())
    assert abs(found.mass - mass) <= bound * float(mass)
    half = np.spacing(np.abs(found.centre)) / 2  # the centre is correctly rounded
    assert (abs(found.centre - centre) <= half + bound * size).all()
    assert max(abs((found.inertia - inertia).ravel())) <= bound * float(max(abs(inertia.ravel())))


def test_columns_by_name_in_every_format(tmp_path):
    table = rows(30)
    mixed, names = table[:, [3, 0, 2, 1]], ["z", "mass", "y", "x"]
    np.save(tmp_path / "plain.npy", mixed)
    np.save(
        tmp_path / "named.npy", np.rec.fromarrays(mixed.T, names=",".join(names)).view(np.ndarray)
    )
    np.savetxt(tmp_path / "cloud.csv", mixed, delimiter=",", header=",".join(names), fmt="%.17g")
    columns = {n: mixed[:, k] for k, n in enumerate(names)}
    frame = pl.DataFrame(columns | {"name": ["ball"] * 30})
    frame.write_parquet(tmp_path / "cloud.parquet")
    expected = inertia_of(table).inertia
    for named in (np.rec.fromarrays(mixed.T, names=",".join(names)), frame, columns):
        assert (inertia_of(named).inertia == expected).all(), type(named)
    assert (inertia_of(tmp_path / "plain.npy", columns=names).inertia == expected).all()
    for file in ("named.npy", "cloud.csv", "cloud.parquet"):
        assert (inertia_of(tmp_path / file).inertia == expected).all(), file
    np.savez(tmp_path / "several.npz", table, mixed)
    with pytest.raises(BodyError, match=r"npy: an NPZ archive of arrays; expected one array"):
        inertia_of((tmp_path / "several.npz").rename(tmp_path / "several.npy"))


def test_units_are_converted_and_a_negative_mass_may_be_allowed(tmp_path):
    (tmp_path / "cloud.csv").write_text("x [mm],y [mm],z [mm],mass [g]\n0,0,0,-500\n2e3,0,0,1e3\n")
    found = inertia_of(tmp_path / "cloud.csv", allow=True)
    np.testing.assert_allclose([found.mass, found.centre[0]], [0.5, 4.0], rtol=1e-15)
    assert "-0" not in repr(found).replace("-0.", "")


@pytest.mark.parametrize(
    ("cloud", "fault"),
    [
        (np.vstack([rows(7), [np.inf, 0, 0, 0]]), r"row 8: expected finite numbers"),
        (rows(20) * (0, 1, 1, 1), r"the total mass is 0 kg; expected a positive mass"),
        (rows(20)[:0], r"expected at least one particle, got none"),
        (rows(20) * (1, 1e200, 1, 1), r"too large for double precision"),
        (rows(20).ravel(), r"expected numbers of shape \(rows, columns\), got float64 of"),
        (np.zeros(2, [("m", float), ("x", float, 3)]), "column x has several numbers in a row"),
    ],
)
def test_what_is_no_cloud_is_described(cloud, fault):
    with pytest.raises(BodyError, match=fault):
        inertia_of(cloud)


@pytest.mark.parametrize(
    "inertia",
    [rows(3)[:, 1:] @ rows(3)[:, 1:].T + np.eye(3) * 9, np.eye(3) * 2, np.diag([1.0, 1.5, 1.0])],
)
def test_principal_axes_are_right_handed_and_diagonalise(inertia):
    found = principal_axes_of(inertia)
    assert np.linalg.det(found.axes) == pytest.approx(1)
    diagonal = found.axes.T @ inertia @ found.axes
    assert np.allclose(diagonal, np.diag(found.moments), atol=1e-12 * inertia.max())
    assert (np.diff(found.moments) >= 0).all()
    rod = inertia_of([[0.1, 0.2, 0.3], [-0.1, -0.2, -0.3]])
    assert (rod.principal.moments == 0).tolist() == [True, False, False]


MESHES = {
    "box": trimesh.creation.box(extents=(1, 2, 3)),
    "ring": trimesh.creation.annulus(r_min=0.4, r_max=1.0, height=0.3),
}
TURN = trimesh.transformations.euler_matrix(0.3, 0.5, 0.7)


@pytest.mark.parametrize(("name", "ending"), [("box", "obj"), ("ring", "stl"), ("ring", "ply")])
def test_meshes_agree_with_trimesh(tmp_path, name, ending):
    mesh = MESHES[name].copy()
    mesh.apply_transform(TURN)
    mesh.apply_translation((4.0, -2.0, 1.0))
    mesh.export(tmp_path / f"part.{ending}")
    found = mesh_inertia(read_mesh_file(tmp_path / f"part.{ending}"), density=7.8)
    mesh.density = 7.8
    assert found.mass == pytest.approx(mesh.mass, rel=1e-6)
    assert np.allclose(found.centre, mesh.center_mass, atol=1e-6)
    assert np.allclose(found.inertia, mesh.moment_inertia, rtol=1e-5, atol=1e-5)


def test_a_mesh_far_away_keeps_its_digits_and_what_rounding_leaves_of_a_zero_is_zero():
    near = mesh_inertia(MESHES["box"], mass=6.0)
    far = mesh_inertia(MESHES["box"].copy().apply_translation([2.0**20] * 3), mass=6.0)
    assert np.allclose(far.inertia, near.inertia, rtol=1e-13, atol=1e-13)
    ring = mesh_inertia(MESHES["ring"], mass=6.0)
    assert np.count_nonzero(ring.inertia) == np.count_nonzero(ring.principal.axes) == 3


def test_open_torn_and_inverted_meshes_are_refused():
    box = MESHES["box"]
    torn = np.vstack([box.faces[:1, ::-1], box.faces[1:]])
    for vertices, faces, fault in (
        (box.vertices, box.faces[1:], "the surface is open"),
        (box.vertices, torn, "some faces are turned over"),
        (box.vertices, box.faces[:, ::-1], "inside out: its volume is -6 m³"),
        (box.vertices * (1, 1, 0), box.faces, "its volume is zero"),
    ):
        with pytest.raises(BodyError, match=fault):
            mesh_inertia(trimesh.Trimesh(vertices, faces, process=False), mass=1.0)
    with pytest.raises(BodyError, match="expected either the mass or the density"):
        mesh_inertia(box)
    hole = trimesh.Trimesh(box.vertices, box.faces[1:], process=False)
    assert mesh_inertia(hole, mass=1.0, allow=True)


def test_the_command_shows_and_prints_as_json(tmp_path):
    np.save(tmp_path / "cloud.npy", rows())
    shown = call("inertia", "cloud.npy", cwd=tmp_path).stdout
    assert "500 particles" in shown
    assert repr(inertia_of(tmp_path / "cloud.npy")) in shown
    assert "principal axes as columns, right-handed" in shown
    MESHES["ring"].export(tmp_path / "ring.stl")
    words = ("inertia", "ring.stl", "--density", "1000", "--json")
    assert '"principal_moments"' in call(*words, cwd=tmp_path).stdout


@pytest.mark.parametrize(
    "module", ["data.mass", "tools.identify.identification", "simulation.solver"]
)
def test_the_examples_in_docstrings_run(module):
    failed, attempted = doctest.testmod(importlib.import_module(f"rigidsym.{module}"))
    assert attempted
    assert not failed


@pytest.mark.parametrize(
    ("file", "options", "message"),
    [
        ("cloud.csv", ["--density", "3"], "is a file of particles; --density is for meshes"),
        ("ring.stl", ["--columns", "x,y,z"], "is a mesh; --columns is for particles"),
        ("ring.stl", [], "is a mesh: expected --mass or --density"),
    ],
)
def test_an_option_that_does_not_fit_is_refused(tmp_path, file, options, message):
    (tmp_path / "cloud.csv").write_text("m,x,y,z\n1,0,0,0\n2,1,0,0\n")
    MESHES["ring"].export(tmp_path / "ring.stl")
    assert message in call("inertia", file, *options, cwd=tmp_path, status=2).stderr


MUTATIONS = 30  # of each kind of file


def mutated(content: bytes, rng: np.random.Generator) -> bytes:
    """A file in which one to four stretches are lost, doubled or written over."""
    for _ in range(rng.integers(1, 5)):
        at, length = int(rng.integers(len(content) + 1)), int(rng.integers(1, 20))
        end = (at + 1, at + 3, at + length, len(content))[min(3, rng.integers(10))]
        words = (b"nan", b"-1", b"1e999", b"99999999999", b"\xff\xfe", b"\0", b"/", b"\n")
        parts = (b"", 2 * content[at : at + length], rng.bytes(end - at), *words)
        content = content[:at] + parts[rng.integers(len(parts))] + content[end:]
    return content


ANGLES = np.random.default_rng(1).uniform(-60, 60, (4, 3))
MATRICES = Rotation.from_euler("ZYX", ANGLES, degrees=True).as_matrix().reshape(4, 9)
NAMES = ["phi", "theta", "psi", *(f"r{i}{j}" for i in "123" for j in "123")]
LOG = pl.DataFrame(np.hstack([ANGLES, MATRICES]), schema=NAMES)


FILES = {
    "semicolons.csv": lambda path: LOG.write_csv(path, separator=";", decimal_comma=True),
    "plain.npy": lambda path: np.save(path, LOG.to_numpy()),
    "log.parquet": LOG.write_parquet,
}


def refusals(path, works, seed, kinds=RigidsymError) -> int:
    """How many works refuse spoiled copies of a file; each has a result or a short message."""
    content, rng, said = path.read_bytes(), np.random.default_rng(seed), []
    for _ in range(MUTATIONS):
        path.write_bytes(mutated(content, rng))
        for work in works:
            try:
                work(path)
            except kinds as error:
                said.append(str(error))
    assert max(map(len, said), default=0) < 5000
    return len(said)


@pytest.mark.parametrize("name", FILES)
def test_a_broken_table_is_a_result_or_a_message(tmp_path, name):
    motion = rs.derive("ZYX", only=("rotation_matrix",))
    FILES[name](tmp_path / name)
    assert identify_file(tmp_path / name).fits

    def evaluated(path):
        evaluate(motion, ("rotation_matrix",), path, tmp_path / "r.csv")

    assert refusals(tmp_path / name, (evaluated, identify_file, inertia_of), len(name))


@pytest.mark.parametrize("ending", ["stl", "stl_ascii", "obj"])
def test_a_broken_mesh_is_a_body_or_a_message(tmp_path, ending):
    content, path = MESHES["box"].export(file_type=ending), tmp_path / f"part.{ending[:3]}"
    path.write_bytes(content.encode() if isinstance(content, str) else content)

    def body(path):
        mesh_inertia(read_mesh_file(path), density=1.0, allow=True)

    kinds, seed = (BodyError, MissingExtra), sum(ending.encode())
    assert 0 < refusals(path, [body], seed, kinds) < MUTATIONS


def test_a_file_that_is_no_mesh_is_described(tmp_path):
    empty = tmp_path / "empty.stl"
    empty.write_text("solid nothing\nendsolid nothing\n")
    with pytest.raises(BodyError, match=r"empty\.stl"):
        read_mesh_file(empty)
    with pytest.raises(BodyError, match=r"expected a mesh, a file that ends in \.stl, \.obj"):
        read_mesh_file(Path("/etc/passwd"))


@pytest.mark.parametrize("corner", [-1, 8])
def test_a_corner_that_is_no_vertex_is_refused(tmp_path, corner):
    """NumPy would count a negative number from the last vertex"""
    path = tmp_path / "a.ply"
    *lines, _ = MESHES["box"].export(file_type="ply", encoding="ascii").decode().splitlines()
    path.write_text("\n".join([*lines, f"3 0 1 {corner}", ""]))
    with pytest.raises(BodyError, match="a corner that is none of 8 vertices"):
        read_mesh_file(path)


DEGREE = pi / 180
ANGLE_UNITS = {
    "rad Radians": 1,
    "mrad": 1e-3,
    "µrad μrad urad": 1e-6,
    "deg ° Degrees DEG": DEGREE,
    "cdeg": DEGREE / 100,
    "mdeg": DEGREE / 1000,
    "arcmin ′": DEGREE / 60,
    "arcsec": DEGREE / 3600,
    "mas": DEGREE / 3600e3,
    "turn turns rev": 2 * pi,
    "gon gradian": pi / 200,
}
TIMES = {"s sec": 1, "ms": 1e-3, "min": 60, "h hr hour": 3600}
RATES = {
    "dps, deg.s^-1, degrees per second": DEGREE,
    "mdps": DEGREE / 1000,
    "rpm, rev/min": 2 * pi / 60,
    "rad s^-1, rad s-1, rad·s⁻¹, rad*s**-1": 1,
    "deg per hour": DEGREE / 3600,
}
OTHERS = [
    *((unit, "rad/s^2", DEGREE) for unit in ("deg/s^2", "°/s²", "deg/s/s", "deg s^-2")),
    ("mm", "m", 1e-3),
    ("g", "kg", 1e-3),
    ("g cm^2", "kg m^2", 1e-7),
    ("kg/(m s)", "kg/m/s", 1),
    ("1", "-", 1),
]


def test_units_are_converted_however_they_are_written():
    cases = [*OTHERS]
    for names, angle in ANGLE_UNITS.items():
        cases += [(name, "rad", angle) for name in names.split()]
        assert all(is_unit(name, "rad") for name in names.split())
    for (names, angle), (times, time) in product(ANGLE_UNITS.items(), TIMES.items()):
        for unit, second in product(names.split(), times.split()):
            rates = (f"{unit}/{second}", f"{unit} / {second}", f"{unit} {second}^-1")
            cases += [(rate, "rad/s", angle / time) for rate in (*rates, f"{unit} per {second}")]
    for names, rate in RATES.items():
        cases += [(name, "rad/s", rate) for name in names.split(", ")]
    for unit, expected, factor in cases:
        assert conversion(unit, expected) == pytest.approx(factor, rel=1e-14), unit


@pytest.mark.parametrize("unit", ["grad", "deg/fortnight", "filtered"])
def test_an_unknown_unit_is_refused_with_its_name(unit):
    with pytest.raises(DataError, match=f"unknown unit '{unit}'"):
        unit_of(unit)


@pytest.mark.parametrize(
    "name", ["yaw [deg]", "yaw_deg", "yaw deg", '"yaw, deg"', "/imu/yaw [deg]"]
)
def test_a_name_is_found_with_its_unit_however_it_is_written(name):
    header = ColumnNames(["time", name])
    assert header.find(["yaw"]) == 1
    assert header.factor(1, "rad") == pytest.approx(DEGREE)


@pytest.mark.parametrize("names", [["yaw", "Yaw [deg]"], ["a.yaw", "b.yaw"]])
def test_a_name_that_occurs_twice_is_refused(names):
    with pytest.raises(DataError, match="two columns are named yaw"):
        ColumnNames(names).find(["yaw"])


def test_the_full_name_is_preferred_to_the_end_of_a_path():
    assert ColumnNames(["desired.yaw", "yaw"]).find(["yaw"]) == 1
    assert ColumnNames(["position.x", "orientation.x"]).find(["x"]) is None


def test_a_new_name_of_a_column_keeps_the_unit_of_the_file():
    former = ("time [ms]", "yaw [mrad]", "roll_deg")
    assert names_for(["t", "psi", "phi"], 3, former) == ("t [ms]", "psi [mrad]", "phi [deg]")
    assert names_for(["t", "psi [deg]", "phi [rad]"], 3, former)[1:] == ("psi [deg]", "phi [rad]")
    assert names_for(["psi"], 1, None) == ("psi",)
    assert names_for(None, 3, former) == former
