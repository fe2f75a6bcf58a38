"""Mutation scores: mutants change results and are different ones; what a suite sees is what a test would fail on."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rttrr_pin import Robot, load
from rttrr_pin.cli import main
from rttrr_pin.conformance import MutationScore, PytestSuite, Tolerances, level_robots, mutate
from rttrr_pin.conformance.mutation.mutants import Mutants, mutants, results
from rttrr_pin.conformance.mutation.mutate_command import KINDS as OFFERED
from rttrr_pin.conformance.mutation.suites import KINDS
from rttrr_pin.diagnosis.catalogue.whole import hypotheses_of
from rttrr_pin.diagnosis.states import sample_states
from rttrr_pin.errors import ImplementationError, InputError, RttrrError
from rttrr_pin.implementations import default_allowance

DATA = Path(__file__).parents[2] / "data" / "torques_differ"


@pytest.fixture(scope="module")
def robot() -> Robot:
    return load(DATA / "two_links.urdf")


@pytest.fixture(scope="module")
def every(robot: Robot) -> Mutants:
    return mutants(robot)


def ids(score: MutationScore) -> set[str]:
    return {own.hypothesis for own in score.passing}


@pytest.mark.parametrize("name", ["two_links", "fingers"])
def test_each_mutant_is_wrong_and_no_two_are_the_same(name: str) -> None:
    """At other states than those at which they were told apart. Some hypotheses on the fingers change roundings alone."""
    robot = load(DATA / f"{name}.urdf")
    every = mutants(robot)
    batch = sample_states(robot, 60, 1, None).states
    tried = [own.planted for own in every.found]
    right, least = batch.recursion[0].tau, default_allowance(batch)["tau"]
    with np.errstate(all="ignore"):
        found = np.array([values["tau"] for values in results(robot.model, tried, batch)])
        assert all(not (np.abs(tau - right) <= least).all() for tau in found)
        for k, tau in enumerate(found):
            apart = np.abs(found[k + 1 :] - tau).max(axis=(1, 2)) / np.abs(right).max()
            same = [every.found[k + 1 + i].sentence for i in np.flatnonzero(apart < 1e-12)]
            assert not same, every.found[k].sentence


def test_each_hypothesis_is_a_mutant_or_not_counted(robot: Robot, every: Mutants) -> None:
    counted = sum(1 + len(own.others) for own in every.found)
    assert counted + every.equivalent == len(hypotheses_of(robot.model))
    assert every.equivalent > 0  # in a plane most of a tensor shows nowhere


def test_what_is_equivalent_depends_on_what_is_looked_at(robot: Robot) -> None:
    """Frames of f change no torque."""
    of_tau, of_f = mutants(robot), mutants(robot, ("tau", "f"))
    assert of_f.equivalent < of_tau.equivalent


def test_a_suite_at_rounding_sees_all(robot: Robot) -> None:
    score = mutate(robot, Tolerances(("random",), 50, None))
    assert score.passed and score.score == 1.0
    assert "100.0%" in score.summary()


def test_a_suite_at_rest_sees_nothing_of_rates(robot: Robot) -> None:
    score = mutate(robot, Tolerances(("gravity",), 20))
    assert {"rates ignored", "accelerations ignored", "gravity alone"} <= ids(score)
    assert "gravity missing" not in ids(score)
    assert not score.passed


def test_a_wider_tolerance_sees_no_more(robot: Robot) -> None:
    passing = [ids(mutate(robot, Tolerances(atol=atol))) for atol in (1e-9, 1e-2, 1e9)]
    assert passing[0] <= passing[1] <= passing[2] and len(passing[0]) < len(passing[2])


def test_what_is_not_finite_is_seen(robot: Robot) -> None:
    """As by any comparison with a tolerance."""
    with np.errstate(all="ignore"):
        score = mutate(robot, Tolerances(atol=1e30), size=1e300)
    assert 0.0 < score.score < 1.0


def test_smaller_errors_are_seen_less(robot: Robot) -> None:
    suite = Tolerances(atol=1e-3)
    assert mutate(robot, suite, size=1e-3).score < mutate(robot, suite, size=0.1).score


def test_the_worst_passes_first_and_data_are_for_json(robot: Robot) -> None:
    score = mutate(robot, Tolerances(("gravity",), 5))
    changes = [own.relative for own in score.passing]
    assert changes == sorted(changes, reverse=True)
    data = json.loads(json.dumps(score.to_dict(), allow_nan=False))
    assert data["schema"] == 1 and len(data["passing"]) == len(score.passing)
    assert sum(own["of"] for own in data["kinds"].values()) == data["mutants"]


def test_payloads_are_looked_at_where_the_suite_has_some(robot: Robot) -> None:
    with_payload = mutate(robot, Tolerances(("random", "payload")))
    sentences = {own.hypothesis for own in with_payload.mutants}
    without = {own.hypothesis for own in mutate(robot).mutants}
    assert any("payload" in own for own in sentences) and not any("payload" in own for own in without)


def test_a_suite_sees_what_any_of_its_states_sees(robot: Robot) -> None:
    both = mutate(robot, Tolerances(("payload", "gravity"), 3))
    alone = mutate(robot, Tolerances(("payload",), 3))
    assert {own.index for own in both.passing} <= {own.index for own in alone.passing}
    assert len(both.mutants) == len(alone.mutants)


def test_unit_accelerations_show_the_mass_matrix_alone(robot: Robot) -> None:
    passing = ids(mutate(robot, Tolerances(("units",), 3)))
    assert "rates ignored" in passing
    assert "accelerations ignored" not in passing


def test_some_can_be_drawn(robot: Robot, every: Mutants) -> None:
    score = mutate(robot, most=20)
    assert len(score.mutants) == 20 and score.left_out == len(every.found) - 20


def test_a_floating_tree_has_mutants_of_its_base() -> None:
    tree = load(DATA / "arm_with_gripper.urdf", base="floating")
    score = mutate(tree, Tolerances(("gravity",), 2), most=150)
    assert 0.0 < score.score < 1.0


@pytest.mark.parametrize(
    "arguments",
    [
        {"states": ("fast", "nowhere")},
        {"states": ()},
        {"quantities": ("torque",)},
        {"n_states": 0},
        {"atol": -1.0},
        {"rtol": float("nan")},
        {"rates": -1.0},
        {"seed": -1},
    ],
)
def test_a_suite_that_cannot_be_is_refused(arguments: dict[str, Any]) -> None:
    with pytest.raises(RttrrError):
        Tolerances(**arguments)


def test_the_command_offers_the_kinds_of_states() -> None:
    assert KINDS == OFFERED


def test_the_command_tells_what_passes(robot: Robot, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = tmp_path / "score.json"
    name = str(DATA / "two_links.urdf")
    assert main(["mutate", name, "--states", "gravity", "-n", "5", "--json", str(target), "--full"]) == 1
    assert "rates are not counted" in capsys.readouterr().out
    assert json.loads(target.read_text())["passed"] is False
    assert main(["mutate", name, "-n", "50", "--atol", "rounding", "-q"]) == 0
    assert main(["mutate", name, "--states", "gravity", "--least", "1", "-q"]) == 0
    for words in (
        ["--states", "nowhere"],
        ["--atol", "small"],
        ["--function", "a:b"],
        ["--mutants", "0"],
        ["--least", "200"],
    ):
        assert main(["mutate", name, *words]) == 2
    capsys.readouterr()
    assert main(["mutate", name, "--pytest", "tests", "--atol", "1", "--rates", "2"]) == 2
    assert "--atol, --rates is of a suite that is told" in capsys.readouterr().err


# tests of the user's

EXACT = """
import numpy as np
import pytest
import my_dynamics
from my_dynamics import inverse_dynamics as own

