"""A program's way through the levels: who is asked, what is claimed, why it fails."""

from __future__ import annotations

import json
import re
import shlex
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rttrr_pin import InputError, load
from rttrr_pin.conformance import LEVELS, Conformance, LevelResult, Standing, conform, level_robot
from rttrr_pin.core.model import Model
from rttrr_pin.errors import ImplementationError, RefusalError, UnknownNameError
from rttrr_pin.implementations import Batch, Evaluation
from support.planted_levels import PLANTED, program
from support.single import SingleRecursion

IDS = [level.id for level in LEVELS]


def results(**outcomes: str) -> list[LevelResult]:
    """All levels passed but these; None is not asked."""
    own = {name: outcomes.get(name, "pass") for name in IDS}
    return [LevelResult(name, "arm6", outcome, 4) for name, outcome in own.items() if outcome != "not asked"]  # type: ignore[arg-type]


SENTENCES = {
    "14 of 14": {},
    "level 9 of 14 (floating); not offered: mimic; failed: effects": {"mimic": "not offered", "effects": "fail"},
    "0 of 14 levels; failed: gravity": {"gravity": "error"} | dict.fromkeys(IDS[1:], "not offered"),
    "level 2 of 14 (rates); failed: accelerations": {"accelerations": "fail"},
    "13 of 14 levels; not offered: payload": {"payload": "not offered"},
    "level 13 of 14 (small); not offered: sixty": {"sixty": "not offered"},
    "level 3 of 14 (accelerations); also passed: fast; not asked: ": dict.fromkeys(
        set(IDS[3:]) - {"fast"}, "not asked"
    ),
    "1 of 14 levels (fast)": dict.fromkeys(set(IDS) - {"fast"}, "not asked"),
}


@pytest.mark.parametrize("sentence", SENTENCES)
def test_no_more_is_claimed_than_was_shown(sentence: str) -> None:
    standing = Standing.of(results(**SENTENCES[sentence]))
    if sentence.startswith("0 of"):
        sentence = sentence.replace("; failed", f"; not offered: {', '.join(IDS[1:])}; failed")
    assert standing.sentence().startswith(sentence)
    assert sentence.endswith(": ") or standing.sentence() == sentence or "not asked" in standing.sentence()
    assert standing.whole == (standing.sentence() == "14 of 14")


def test_what_is_not_offered_is_named_however_many() -> None:
    standing = Standing.of(results(**dict.fromkeys(IDS[2:8], "not offered"), **dict.fromkeys(IDS[8:], "fail")))
    assert standing.sentence(2) == f"level 2 of 14 (rates); not offered: {', '.join(IDS[2:8])}; failed: 6 levels"


@pytest.mark.parametrize("outcome", ["fail", "error", "not offered"])
def test_a_level_is_passed_with_all_its_robots(outcome: Any) -> None:
    one = LevelResult("fast", "arm6", "pass", 4)
    standing = Standing.of([one, LevelResult("fast", "rttrr", outcome, 4)])
    assert standing.passed == ()
    assert standing.not_offered == (("fast",) if outcome == "not offered" else ())


def test_a_function_is_made_for_one_robot() -> None:
    robot = level_robot("arm6")

    def mine(q: Any, v: Any, a: Any) -> Any:
        return robot.inverse_dynamics(q, v, a).tau

    for robots in (None, [robot, level_robot("tree")]):
        with pytest.raises(InputError, match=r"mine is made for one robot.*conform\(mine, \[robot\]\)"):
            conform(mine, robots)
    result = conform(mine, [robot], n_states=4)
    standing = result.standing
    assert result.passed and standing.not_offered == ("payload",)
    assert set(standing.passed) == {"gravity", "rates", "accelerations", "fast", "cancelling"}
    assert result.claim().startswith(
        "arm6: level 3 of 14 (accelerations), tau alone; also passed: fast, cancelling; not offered"
    )


def whole(model: Model) -> Callable[..., Any]:
    """A function of the model that makes one of states."""
    if model.floating:
        raise NotImplementedError("fixed bases only")

    def recursion(q: Any, v: Any, a: Any) -> Any:
        return Batch(model, q, v, a).recursion[0].tau

    return recursion


