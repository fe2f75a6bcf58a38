"""The plugin: a test for each check with an id of its own, and failures that say why."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import rttrr_pin.conformance.kit.checks
import rttrr_pin.diagnosis.report
import rttrr_pin.diagnosis.run
import rttrr_pin.implementations.pinocchio  # noqa: F401 - what is loaded before stays when a run of pytester ends
from rttrr_pin import load
from rttrr_pin.conformance import cases
from rttrr_pin.conformance.kit import pytest_plugin
from rttrr_pin.conformance.kit.checks import SUBJECTS

pytest_plugins = ["pytester"]

ROOT = Path(__file__).parents[3]
NAME = pytest_plugin.__name__

ROBOT = ROOT / "tests/data/torques_differ/two_links.urdf"

HEAD = f"""
import numpy as np
import pytest
import rttrr_pin
from rttrr_pin.conformance import assert_inverse_dynamics, parametrize_with_checks
from rttrr_pin.implementations import Batch, Evaluation, make_implementation

robot = rttrr_pin.load({str(ROBOT)!r})
recursion = make_implementation("recursion", robot.model)

def right(q, v, a):
    batch = Batch(robot.model, q[None], v[None], a[None])
    return recursion.evaluate(batch).values["tau"][0]

def wrong(q, v, a):
    return -right(q, v, a)
"""

LITTLE = (
    *("--rttrr-states", "4", "--rttrr-levels", "gravity,rates,payload"),
    *("--rttrr-laws", "E2", "--rttrr-references", "none"),
)


@pytest.fixture
def run(pytester: pytest.Pytester):  # type: ignore[no-untyped-def]
    def run(tests: str, *words: str) -> pytest.RunResult:
        pytester.makepyfile(HEAD + tests)
        plugins = ("-p", NAME, "-p", "no:cacheprovider", "-p", "no:xdist")
        return pytester.runpytest_inprocess(*plugins, "-W", "error", "--strict-markers", *words)

    return run


CHECKED = f"""
@parametrize_with_checks({str(ROBOT)!r})
def test_it(check):
    check(FUNCTION)
"""


def test_a_right_function_passes_each_check_that_it_offers(run) -> None:  # type: ignore[no-untyped-def]
    """It gives tau alone, and takes no payload."""
    result = run(CHECKED.replace("FUNCTION", "right"), *LITTLE, "-v", "-rs")
    result.assert_outcomes(passed=3, skipped=3)
    for name in ("level-gravity", "level-rates", "law-power-balance"):
        result.stdout.fnmatch_lines(f"*::test_it[[]rttrr-{name}-two_links[]] PASSED*")
    result.stdout.fnmatch_lines(["SKIPPED*no payload*", "SKIPPED*right gives no f", "SKIPPED*right gives no f, n"])


def test_a_program_that_offers_all_is_asked_all(run) -> None:  # type: ignore[no-untyped-def]
    """Levels that apply to the robot, all laws of a program's results, and the references."""
    result = run(
        CHECKED.replace("FUNCTION", "'recursion'"), "--rttrr-states", "2", "--rttrr-references", "pinocchio,lagrange"
    )
    levels = len(cases([load(ROBOT)], n_states=1))
    result.assert_outcomes(passed=levels + len(SUBJECTS) + 2)
    assert levels >= 5


def test_a_failure_names_the_cause_and_shows_nothing_of_ours(run) -> None:  # type: ignore[no-untyped-def]
    result = run(CHECKED.replace("FUNCTION", "wrong"), *LITTLE[:2], "--rttrr-levels", "gravity", *LITTLE[4:])
    result.assert_outcomes(failed=2, skipped=2)
    text = result.stdout.str()
    result.stdout.fnmatch_lines(
        [
            "E *AssertionError: wrong does not compute the inverse dynamics of two_links:",
            "E * level gravity (Gravity alone, at rest): 8 of 8 numbers are beyond rounding;*",
            "E * cause: tau has the opposite sign",
            "E * repair: multiply tau by -1",
            "E * def test_tau_of_*",
            "E *AssertionError: wrong violates the law of two_links: power balance (E201) in 4 of 4 states*",
            "E * cause: tau has the opposite sign",
        ]
    )
    assert "checks.py" not in text and "assertions.py" not in text


def test_a_failure_need_not_say_why(run) -> None:  # type: ignore[no-untyped-def]
    """Then it has the state to ask again."""
    words = (
        "--rttrr-no-diagnosis",
        "--rttrr-levels",
        "rates",
        "--rttrr-laws",
        "none",
        "--rttrr-references",
        "pinocchio",
    )
    result = run(CHECKED.replace("FUNCTION", "wrong"), *words, "--rttrr-states", "3")
    result.assert_outcomes(failed=2)
    result.stdout.fnmatch_lines(
        ["E *state * of two_links: q=*v=*a=*", "E *AssertionError: FAIL wrong against pinocchio*"]
    )
    assert "cause:" not in result.stdout.str()


