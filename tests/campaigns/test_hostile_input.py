"""Whatever a user writes ends in a result or a message, and a killed command leaves whole files."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import warnings
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path
from random import Random
from time import perf_counter, sleep

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from helpers.command import RIGIDSYM, call
from rigidsym.errors import LimitReached, RigidsymError
from rigidsym.models.library import rotation_from
from rigidsym.spec.derivation_file import read_record, read_spec
from rigidsym.system import resources
from rigidsym.system.processes import time_limit

pytestmark = pytest.mark.campaign
SECONDS = 10.0
many = settings(
    max_examples=500,
    deadline=timedelta(seconds=4 * SECONDS),
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)


def is_answered(work: Callable[[], object]) -> None:
    """Anything but a message, warnings too, goes through."""
    with warnings.catch_warnings(action="error"):
        try:
            with time_limit(SECONDS):
                work()
        except RigidsymError as error:
            message = error
        else:
            return
    assert not isinstance(message, LimitReached)
    assert "\x1b" not in str(message)


# texts

NAMES = ("phi", "theta", "psi", "a", "A", "x_1", "lambda", "φ", "phi_dot", "t", "pi", "e")
NUMBERS = ("0", "1", "-2", "1/3", "0.5", "1e999", "9**9", "2**-3", ".5.", "0x1f", "1_0", "nan")
FUNCTIONS = ("sin", "cos", "tan", "sqrt", "exp", "log", "abs", "atan2", "asin", "__import__")
SPOILED = (*'()^°%.\\"\n\t\x00\u202e', "**", "//", "\x1b[2J")
expressions = st.recursive(
    st.sampled_from((*NAMES, *NUMBERS)),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from((" + ", "-", "*", " / ", "**", "")), inner).map("".join),
        st.tuples(st.sampled_from(FUNCTIONS), inner).map(lambda call: "{}({})".format(*call)),
        inner.map("({})".format),
    ),
    max_leaves=12,
)


@st.composite
def spoiled(draw: st.DrawFn, texts: st.SearchStrategy[str]) -> str:
    """A text into which up to three wrong characters have got, or which lost some."""
    text = draw(texts)
    for _ in range(draw(st.integers(0, 3))):
        start = draw(st.integers(0, len(text)))
        end = draw(st.integers(start, min(len(text), start + 8)))
        text = text[:start] + draw(st.sampled_from((*SPOILED, *NAMES, *NUMBERS, ""))) + text[end:]
    return text


turns = st.tuples(st.sampled_from(("x", "y", "z", "[1,1,0]", "[a,b,c]", "[0,0,0]")), expressions)
rotations = st.one_of(
    st.lists(turns.map(lambda turn: "{}({})".format(*turn)), min_size=1, max_size=5).map(" ".join),
    st.sampled_from(("ZXZ", "zyx", "313", "ZZX", "zXz", "gibbs_vector", "z(phi) [0,b,c](psi)")),
)


@many
@given(spoiled(rotations))
def test_rotations(text: str):
    is_answered(lambda: rotation_from(text))


FILES = [
    (resources.folder("derivations") / f"{name}.toml").read_text("utf-8")
    for name in resources.names("derivations", ".toml")
]
VALUES = ("[]", "{}", "true", "-1", "inf", "07:32:00", '"ZXZ"', '["a", 1]', "[[1], [3]]", '"m*("')


@st.composite
def files(draw: st.DrawFn) -> str:
    """A shipped derivation file with lines repeated, left out, moved or of another value."""
    lines = draw(st.sampled_from(FILES)).splitlines()
    for _ in range(draw(st.integers(1, 4))):
        place, other = (draw(st.integers(0, len(lines) - 1)) for _ in range(2))
        kind = draw(st.sampled_from(("repeat", "drop", "swap", "value", "expression")))
        if kind == "repeat":
            lines.insert(other, lines[place])
        elif kind == "drop" and len(lines) > 1:
            del lines[place]
        elif kind == "swap":
            lines[place], lines[other] = lines[other], lines[place]
        elif "=" in lines[place]:
            text = json.dumps(draw(expressions), ensure_ascii=False)
            value = text if kind == "expression" else draw(st.sampled_from(VALUES))
            lines[place] = f"{lines[place].partition('=')[0]}= {value}"
    return "\n".join(lines)


@many
@given(spoiled(files()))
def test_derivation_files(text: str):
    def read() -> None:
        spec = read_spec(text, source="file.toml", name="file", folder=Path("/nowhere"))
        assert read_record(json.loads(json.dumps(spec.to_data()))) == spec

    is_answered(read)


# commands that are killed

COMMANDS = {
    "derive": ("derive", "ZXZ", "--target", "numpy,c", "--only", "rotation_matrix"),
    "page": ("page", "ZXZ"),
    "eval": ("eval", "ZXZ", "log.npy", "--out", "out/log.npy", "--quantity", "rotation_matrix"),
}


def contents(folder: Path) -> dict[str, bytes]:
    """All files but drafts, whose names begin with a point."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and not path.name.startswith(".")
    }


@pytest.mark.parametrize("name", COMMANDS)
def test_a_killed_command_leaves_whole_files(name: str, tmp_path: Path):
    np.save(tmp_path / "log.npy", np.random.default_rng(1).uniform(-1, 1, (100_000, 3)))
    first = (*COMMANDS["derive"], "--angles", "a,b,c")
    call(*first, cwd=tmp_path)
    before = contents(tmp_path)
    start = perf_counter()
    call(*COMMANDS[name], cwd=tmp_path)
    seconds, after = perf_counter() - start, contents(tmp_path)
    random = Random(name)
    for _ in range(10):
        for path, content in before.items():
            (tmp_path / path).write_bytes(content)
        with subprocess.Popen(
            [*RIGIDSYM, *COMMANDS[name]], cwd=tmp_path, stdout=subprocess.DEVNULL
        ) as process:
            sleep(random.uniform(0.2, 2.0) * max(seconds, 0.5))
            os.kill(process.pid, signal.SIGKILL)
        for path, content in contents(tmp_path).items():
            assert content in (before.get(path), after.get(path)), path
        call(*COMMANDS[name], "--force", cwd=tmp_path) if name == "derive" else call(
            *COMMANDS[name], cwd=tmp_path
        )
        assert contents(tmp_path) == after