RIGHT = {right}

@pytest.fixture(scope="session")
def inverse_dynamics():
    raise RuntimeError("is replaced")

@pytest.fixture(scope="module")
def computed(inverse_dynamics):
    return [inverse_dynamics(*state) for state, _ in RIGHT]

def test_by_fixture(computed):
    np.testing.assert_allclose(computed, [tau for _, tau in RIGHT], atol=1e-9)

def test_by_function():
    for (q, v, a), tau in RIGHT:
        np.testing.assert_allclose(own(q, v, a), tau, atol=1e-9)

def test_by_module():
    for (q, v, a), tau in RIGHT[:1]:
        np.testing.assert_allclose(my_dynamics.inverse_dynamics(q, v, a), tau, atol=1e-9)

def test_at_rest(inverse_dynamics):
    (q, v, a), tau = RIGHT[0]
    np.testing.assert_allclose(inverse_dynamics(q, v, a), tau, atol=1e-9)

def test_of_another_robot(inverse_dynamics):
    assert inverse_dynamics([0.0], [0.0], [0.0]).shape == (1,)

def test_of_nothing():
    pass
"""


@pytest.fixture(scope="module")
def suite(robot: Robot, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first state is at rest, the others are not."""
    folder = tmp_path_factory.mktemp("suite")
    batch = sample_states(robot, 40, 2, None).states
    states = zip(batch.q.tolist(), batch.v.tolist(), batch.a.tolist(), strict=True)
    right = list(zip(states, batch.recursion[0].tau.tolist(), strict=True))
    assert not batch.v[0].any() and not batch.a[0].any()
    (folder / "my_dynamics.py").write_text("def inverse_dynamics(q, v, a):\n    raise RuntimeError\n")
    (folder / "test_mine.py").write_text(EXACT.format(right=repr(right)))
    return folder


