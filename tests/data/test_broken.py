"""Files with bytes changed, lost or doubled: a result or a message, never a traceback."""

from __future__ import annotations

import io
from pathlib import Path

import numpy as np
import polars as pl
import pytest
import trimesh
from scipy.spatial.transform import Rotation

import rigidsym as rs
from rigidsym.data.mass import mesh_inertia, read_mesh_file
from rigidsym.errors import BodyError, MissingExtra, RigidsymError
from rigidsym.tools.evaluate import evaluate
from rigidsym.tools.identify.identification import identify_file

MUTATIONS = 30  # of each kind of file


def mutated(content: bytes, rng: np.random.Generator) -> bytes:
    """One to four bytes or stretches of a file changed."""
    some = bytearray(content)
    for _ in range(rng.integers(1, 5)):
        at = int(rng.integers(len(some) or 1))
        length = int(rng.integers(1, 20))
        kind = rng.integers(6)
        if kind == 0:
            some[at : at + 1] = rng.bytes(1)
        elif kind == 1:
            del some[at : at + length]
        elif kind == 2:
            some[at:at] = some[at : at + length]
        elif kind == 3:
            some[at : at + length] = rng.bytes(length)
        elif kind == 4:
            del some[at:]
        else:
            words = (b"nan", b"-1", b"1e999", b"99999999999", b"\xff\xfe", b"\0", b"/", b"\n")
            some[at : at + 3] = words[rng.integers(len(words))]
    return bytes(some)


ANGLES = np.random.default_rng(1).uniform(-60, 60, (4, 3))
MATRICES = Rotation.from_euler("ZYX", ANGLES, degrees=True).as_matrix().reshape(4, 9)
TABLE = np.hstack([ANGLES, MATRICES])
NAMES = ["phi", "theta", "psi", *(f"r{i}{j}" for i in "123" for j in "123")]


def text(separator: str, mark: str) -> bytes:
    header = separator.join(f"{n}_deg" if n in NAMES[:3] else n for n in NAMES)
    rows = [separator.join(f"{x:.8f}".replace(".", mark) for x in row) for row in TABLE]
    return "\n".join(["# flight 7", header, *rows, ""]).encode()


def npy(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def parquet_file() -> bytes:
    file = io.BytesIO()
    columns = {name: TABLE[:, k] for k, name in enumerate(NAMES)}
    pl.DataFrame(columns).write_parquet(file)
    return file.getvalue()


FILES = {
    "semicolons.csv": lambda: text(";", ","),
    "plain.npy": lambda: npy(TABLE),
    "log.parquet": parquet_file,
}


@pytest.mark.parametrize("name", FILES)
def test_a_broken_table_is_a_result_or_a_message(tmp_path, name):
    motion = rs.derive("ZYX", only=("rotation_matrix",))
    content, path = FILES[name](), tmp_path / name
    path.write_bytes(content)
    assert identify_file(path).fits
    rng = np.random.default_rng(len(name))
    refused = 0
    for _ in range(MUTATIONS):
        path.write_bytes(mutated(content, rng))
        for work in (
            lambda: evaluate(motion, ("rotation_matrix",), path, tmp_path / "r.csv"),
            lambda: identify_file(path),
            lambda: rs.inertia_of(path),
        ):
            try:
                work()
            except RigidsymError as error:
                refused += 1
                shown = str(error)
                assert len(shown) < 5000, shown[:500]
    assert refused


def exported(ending: str) -> bytes:
    content = trimesh.creation.box(extents=(1, 2, 3)).export(file_type=ending)
    return content.encode() if isinstance(content, str) else content


@pytest.mark.parametrize("ending", ["stl", "stl_ascii", "obj"])
def test_a_broken_mesh_is_a_body_or_a_message(tmp_path, ending):
    content = exported(ending)
    rng = np.random.default_rng(sum(ending.encode()))
    path = tmp_path / f"part.{ending.removesuffix('_ascii')}"
    refused = 0
    for _ in range(MUTATIONS):
        path.write_bytes(mutated(content, rng))
        try:
            mesh_inertia(read_mesh_file(path), density=1.0, allow=True)
        except (BodyError, MissingExtra):
            refused += 1
    assert 0 < refused < MUTATIONS


def test_a_file_that_is_no_mesh_is_described(tmp_path):
    empty = tmp_path / "empty.stl"
    empty.write_text("solid nothing\nendsolid nothing\n")
    with pytest.raises(BodyError, match=r"empty\.stl"):
        read_mesh_file(empty)
    with pytest.raises(BodyError, match="no such mesh"):
        read_mesh_file(tmp_path / "none.stl")
    with pytest.raises(BodyError, match=r"expected a mesh, a file that ends in \.stl, \.obj"):
        read_mesh_file(Path("/etc/passwd"))


PLY = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 4
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
0 0 1
3 0 2 1
3 0 1 3
3 0 3 2
3 1 2 {}
"""


@pytest.mark.parametrize("corner", [-1, 4])
def test_a_corner_that_is_no_vertex_is_refused(tmp_path, corner):
    """NumPy would count a negative number from the last vertex"""
    path = tmp_path / "a.ply"
    path.write_text(PLY.format(corner))
    with pytest.raises(BodyError, match="a corner that is none of 4 vertices"):
        read_mesh_file(path)
