"""Golden files, and the conventions that laws are tested over."""

from __future__ import annotations

import gc
from collections.abc import Callable
from difflib import unified_diff
from pathlib import Path

import pytest
from hypothesis import settings

import rigidsym as rs
from helpers.motions import derived

# The same examples in every run: a suite that is red today was red yesterday.
settings.register_profile("same", derandomize=True, deadline=None)
settings.load_profile("same")

# Derivations that are kept fill the memory; looking through them often finds no garbage.
gc.set_threshold(100_000)

GOLDEN = Path(__file__).parent / "golden"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden", action="store_true", help="write the golden files anew from this run"
    )


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


@pytest.fixture(params=rs.EULER_SEQUENCES)
def sequence(request: pytest.FixtureRequest) -> str:
    """Each of the 24 Euler sequences."""
    return request.param


@pytest.fixture
def motion(sequence: str) -> rs.Motion:
    """The derivation for each of the 24 Euler sequences, active."""
    return derived(sequence)