def test_expected_failures_are_no_failures(run) -> None:  # type: ignore[no-untyped-def]
    """By the id of the check, with the robot's name or without."""
    expected = {"rttrr-level-gravity": "the sign", "rttrr-law-power-balance-two_links": "the sign"}
    tests = f"""
@parametrize_with_checks([robot], expected_failures={expected!r})
def test_it(robot, check):
    assert check.robot is robot
    check(wrong)
"""
    words = (*LITTLE[:2], "--rttrr-levels", "gravity", *LITTLE[4:], "--rttrr-no-diagnosis")
    run(tests, *words).assert_outcomes(xfailed=2, skipped=2)


def test_checks_can_be_left_out_by_their_marker(run) -> None:  # type: ignore[no-untyped-def]
    tests = CHECKED.replace("FUNCTION", "wrong") + "\ndef test_other():\n    pass\n"
    run(tests, *LITTLE, "-m", "not rttrr").assert_outcomes(passed=1, deselected=6)


def test_the_robots_of_the_levels_are_asked_of_what_is_made_for_them(run) -> None:  # type: ignore[no-untyped-def]
    tests = """
def made(model):
    own = make_implementation("recursion", model)
    return lambda q, v, a: own.evaluate(Batch(model, q[None], v[None], a[None])).values["tau"][0]

@parametrize_with_checks()
def test_it(check):
    check(made)
"""
    result = run(
        tests, "--rttrr-states", "1", "--rttrr-levels", "gravity,mimic", "--rttrr-laws", "E201", *LITTLE[6:], "-v"
    )
    result.assert_outcomes(passed=4)
    result.stdout.fnmatch_lines(["*rttrr-level-gravity-arm6*", "*rttrr-level-mimic-mimic*", "*power-balance-mimic*"])


@pytest.mark.parametrize(
    ("tests", "words", "message"),
    [
        ("@parametrize_with_checks(robot)\ndef test_it():\n    pass\n", (), "takes no `check`"),
        ("@parametrize_with_checks('no_such.urdf')\ndef test_it(check):\n    pass\n", (), "no_such.urdf"),
        (CHECKED.replace("FUNCTION", "right"), ("--rttrr-levels", "gravitation"), "did you mean gravity"),
        (CHECKED.replace("FUNCTION", "right"), ("--rttrr-laws", "M"), "no law of a program's results"),
        (CHECKED.replace("FUNCTION", "right"), ("--rttrr-states", "0"), "n_states is 0"),
        (CHECKED.replace("FUNCTION", "right"), ("--rttrr-precision", "half"), "precision is 'half'"),
    ],
)
def test_what_cannot_be_used_is_said(run, tests: str, words: tuple[str, ...], message: str) -> None:  # type: ignore[no-untyped-def]
    result = run(tests, *words)
    assert result.ret != 0
    assert message in result.stdout.str() + result.stderr.str()


def test_tests_without_checks_are_left_alone(run) -> None:  # type: ignore[no-untyped-def]
    tests = "\n@pytest.mark.parametrize('check', [1, 2])\ndef test_it(check):\n    assert check\n"
    run(tests).assert_outcomes(passed=2)


def test_the_example_passes(run, pytester: pytest.Pytester) -> None:  # type: ignore[no-untyped-def]
    """Dynamics in plain NumPy, also of drawn chains."""
    for path in (ROOT / "examples/pytest").glob("*.py"):
        pytester.makepyfile(**{path.stem: path.read_text().replace("max_examples=20", "max_examples=5")})
    words = ("--rttrr-states", "2", "--rttrr-references", "none")
    result = run("", *words, "-k", "test_my_dynamics")
    outcomes = result.parseoutcomes()
    assert outcomes["passed"] >= 12 and outcomes["skipped"] == 1 and "failed" not in outcomes


def test_the_entry_point_has_the_name_of_the_module() -> None:
    """So pytest knows that it has the plugin already, where it is named by -p too."""
    points = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["entry-points"]["pytest11"]
    assert points == {NAME: NAME}


def test_the_plugin_loads_nothing_of_ours() -> None:
    """pytest loads it in every run of a user's."""
    code = f"""
import sys, pytest
before = set(sys.modules)
import {NAME}
print(sorted(name for name in set(sys.modules) - before))
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    own = {
        "rttrr_pin",
        "rttrr_pin.lazy",
        "rttrr_pin.version",
        "rttrr_pin.conformance",
        "rttrr_pin.conformance.kit",
        NAME,
    }
    assert set(eval(done.stdout)) <= own


def test_none_of_the_levels_leaves_the_laws(run) -> None:  # type: ignore[no-untyped-def]
    words = ("--rttrr-states", "2", "--rttrr-levels", "none", "--rttrr-laws", "E201", "--rttrr-references", "pinocchio")
    result = run(CHECKED.replace("FUNCTION", "right"), *words)
    assert result.ret == 0 and "rttrr-level" not in result.stdout.str()
    assert sum(result.parseoutcomes().get(key, 0) for key in ("passed", "skipped")) == 2
