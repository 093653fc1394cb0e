"""TeX, for the tests that typeset."""

from __future__ import annotations

import os

import pytest

from rigidsym.notes.formats.pdf import missing_programs


@pytest.fixture
def tex() -> None:
    """TeX is here; without it the test is skipped, or fails where TeX is required."""
    if missing_programs():
        required = os.environ.get("RIGIDSYM_REQUIRE_TEX") == "1"
        (pytest.fail if required else pytest.skip)(f"not installed: {missing_programs()}")
