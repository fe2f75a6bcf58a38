"""Fixtures that several test modules share."""

from __future__ import annotations

from pathlib import Path

import pytest

import rttrr_pin
from chains import EXAMPLES
from rttrr_pin import Robot


@pytest.fixture(scope="session")
def repository() -> Path:
    return Path(__file__).parents[1]


@pytest.fixture(scope="session")
def rttrr() -> Robot:
    return rttrr_pin.load("rttrr")


@pytest.fixture(scope="session", params=["rttrr", *EXAMPLES])
def robot(request: pytest.FixtureRequest) -> Robot:
    """The bundled arm and chains made to be awkward."""
    return rttrr_pin.load(EXAMPLES.get(request.param, request.param))
