"""The conventions that laws are tested over."""

from __future__ import annotations

import pytest

import rigidsym as rs


@pytest.fixture(params=rs.EULER_SEQUENCES)
def sequence(request: pytest.FixtureRequest) -> str:
    return request.param
