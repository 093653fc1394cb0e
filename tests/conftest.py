"""Golden files, programs that tests need, and two conventions: the algorithm knows none."""

from __future__ import annotations

import gc
import os
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator
from difflib import unified_diff
from functools import _lru_cache_wrapper
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

if TYPE_CHECKING:
    from rigidsym import Motion

# The same examples in every run: a suite that is red today was red yesterday.
settings.register_profile("same", derandomize=True, deadline=None)
settings.load_profile("same")

# Derivations that are kept fill the memory; looking through them often finds no garbage.
gc.set_threshold(100_000)

# Bytes that a process may keep from one file of tests to the next, and may add before it forgets
# again: packages and what they compiled stay, and a search through them takes half a second.
KEPT = {"most": 600e6, "more": 25e6}

GOLDEN = Path(__file__).parent / "golden"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden", action="store_true", help="write the golden files anew from this run"
    )


# Fixtures that need programs beside Python and a compiler. They are slow, and rarely fail.
PROGRAMS = {"tex", "chromium", "java", "coq", "gappa"}


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        if PROGRAMS.intersection(getattr(item, "fixturenames", ())):
            item.add_marker(pytest.mark.campaign)
    gc.freeze()  # what was imported stays


def forget(modules: Iterable[ModuleType]) -> None:
    """Empty what the functions of these modules keep, and not those that they import."""
    for module in modules:
        for each in [*vars(module).values()]:
            if isinstance(each, _lru_cache_wrapper) and each.__module__ == module.__name__:
                each.cache_clear()


def resident() -> float:
    """The bytes of this process in memory, 0 where the system does not tell."""
    statm = Path("/proc/self/statm")
    return int(statm.read_text().split()[1]) * os.sysconf("SC_PAGESIZE") if statm.is_file() else 0


@pytest.fixture(scope="module", autouse=True)
def memory(request: pytest.FixtureRequest) -> Iterator[None]:
    """Two processes need less than 2 GB, although derivations and compiled functions are kept."""
    yield
    from sympy.core.cache import clear_cache  # not where tests are only given to other processes

    forget([request.module])  # no other file asks for these
    if resident() > KEPT["most"]:
        every = [*sys.modules.items()]
        forget(m for name, m in every if name.partition(".")[0] in ("rigidsym", "helpers"))
        clear_cache()
        if "jax" in sys.modules:
            sys.modules["jax"].clear_caches()
        gc.collect()
        KEPT["most"] = max(KEPT["most"], resident() + KEPT["more"])


def program(name: str, command: str) -> Callable[[], None]:
    """A fixture that skips a test without this program, or fails where it is required."""

    @pytest.fixture(scope="session", name=name.lower())
    def needed() -> None:
        if shutil.which(command) is None:
            is_required = os.environ.get(f"RIGIDSYM_REQUIRE_{name.upper()}") == "1"
            (pytest.fail if is_required else pytest.skip)(f"{name} is not installed")

    return needed


tex, chromium, java = (
    program("TeX", "pdflatex"),
    program("Chromium", "chromium"),
    program("Java", "java"),
)
coq, gappa, node = program("Coq", "coqc"), program("Gappa", "gappa"), program("Node", "node")


@pytest.fixture
def golden(request: pytest.FixtureRequest) -> Callable[[str, str], None]:
    """golden(name, text): the text is that of tests/golden/name, or becomes it on request."""

    def compare(name: str, text: str) -> None:
        path = GOLDEN / name
        if request.config.getoption("--update-golden"):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="\n")
        known = path.read_text(encoding="utf-8") if path.is_file() else ""
        diff = unified_diff(
            known.splitlines(), text.splitlines(), f"golden/{name}", "now", lineterm=""
        )
        assert text == known, "\n".join(["differs; --update-golden takes it over", *diff])

    return compare


@pytest.fixture
def answered(golden: Callable[[str, str], None]) -> Callable[[str, Callable[[str], str]], None]:
    """answered(name, answer): tests/golden/name has questions, each with its answer.

    A question ends with a line "---->", and its answer with a line "====". For a new question,
    write it with an empty answer, and run with --update-golden.
    """

    def check(name: str, answer: Callable[[str], str]) -> None:
        pairs = (GOLDEN / name).read_text(encoding="utf-8").split("\n====\n")[:-1]
        questions = [pair.partition("\n---->\n")[0] for pair in pairs]
        golden(name, "".join(f"{q}\n---->\n{answer(q)}\n====\n" for q in questions))

    return check


@pytest.fixture(params=["ZXZ", "zyx"])
def sequence(request: pytest.FixtureRequest) -> str:
    """One of each kind of Euler sequence; `tests/laws` has all 24."""
    return request.param


@pytest.fixture
def motion(sequence: str) -> Motion:
    from helpers.motions import derived

    return derived(sequence)
