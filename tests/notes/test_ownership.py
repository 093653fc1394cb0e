"""Every generated file says to whom it belongs: to whoever generated it, without conditions."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rigidsym.kernels.targets import TARGETS
from rigidsym.notes.formats import FORMATS
from rigidsym.pipeline import PAGE, output_of, read
from rigidsym.version import OWNERSHIP


@pytest.fixture(scope="module")
def files():
    spec = replace(read("ZXZ"), kernels=tuple(TARGETS), note=(*FORMATS, PAGE))
    return output_of(replace(spec, quantities=("angular_velocity_body",))).files


def test_every_generated_file_says_whose_it_is(files):
    unsaid = [
        name
        for name, text in files.items()
        if OWNERSHIP not in " ".join(text.replace("*", " ").split())
    ]
    assert unsaid == []