def run(suite: Path, robot: Robot, words: Sequence[str], monkeypatch: pytest.MonkeyPatch, **how: Any) -> MutationScore:
    monkeypatch.chdir(suite)
    monkeypatch.delenv("PYTEST_ADDOPTS", raising=False)
    return mutate(robot, PytestSuite(["test_mine.py", "-k", *words], **how), most=24)


@pytest.mark.one_in(2)
@pytest.mark.parametrize(
    ("test", "how"),
    [
        ("test_by_function", {"function": "my_dynamics:inverse_dynamics"}),
        ("test_by_fixture", {}),
    ],
)
def test_tests_that_compare_all_see_all(
    test: str, how: dict[str, Any], suite: Path, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[int] = []
    score = run(suite, robot, [test], monkeypatch, progress=done.append, **how)
    assert score.passed and len(score.mutants) == 24
    assert done[-1] <= 25


@pytest.mark.one_in(2)
@pytest.mark.parametrize(
    ("test", "how"),
    [
        ("test_at_rest", {}),
        ("test_by_module", {"function": "my_dynamics:inverse_dynamics"}),
    ],
)
def test_tests_at_rest_see_what_shows_at_rest(
    test: str, how: dict[str, Any], suite: Path, robot: Robot, every: Mutants, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As the same suite as data."""
    score = run(suite, robot, [f"{test} or test_of_nothing"], monkeypatch, **how)
    batch = sample_states(robot, 40, 2, None).states
    tried = [own.planted for own in score.mutants]
    right = batch.recursion[0].tau[0]
    passing = [
        own.sentence
        for own, values in zip(score.mutants, results(robot.model, tried, batch), strict=True)
        if np.allclose(values["tau"][0], right, rtol=1e-7, atol=1e-9)
    ]
    assert sorted(own.sentence for own in score.passing) == sorted(passing)
    assert 0 < len(passing) < 24


@pytest.mark.one_in(3)
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["test_of_nothing"], "no test calls the fixture 'inverse_dynamics'"),
        (["test_of_another_robot or test_at_rest"], "1 of its tests fail with right dynamics"),
        (["nowhere"], "no test calls"),
    ],
)
def test_a_suite_that_says_nothing_is_refused(
    words: list[str], message: str, suite: Path, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ImplementationError, match=message):
        run(suite, robot, words, monkeypatch)


def test_what_pytest_says_is_told(suite: Path, robot: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        ImplementationError, match="cannot be imported there: ModuleNotFoundError: No module named .my_missing_module"
    ):
        run(suite, robot, ["test_at_rest"], monkeypatch, function="my_missing_module:f")
    with pytest.raises(InputError, match="expected a module and a name"):
        PytestSuite("tests", function="my_function")
    with pytest.raises(InputError, match="No closing quotation; expected words"):
        PytestSuite('tests -k "rates')


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted({*level_robots()} - {"sixty"}))
def test_a_hundred_states_at_rounding_see_all_of_every_robot_of_the_levels(name: str) -> None:
    """All but sixty joints, of which there are forty thousand hypotheses."""
    from rttrr_pin.conformance import level_robot

    assert mutate(level_robot(name), Tolerances(("random",), 100, None)).passed
