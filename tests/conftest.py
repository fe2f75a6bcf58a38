"""Fixtures that several test modules share."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.compile import cache
from support.serial_chains import EXAMPLES

pytest_plugins = ["support.browser"]


# Nothing depends on how fast the machine is, and the same tests are run each time: what is new is for the campaigns.
settings.register_profile("tests", deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("tests")


@pytest.hookimpl(tryfirst=True)  # before the expression of -m chooses
def pytest_collection_modifyitems(items: Sequence[pytest.Item]) -> None:
    """Of a test marked `one_in(n)` the README's line runs one case of each n; the others are slow.

    It is the first of the first n, the last of the next, and so on: one parameter varies fastest, and every n-th case
    would be the same value of it wherever n divides their number.
    """
    cases = Counter[str]()
    for item in items:
        name = item.nodeid.partition("[")[0]
        if (mark := item.get_closest_marker("one_in")) is not None:
            block, place = divmod(cases[name], mark.args[0])
            if place != -block % mark.args[0]:
                item.add_marker("slow")
        cases[name] += 1


@pytest.fixture(scope="session", autouse=True)
def compiled_programs(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Where compiled programs lie while tests run: one folder for all workers, and not where the user keeps them."""
    with pytest.MonkeyPatch.context() as patch:
        own = tmp_path_factory.getbasetemp()
        folder = (own.parent if "PYTEST_XDIST_WORKER" in os.environ else own) / "compiled"
        patch.setenv(cache.VARIABLE, str(folder))
        yield folder


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
