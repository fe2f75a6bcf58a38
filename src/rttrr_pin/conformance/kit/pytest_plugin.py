"""The plugin for pytest, which loads nothing of this package until a test asks for checks.

It is registered by the name of this module, so that `-p rttrr_pin.conformance.kit.pytest_plugin` loads it once.
PYTEST_DONT_REWRITE: it has no assertions, and a run of pytest in a process that has loaded it would warn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import pytest

if TYPE_CHECKING:
    from rttrr_pin.conformance.kit.checks import Options
    from rttrr_pin.robot import Robot

MARKER = "rttrr_checks"

MARKERS = (
    f"{MARKER}(robots, expected_failures): as `parametrize_with_checks`: a test for each check of inverse dynamics",
    "rttrr: a check of inverse dynamics by rttrr-pin, such as -m 'not rttrr' leaves out",
)

NONE = "none"
"""What leaves all laws, or references, out."""

Test = TypeVar("Test", bound=Callable[..., Any])


def parametrize_with_checks(
    robots: Robot | str | Sequence[Robot | str] | None = None,
    expected_failures: Mapping[str, str] | None = None,
) -> Callable[[Test], Test]:
    """Run a test once for each check of inverse dynamics: levels, laws, references, each with an id of its own.

    The test takes `check`, and `robot` if it wants to, and hands its program to the check:

        @parametrize_with_checks("my_arm.urdf")
        def test_inverse_dynamics(check):
            check(my_inverse_dynamics)

    Which checks there are, and how they are run, is said by the options `--rttrr-...` of pytest.

    Args:
        robots: one robot, or several: `Robot`s, or what `load` takes. None for those of the levels, which the program
            has to be made for: then it is a class or a function of one argument, the `Model`.
        expected_failures: by id of a check, with or without the robot's name, why it is expected to fail.
    """

    def decorate(test: Test) -> Test:
        marked: Test = pytest.mark.rttrr_checks(robots, expected_failures)(test)
        return marked

    return decorate


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options in a group of their own."""
    group = parser.getgroup("rttrr-pin", "checks of inverse dynamics (rttrr-pin)")
    group.addoption("--rttrr-states", type=int, default=32, metavar="N", help="States of each check.")
    group.addoption("--rttrr-seed", type=int, default=0, metavar="N", help="The same seed gives the same states.")
    group.addoption("--rttrr-levels", metavar="IDS", help="Levels that are checked, such as gravity,rates; else all.")
    group.addoption("--rttrr-laws", metavar="IDS", help=f"Laws by id or its beginning, such as E,B3; {NONE} for none.")
    group.addoption(
        "--rttrr-references",
        default="pinocchio",
        metavar="NAMES",
        help=f"Programs that are compared with, such as pinocchio,mujoco; {NONE} for none. Default: pinocchio.",
    )
    group.addoption(
        "--rttrr-precision", default="auto", metavar="TYPE", help="In whose rounding: auto, float64, float32."
    )
    group.addoption("--rttrr-no-diagnosis", action="store_true", help="Failures do not say why, which takes seconds.")


def pytest_configure(config: pytest.Config) -> None:
    """Register the markers."""
    for line in MARKERS:
        config.addinivalue_line("markers", line)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """The checks of a test that asks for them."""
    for marker in metafunc.definition.iter_markers(MARKER):
        _parametrize(metafunc, *marker.args, **marker.kwargs)
        break


def _parametrize(
    metafunc: pytest.Metafunc, robots: Any = None, expected_failures: Mapping[str, str] | None = None
) -> None:
    from rttrr_pin.conformance.kit.checks import checks
    from rttrr_pin.errors import RttrrError

    if "check" not in metafunc.fixturenames:
        raise pytest.UsageError(
            f"{metafunc.definition.nodeid} takes no `check`: def test_it(check): check(my_function)"
        )
    expected = dict(expected_failures or {})
    names = [name for name in ("check", "robot") if name in metafunc.fixturenames]
    try:
        found = list(checks(_loaded(robots), options_of(metafunc.config)))
    except RttrrError as error:
        raise pytest.UsageError(f"{metafunc.definition.nodeid}: {error}") from error
    rows = []
    for own in found:
        why = next((expected[name] for name in (own.id, own.general_id) if name in expected), None)
        marks = [pytest.mark.rttrr, *([] if why is None else [pytest.mark.xfail(reason=why)])]
        rows.append(pytest.param(*[own if name == "check" else own.robot for name in names], id=own.id, marks=marks))
    metafunc.parametrize(names, rows)


def _loaded(robots: Any) -> list[Robot] | None:
    from rttrr_pin.loading import load
    from rttrr_pin.robot import Robot

    if robots is None:
        return None
    several = list(robots) if isinstance(robots, list | tuple) else [robots]
    return [own if isinstance(own, Robot) else load(own) for own in several]


def options_of(config: pytest.Config) -> Options:
    """What the command line says."""
    from rttrr_pin.conformance.kit.checks import Options

    def listed(name: str) -> tuple[str, ...] | None:
        text = config.getoption(name)
        return None if text is None else tuple(x.strip() for x in text.split(",") if x.strip() and x.strip() != NONE)

    return Options(
        n_states=config.getoption("--rttrr-states"),
        seed=config.getoption("--rttrr-seed"),
        levels=listed("--rttrr-levels"),
        laws=listed("--rttrr-laws"),
        references=listed("--rttrr-references") or (),
        precision=config.getoption("--rttrr-precision"),
        diagnose=not config.getoption("--rttrr-no-diagnosis"),
    )