def test_who_is_told_the_robot_is_asked_with_all() -> None:
    result = conform(whole, n_states=2)
    assert result.subject == "whole" and result.passed
    assert result.standing.not_offered == ("payload", "floating")
    message = next(own.message for own in result.results if own.level == "floating")
    assert "fixed bases only" in message


def test_a_table_has_its_own_states(tmp_path: Path) -> None:
    (tmp_path / "results.csv").write_text("q,v,a\n")
    with pytest.raises(InputError, match="is a table, with states of its own"):
        conform(tmp_path / "results.csv")


PROGRAM = """
import json, sys
import numpy as np
from dataclasses import replace
from rttrr_pin import load
from rttrr_pin.core.joint import JointEffects
from rttrr_pin.implementations import Batch
urdf, base, gravity, effects = sys.argv[1:]
robot = load(urdf, base=base, gravity=[float(x) for x in gravity.split(",")])
robot = robot.with_joint_effects({name: JointEffects(**own) for name, own in json.loads(effects).items()})
for line in sys.stdin:
    state = json.loads(line)
    if "payload" in state:
        print(json.dumps({"error": "payloads are not written yet"}), flush=True)
        break
    q, v, a = (np.array([state[key]]) for key in "qva")
    print(json.dumps(Batch(robot.model, q, v, a).recursion[0].tau[0].tolist()), flush=True)
"""


def test_a_command_is_told_the_robot(tmp_path: Path) -> None:
    """Its file, base, gravity and what its joints take; a reply with an error is a refusal."""
    (tmp_path / "my id.py").write_text(PROGRAM)
    words = [sys.executable, str(tmp_path / "my id.py")]
    command = f"{shlex.join(words)} {{urdf}} {{base}} {{gravity}} {{effects}}"
    result = conform(command, levels=["gravity", "payload", "floating", "effects"], n_states=2)
    assert [own.outcome for own in result.results] == ["pass", "not offered", "pass", "pass"]
    assert "payloads are not written yet" in result.results[1].message
    assert result.subject == command
    with pytest.raises(InputError, match="made for one robot"):
        conform(shlex.join(words))


def test_what_is_printed_to_few_digits_is_claimed_at_these(tmp_path: Path) -> None:
    (tmp_path / "my_id.py").write_text(PROGRAM.replace(".tolist())", ".round(5).tolist())"))
    command = f"{shlex.join([sys.executable, str(tmp_path / 'my_id.py')])} {{urdf}} {{base}} {{gravity}} {{effects}}"
    result = conform(command, levels=["gravity"], n_states=2)
    assert result.passed and result.printed is not None and result.printed < 10
    assert result.claim().startswith(f"level 1 of 14 (gravity) at {result.printed} digits, tau alone; not asked: ")


def test_what_cannot_be_asked_is_an_error() -> None:
    with pytest.raises(UnknownNameError, match="pinochio"):
        conform("pinochio")
    with pytest.raises(UnknownNameError, match="gravty"):
        conform("recursion", levels=["gravty"])
    with pytest.raises(InputError, match="float16"):
        conform("recursion", precision="float16")  # type: ignore[arg-type]

    def nowhere(model: Model) -> Any:
        raise RefusalError("no robots at all")

    with pytest.raises(ImplementationError, match="no robots at all"):
        conform(nowhere)

    class OnlyPayloads:
        name, version, quantities = "unwilling", "", ("tau",)

        def __init__(self, model: Model) -> None: ...

        def evaluate(self, batch: Batch) -> Evaluation:
            raise NotImplementedError("nothing")

    with pytest.raises(ImplementationError, match="none of what was asked is offered"):
        conform(OnlyPayloads, levels=["gravity"], n_states=2)


def test_a_program_that_tires_fails() -> None:
    """It answers when it is tried, and then no more: there is no number that tells its precision."""

    def tired(model: Model) -> Callable[..., Any]:
        calls = iter([np.zeros(model.nv)] * 3)
        return lambda q, v, a: next(calls)

    result = conform(tired, levels=["gravity"], n_states=4)
    assert not result.passed and result.claim() == "0 of 14 levels; failed: gravity"
    assert result.precision == "float64" and result.results[0].outcome == "error"


