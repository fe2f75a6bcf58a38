"""What a failing test says: what is wrong, where and by how much; the cause, its repair, and a test to paste."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from rttrr_pin.conformance.causes import InPrecision
from rttrr_pin.conformance.judging import PRECISIONS, Wanted, judge
from rttrr_pin.conformance.levels import LEVELS, Case, Level, cases
from rttrr_pin.conformance.results import LevelResult
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import batch_shape
from rttrr_pin.core.inputs import check_quaternions, coordinates
from rttrr_pin.core.payload import RandomPayload
from rttrr_pin.diagnosis.report import place, told
from rttrr_pin.diagnosis.results import Cause, Diagnosis
from rttrr_pin.diagnosis.run import diagnose as find_causes
from rttrr_pin.diagnosis.run import diagnose_at
from rttrr_pin.errors import InputError, RttrrError
from rttrr_pin.implementations import Batch, Implementation, label, make_implementation
from rttrr_pin.implementations.registry import Source
from rttrr_pin.loading import load
from rttrr_pin.robot import Robot
from rttrr_pin.validation.states import model_of

KEPT = 8
"""Diagnoses that are kept: checks of one program fail together, and mostly for one cause."""

STATES = 100
"""Telling states on which a cause is looked for."""

OTHERS = 4
"""Causes that would give the same results, and are told."""

_kept: dict[tuple[int, int, bool], tuple[object, object, str]] = {}


def assert_inverse_dynamics(
    subject: Source,
    robot: Robot | str | os.PathLike[str] = "rttrr",
    states: Sequence[Any] | None = None,
    levels: Sequence[str] | None = None,
    n_states: int = 32,
    seed: int = 0,
    precision: Wanted = "auto",
    diagnose: bool = True,
) -> None:
    """Assert that a program's inverse dynamics are right, to rounding, against proven values.

    Args:
        subject: the program: a function f(q, v, a) of one state or a batch that returns tau, or a dict of some of tau,
            F, N, f, n; or whatever else `validate` takes.
        robot: the robot, or what `load` takes.
        states: q, v, a to ask it at, of one state or a batch; None for the states of the levels.
        levels: ids of the levels that are asked (`LEVELS`); None for all that apply to the robot.
        n_states: states of each level.
        seed: of the states.
        precision: "float64" or "float32", in whose rounding it is judged; "auto" finds it out from its numbers.
        diagnose: whether the message says why; that takes some seconds.

    Raises:
        AssertionError: a number is off by more than rounding explains. The message says which and, where it is found,
            the cause, its repair, and a state as simple as could be found, as a test.
        InputError: an argument cannot be used.
        ImplementationError: the program is missing, fails, or offers none of the levels.
    """
    __tracebackhide__ = True
    own = robot if isinstance(robot, Robot) else load(robot)
    program = make_implementation(subject, model_of(own, "there is nothing to ask"))
    asked = cases([own], levels, n_states, seed) if states is None else [_given(own, states)]
    results = [judge(case, program, precision) for case in asked]
    failed = [pair for pair in zip(asked, results, strict=True) if pair[1].failed]
    if failed:
        message = of_levels(subject, program, failed, [one.level for one in results if one.passed], diagnose)
        raise AssertionError(message)
    if not any(one.passed for one in results):
        raise InputError(f"{program.name} offers none of {', '.join(one.level for one in results)}: nothing was asked")


def _given(robot: Robot, states: Sequence[Any]) -> Case:
    """States of the user's own as a case."""
    if len(states) != 3:
        raise InputError(f"states has {len(states)} entries: expected three, q, v and a")
    model = robot.model
    q, v, a = (coordinates(name, x, model.moving) for name, x in zip("qva", states, strict=True))
    check_quaternions(q, model.moving)
    q, v, a = _rows(q, v, a)
    batch = Batch(model, q, v, a)
    level = Level("given", "States of the user's own.", (), lambda model: True, lambda model, count, seed: batch)
    return Case(level, robot.name, robot, batch)


def _rows(*arrays: Array) -> list[Array]:
    """As many rows in each."""
    rows = batch_shape(arrays, ())
    return [np.broadcast_to(x, (*rows, x.shape[-1])).reshape(-1, x.shape[-1]) for x in arrays]


