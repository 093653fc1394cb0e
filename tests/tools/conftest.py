"""What the tests of `rigidsym eval` share: a motion, and a log of it."""

from __future__ import annotations

import numpy as np
import pytest

import rigidsym as rs
from helpers.log_files import logged


@pytest.fixture(scope="module")
def motion() -> rs.Motion:
    return rs.derive("ZXZ")


@pytest.fixture(scope="module")
def table() -> np.ndarray:
    return logged()
