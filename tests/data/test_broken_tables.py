"""Tables with bytes changed, lost or doubled: a result or a message, never a traceback."""

from __future__ import annotations

import io

import numpy as np
import polars as pl
import pytest
from scipy.spatial.transform import Rotation

import rigidsym as rs
from helpers.mutations import mutated
from rigidsym.errors import RigidsymError
from rigidsym.tools.evaluate import evaluate
from rigidsym.tools.identify.identification import identify_file

MUTATIONS = 60  # of each kind of file
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
    "commas.csv": lambda: text(",", "."),
    "semicolons.csv": lambda: text(";", ","),
    "blanks.txt": lambda: text(" ", "."),
    "plain.npy": lambda: npy(TABLE),
    "structured.npy": lambda: npy(
        np.rec.fromarrays(TABLE.T, names=",".join(NAMES)).view(np.ndarray)
    ),
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