def of_levels(
    subject: Source,
    program: Implementation,
    failed: Sequence[tuple[Case, LevelResult]],
    passed: Sequence[str] = (),
    diagnose: bool = True,
) -> str:
    """The message of levels that failed."""
    case = failed[0][0]
    head = [f"{label(program)} does not compute the inverse dynamics of {case.name}:"]
    head += [f"  {_told(own, result)}" for own, result in failed]
    if passed:
        head.append(f"  within rounding: {', '.join(passed)}")
    wrong = [(own, result) for own, result in failed if result.outcome == "fail"]
    if not wrong:
        return "\n".join(head)
    worst, result = wrong[0]
    judged = InPrecision(program, PRECISIONS[result.precision])
    payload = all(own.batch.loads for own, _ in wrong)
    why = reason(subject, judged, case.robot, payload) if diagnose else ""
    if diagnose and not why:  # it shows in states such as these alone
        why = _told_of(lambda: diagnose_at(worst.batch, judged))
    return "\n".join([*head, why or _state(worst, result)])


def _told(case: Case, result: LevelResult) -> str:
    """An outcome in one line."""
    given = case.level not in LEVELS
    name = "at the states that were passed" if given else f"level {case.level.id} ({case.level.sentence.rstrip('.')})"
    if result.worst is None:
        return f"{name}: {result.message}"
    quantity, value = result.worst
    count, of = (sum(getattr(own, key) for own in result.quantities) for key in ("failures", "count"))
    error = "is no number" if np.isinf(value.error) else f"is off by {value.error:.3g} {value.unit}"
    return (
        f"{name}: {count:,} of {of:,} numbers are beyond rounding; {quantity} of {value.at} in state {value.state} "
        f"{error}, {value.of_allowance:.2g} times what rounding explains"
    )


def _state(case: Case, result: LevelResult) -> str:
    """The worst state, to be asked again."""
    assert result.worst is not None
    k, batch = result.worst[1].state, case.batch
    numbers = ", ".join(f"{name}={getattr(batch, name)[k].tolist()}" for name in "qva")
    loads = "".join(
        f", payload at {batch.model.link_names[own.link]}: f={_row(own.f, k)}, n={_row(own.n, k)}"
        for own in batch.loads
    )
    return f"state {k} of {batch.model.name}: {numbers}{loads}"


def _row(x: Array, k: int) -> list[float]:
    return np.asarray(x if x.ndim == 1 else x[k]).tolist()  # type: ignore[no-any-return]


def reason(subject: Source, program: Implementation, robot: Robot, payload: bool = False) -> str:
    """Why a program differs from the reference recursion, in lines; those of the last programs are kept."""
    key = (id(subject), id(robot.model), payload)
    if key not in _kept:
        while len(_kept) >= KEPT:
            _kept.pop(next(iter(_kept)))
        load = RandomPayload() if payload else None
        why = _told_of(lambda: find_causes(robot, program, "recursion", STATES, payload=load))
        _kept[key] = subject, robot.model, why  # both are held, so that no other has their id
    return _kept[key][2]


def _told_of(diagnosis: Callable[[], Diagnosis]) -> str:
    try:
        return "\n".join(_lines(diagnosis()))
    except RttrrError as error:
        return f"it could not be found out why: {error}"


def _lines(found: Diagnosis) -> list[str]:
    """The causes, or what the difference depends on; and a test."""
    if found.passed:
        return []
    lines = [line for cause in found.causes for line in _cause(cause, len(found.causes) > 1)]
    if not found.causes:
        lines = ["no cause of the catalogue explains it:", *(f"  - {line}" for line in found.dependence)]
        lines += [f"  - {near.explains:.1%} of it would be: {near.sentence}" for near in found.near_misses[:2]]
    if found.counterexample:
        lines += ["a state as simple as could be found, as a test:", *_indented(found.counterexample)]
    return lines


def _cause(cause: Cause, several: bool) -> list[str]:
    lines = [f"cause{': one of several' if several else ''}: {told(cause)}", f"repair: {cause.repair}"]
    if where := place(cause):
        lines.append(f"see {where}")
    if cause.alternatives:
        lines.append("the same results would come of:")
        lines += [f"  - {own.sentence}" for own in cause.alternatives[:OTHERS]]
        more = len(cause.alternatives) - OTHERS
        lines += [f"  - and {more} more"] if more > 0 else []
    return lines


def _indented(text: str) -> list[str]:
    return [f"  {line}" for line in text.splitlines()]
