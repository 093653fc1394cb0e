"""Work is bounded in time and memory, an interrupt ends it at once, text stays text, and each error
has its exit code.
"""

from __future__ import annotations

import gc
import inspect
import os
import re
import signal
import sys
from contextlib import ExitStack
from pathlib import Path
from time import sleep

import pytest

import rigidsym as rs
from helpers.command import call
from helpers.target_modules import loading
from rigidsym import errors
from rigidsym.data.mass import read_mesh_file
from rigidsym.errors import Fault, LimitReached, RequestError, SpecError
from rigidsym.kernels.targets import compiling
from rigidsym.notes.formats.pdf import typeset
from rigidsym.system import processes
from rigidsym.system.processes import in_processes, rare_collections, time_limit


def test_a_time_limit_holds_in_python(monkeypatch):
    def work():
        with time_limit(0.05), ExitStack() as stack:
            stack.callback(lambda: ended.append(sleep(0.1)))  # to its end, also at the next tick
            sleep(60)

    ended: list[None] = []
    monkeypatch.setattr(processes, "_TICK", 0.01)
    with pytest.raises(LimitReached, match=r"stopped after 0\.05 s"):
        work()
    assert ended
    with pytest.raises(LimitReached):
        rs.derive("z(a) x(b) z(c) x(d) z(e) x(f) z(g) x(h)", timeout=0.01)
    with pytest.raises(RequestError, match="expected a positive number of seconds"):
        rs.derive("ZXZ", timeout=float("nan"))
    assert rs.derive("z(a)", timeout=60).is_proved
    assert signal.getitimer(signal.ITIMER_REAL) == (0.0, 0.0)


def test_derivations_that_overlap_leave_the_searches_for_cycles_as_they_were():
    before = gc.get_threshold()
    with ExitStack() as first, ExitStack() as second:
        first.enter_context(rare_collections())
        second.enter_context(rare_collections())
        first.close()
        assert gc.get_threshold()[0] >= processes.NEW_OBJECTS
    assert gc.get_threshold() == before


@pytest.mark.parametrize(
    "turns",
    ["z(sqrt(sqrt(a+b)+c)) x(sqrt(sqrt(d)+1))", " ".join(f"z(a{k})" for k in range(1, 41))],
    ids=["roots of roots", "forty turns"],
)
def test_work_without_end_is_stopped(tmp_path, turns):
    (tmp_path / "top.toml").write_text(f'[rotation]\nsequence = "{turns}"')
    done = call("run", "top.toml", "--timeout", "0.2", cwd=tmp_path, status=124)
    said = "rigidsym: stopped after 0.2 s; raise the time limit if it needs longer\n"
    assert done.stderr == said
    assert [path.name for path in tmp_path.iterdir()] == ["top.toml"]


@pytest.mark.parametrize("words", ["derive {}", "run {}.toml", "{}", "eval ZXZ {}.csv --out a.npy"])
def test_no_message_commands_a_terminal(tmp_path, words):
    status = 3 if words.startswith("run") else 2
    done = call(*words.format("Z\x1b[2JX").split(), cwd=tmp_path, status=status)
    assert "\x1b" not in done.stdout + done.stderr
    assert "\\x1b" in done.stderr or "\\u001b" in done.stderr


FOUR = """\
rotation.sequence = ["ZXZ", "xyz", "ZYX", "zxz"]
output = { note = ["html", "page"], quantities = ["rotation_matrix"], conversions = true }
"""


def test_two_processes_write_what_one_writes(tmp_path, monkeypatch):
    (tmp_path / "four.toml").write_text(FOUR, encoding="utf-8")
    results = []
    for cores in "12":
        monkeypatch.setattr(processes, "cores", lambda count=int(cores): count)
        printed = call("run", "four.toml", "--out", cores, cwd=tmp_path).stdout.split(f"{cores}/")
        files = {path.name: path.read_bytes() for path in (tmp_path / cores).rglob("*.*")}
        results.append((printed, files))
    assert len(files) == 4 * 4
    assert results[0] == results[1]


def inverse(number: int) -> int:
    if number == 5:
        raise SpecError("five", [Fault(message="five has none")])
    return -number