def test_a_program_that_crashes_on_a_robot_fails_there() -> None:
    def fragile(model: Model) -> Any:
        if len(model.links) > 20:
            raise IndexError("too many links")
        return whole(model)

    result = conform(fragile, levels=["gravity", "sixty"], n_states=2)
    assert [own.outcome for own in result.results] == ["pass", "error"]
    assert not result.passed and "too many links" in result.results[1].message


CAUSES = {
    "no rates": ("rates", "rates are not counted"),
    "sign of the payload": ("payload", "the payload"),
    "friction ignored": ("effects", "friction"),
}


@pytest.mark.one_in(6)
@pytest.mark.parametrize("fault", CAUSES)
@pytest.mark.parametrize("single", [False, True])
def test_the_cause_is_named(fault: str, single: bool) -> None:
    level, words = CAUSES[fault]
    planted = PLANTED[fault][0]

    class Rounded(planted):  # type: ignore[misc]
        def evaluate(self, batch: Batch) -> Evaluation:
            values = super().evaluate(batch).values
            return Evaluation({key: x.astype(np.float32) if single else x for key, x in values.items()})

    result = conform(Rounded, levels=["gravity", level], n_states=16)
    assert result.precision == ("float32" if single else "float64")
    assert [own.outcome for own in result.results] == ["pass", "fail"]
    assert words in result.results[1].cause


@pytest.mark.slow
def test_each_kind_of_failure_is_looked_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    from rttrr_pin.conformance import causes

    asked = []
    whole_search = causes.diagnose_at

    def counted(batch: Batch, subject: Any, **how: Any) -> Any:
        asked.append(how.get("ids"))
        return whole_search(batch, subject, **how)

    monkeypatch.setattr(causes, "diagnose_at", counted)
    result = conform(PLANTED["no rates"][0], levels=["rates", "prismatic", "fast", "sixty"], n_states=8)
    assert len(asked) == 5 and asked.count(None) == 1
    assert {own.cause for own in result.results} == {"rates are not counted: tau has no velocity terms"}


def test_no_cause_is_unexplained(monkeypatch: pytest.MonkeyPatch) -> None:
    """After some robots all hypotheses are not tried again."""
    from rttrr_pin.conformance import causes

    asked = []
    search = causes.diagnose_at

    def two_hypotheses(batch: Batch, subject: Any, **how: Any) -> Any:
        asked.append(batch.model.name)
        return search(batch, subject, ids=["rates ignored", "gravity missing"])

    def spoil(batch: Batch) -> Batch:
        return replace(batch, a=np.sin(7.0 * batch.q[:, : batch.a.shape[1]]) * (batch.a != 0.0))

    monkeypatch.setattr(causes, "diagnose_at", two_hypotheses)
    levels = ["accelerations", "payload", "prismatic", "mimic", "fast"]
    result = conform(program(spoil, quantities=("tau",)), levels=levels, n_states=4)
    assert all(own.cause.startswith("unexplained") for own in result.results)
    assert asked == ["arm6", "rttrr"]


def test_without_diagnosis_there_is_no_cause() -> None:
    result = conform(PLANTED["no rates"][0], levels=["rates"], n_states=4, diagnose=False)
    assert result.results[0].cause == "" and not result.passed


def test_the_result_is_data() -> None:
    result = conform(SingleRecursion, levels=["gravity", "cancelling"], n_states=np.int64(4), seed=np.int64(3))  # type: ignore[arg-type]
    data = json.loads(json.dumps(result.to_dict(), allow_nan=False))
    assert data["schema"] == 1 and data["passed"] and data["precision"] == "float32"
    assert [own["id"] for own in data["results"]] == ["gravity-arm6", "cancelling-arm6", "cancelling-rttrr"]
    assert isinstance(result, Conformance) and re.fullmatch(r"<Conformance: PASS single: level 1 .*>", repr(result))


def test_progress_counts_what_is_judged_and_explained() -> None:
    seen: list[int] = []
    conform(PLANTED["no rates"][0], levels=["gravity", "rates"], n_states=4, progress=seen.append)
    assert seen == [1, 2, 3]


def test_own_robots_have_their_names() -> None:
    result = conform("recursion", [load("rttrr")], ["gravity"], n_states=2)
    assert result.own_robots and result.robots == ("rttrr",)
    assert result.claim().startswith("rttrr: level 1 of 14 (gravity); not asked: rates")
