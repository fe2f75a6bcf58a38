"""Kernels that many tests of this room call, by each emitter; and a folder for the cache."""

from __future__ import annotations

from pathlib import Path

import pytest

from rttrr_pin import Robot
from rttrr_pin.compile import Kernel, cache
from rttrr_pin.core.wrench import RESULTS

EMITTERS = ("llvm", "numpy")


@pytest.fixture(scope="module", params=EMITTERS)
def emitter(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def kernel(rttrr: Robot, emitter: str) -> Kernel:
    return rttrr.compile("tau", emitter)


@pytest.fixture(scope="module")
def wrenches(rttrr: Robot, emitter: str) -> Kernel:
    return rttrr.compile(RESULTS, emitter)


@pytest.fixture(scope="module")
def mass_matrix(rttrr: Robot, emitter: str) -> Kernel:
    return rttrr.compile("mass_matrix", emitter)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "not" / "yet" / "there"
    monkeypatch.setenv(cache.VARIABLE, str(path))
    return path