@pytest.mark.parametrize("cores", [1, 3])
def test_results_come_in_order_and_errors_where_they_arise(cores: int, monkeypatch):
    monkeypatch.setattr(processes, "cores", lambda: cores)
    found = in_processes(inverse, range(8))
    assert [next(found) for _ in range(5)] == [0, -1, -2, -3, -4]
    with pytest.raises(SpecError, match="five has none") as caught:
        next(found)
    assert caught.value.faults == (Fault(message="five has none"),)
    assert list(in_processes(inverse, range(5))) == [0, -1, -2, -3, -4]
    assert list(in_processes(inverse, [])) == []


def test_work_that_is_left_early_ends_in_silence(monkeypatch, caplog):
    monkeypatch.setattr(processes, "cores", lambda: 3)
    for _ in range(12):
        results = in_processes(sleep, [0.0005] * 400)
        assert [next(results) for _ in range(6)] == [None] * 6
        results.close()
    assert not caplog.records  # of calls that hand out more, to copies that end


HERE = os.getpid()


def upper(item: str) -> str:
    if item == "f" and os.getpid() != HERE:  # the copy begins at the end
        os._exit(1)
    return item.upper()


def test_the_work_of_a_process_that_was_killed_is_done_again(monkeypatch):
    monkeypatch.setattr(processes, "cores", lambda: 2)
    assert "".join(in_processes(upper, "abcdef")) == "ABCDEF"


EXIT_CODES = {
    1: "AlgebraError Defect DerivationError EditedFiles NotARotation RigidsymError ToolFailed",
    2: "CheckError ExpressionError KernelError ModelError QuantityError RequestError",
    3: "BodyError DataError SpecError TemplateFault",
    4: "MissingExtra MissingTool",
    124: "LimitReached",
}


def test_each_error_has_its_exit_code_and_is_raised():
    kinds = filter(inspect.isclass, vars(errors).values())
    codes = {k.__name__: k.exit_code for k in kinds if issubclass(k, errors.RigidsymError)}
    assert codes == {name: code for code, names in EXIT_CODES.items() for name in names.split()}
    sources = "".join(p.read_text("utf-8") for p in Path(rs.__file__).parent.rglob("*.py"))
    assert codes.keys() - {"RigidsymError"} <= {
        *re.findall(r"(?<!class )\b([A-Z]\w+)(?:\(| if)", sources)
    }


def programs(patch: pytest.MonkeyPatch, line: str, *names: str) -> None:
    """Programs of these names in this folder that do what a line of the shell says."""
    for name in names:
        Path(name).write_text(f"#!/bin/sh\n{line}\n")
        Path(name).chmod(0o755)
    patch.setenv("PATH", f"{Path.cwd()}:/bin:/usr/bin")


def test_tex_that_fails_is_quoted(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    programs(monkeypatch, "echo no; exit 1", "pdflatex")
    with pytest.raises(errors.ToolFailed, match="the end of its log:\nno"):
        typeset("x")


@loading("c")
@pytest.mark.parametrize(
    ("program", "said"), [("echo no >&2; exit 1", "it says:\nno"), ("sleep 9", "after 0.2 seconds")]
)
def test_a_compiler_that_fails_is_quoted(program, said, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    programs(monkeypatch, program, "cc", "gcc", "clang")
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(compiling, "TIMEOUT", 0.2 if "sleep" in program else 9)
    with pytest.raises(errors.ToolFailed, match=said):
        compiling.compile_library([tmp_path / "none.c"], str(tmp_path / "none.so"))


@pytest.mark.parametrize(
    ("package", "extra", "command"),
    [
        ("polars", "data", "inertia a.parquet"),
        ("scipy.integrate", "simulate", "simulate heavy_symmetric_top --out r.csv"),
        ("trimesh", "mesh", "inertia a.stl --density 1"),
    ],
)
def test_a_missing_package_is_named_by_its_extra(package, extra, command, tmp_path, monkeypatch):
    for name in ("a.parquet", "a.stl"):
        (tmp_path / name).write_bytes(b"PAR1")
    monkeypatch.setitem(sys.modules, package, None)
    done = call(*command.split(), cwd=tmp_path, status=4)
    assert f"pip install '.[{extra}]'" in done.stderr


def test_a_mesh_that_does_not_exist_needs_no_package(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(errors.BodyError, match="no such mesh"):
        read_mesh_file(tmp_path / "a.stl")


def test_only_messages_about_shipped_names_refer_to_list():
    own = [f"k{n}" for n in range(11)]
    assert errors.offer("tau", own) == f"known: {', '.join(own)}"
    assert errors.offer("tau", own * 2) == "known: k0, k1, k2 and 19 more"
    assert "`rigidsym list`" in errors.offer("tau", own, listed=True)
