"""Files of meshes with bytes changed, lost or doubled: a body or a message, never a traceback."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from helpers.mutations import mutated
from rigidsym.data.mass import mesh_inertia, read_mesh_file
from rigidsym.errors import BodyError, MissingExtra

MUTATIONS = 80  # of each format


def exported(ending: str) -> bytes:
    content = trimesh.creation.box(extents=(1, 2, 3)).export(file_type=ending)
    return content.encode() if isinstance(content, str) else content


@pytest.mark.parametrize("ending", ["stl", "stl_ascii", "obj", "ply"])
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


def test_what_trimesh_logs_stays_silent(tmp_path):
    path = tmp_path / "part.stl"
    path.write_bytes(exported("stl_ascii").replace(b"facet normal 0", b"facet normal ?"))
    program = "from rigidsym.commands.cli import main; main()"
    asked = [sys.executable, "-c", program, "inertia", str(path), "--density", "1"]
    done = subprocess.run(asked, capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr
    assert done.stdout.startswith("12 faces") or done.returncode == 3


def test_a_file_that_is_no_mesh_is_described_and_not_quoted(tmp_path):
    secret = tmp_path / "secret.stl"
    secret.write_text("root:x:0:0:root:/root:/bin/bash\n" * 9)
    with pytest.raises(BodyError) as error:
        read_mesh_file(secret)
    assert "root:" not in str(error.value).removeprefix(str(secret))
    with pytest.raises(BodyError, match=r"expected a mesh, a file that ends in \.stl, \.obj"):
        read_mesh_file(Path("/etc/passwd"))


def test_lengths_beyond_double_precision_are_a_message():
    from rigidsym.data.mass import Mesh

    box = trimesh.creation.box()
    for size in (1e200, 1e-200):
        mesh = Mesh(vertices=np.array(box.vertices) * size, faces=np.array(box.faces))
        with pytest.raises(BodyError, match=r"precision|volume is zero"):
            mesh_inertia(mesh, density=1.0)


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
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"


@pytest.mark.parametrize("corner", [-1, 4])
def test_a_corner_that_is_no_vertex_is_refused(tmp_path, corner):
    """NumPy would count a negative number from the last vertex"""
    path = tmp_path / "a.ply"
    path.write_text(PLY.format(corner))
    with pytest.raises(BodyError, match="a corner that is none of 4 vertices"):
        read_mesh_file(path)


def test_corners_of_obj_may_be_relative_and_a_corner_0_is_refused(tmp_path):
    path = tmp_path / "a.obj"
    for faces in ("f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4", "f -4 -2 -3\nf 1 2 4\nf 1 4 3\nf -3 3 -1"):
        path.write_text(TETRAHEDRON + faces)
        assert mesh_inertia(read_mesh_file(path), density=6.0).mass == pytest.approx(1)
    path.write_text(TETRAHEDRON + "f 0 2 1\nf 0 1 3\nf 0 3 2\nf 1 2 3")
    with pytest.raises(BodyError, match="edges have"):
        mesh_inertia(read_mesh_file(path), density=6.0)
