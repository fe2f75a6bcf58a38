"""Tables show what the API returns, and no name becomes markup."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

import rttrr_pin
from rttrr_pin import Wrench
from rttrr_pin.core.payload import loads_of
from rttrr_pin.validation.comparison import Run
from rttrr_pin.viewing.evaluation import DIFFERENCE, Evaluator
from rttrr_pin.viewing.numbers import digits, joint_table, link_table, quantities_missing, state_in_python
from rttrr_pin.viewing.states import at_rest
from support.viewed import AWKWARD, random_state


def cells(markup: str) -> list[list[str]]:
    rows = re.findall(r"<tr>(.*?)</tr>", markup)
    return [[re.sub(r"<.*?>", "", cell) for cell in re.findall(r"<td>(.*?)</td>", row)] for row in rows][1:]


def test_six_digits() -> None:
    assert [digits(x) for x in (0.0, -0.0, 1.0, -1234567.0, 1e-14 / 3, np.pi, float("nan"))] == [
        "0", "0", "1", "-1.23457e+06", "3.33333e-15", "3.14159", "nan",
    ]  # fmt: skip


def test_tables_are_those_of_the_api() -> None:
    robot = rttrr_pin.load("rttrr")
    state = random_state(robot)
    result = robot.inverse_dynamics(state.q, state.v, state.a)
    numbers = Evaluator(robot)(state)
    for k, row in enumerate(cells(joint_table(robot.model, state, numbers))):
        assert row[0] == robot.joint_names[k] and row[5] == ("N m" if robot.model.rotations[k] else "N")
        assert row[1:5] == [digits(x) for x in (state.q[k], state.v[k], state.a[k], result.tau[k])]
        assert row[6] == f"{abs(result.tau[k]) / robot.model.joints[k].limits.effort:.0%}"
    for i in range(len(robot.link_names)):
        for row in cells(link_table(robot.model, i, dict(result.items()))):
            vector = getattr(result, row[0])[i]
            assert row[1:5] == [digits(x) for x in (*vector, np.linalg.norm(vector))]
            assert row[5] == {"f": "N", "F": "N", "n": "N m", "N": "N m"}[row[0]]


def test_the_call_in_python_gives_the_same_bits() -> None:
    robot = rttrr_pin.load("rttrr")
    wrenches = Wrench((1, 2, 3), (0.1, 0, 0), "link_4", "base"), Wrench((0, 0, 1.5))
    for loads in ((), loads_of(robot.model, wrenches[0]), loads_of(robot.model, wrenches)):
        state = replace(random_state(robot), loads=loads)
        again = eval(state_in_python(robot.model, state), {"robot": robot, "Wrench": Wrench})
        assert (again.tau == Evaluator(robot)(state).values["rttrr-pin"]["tau"]).all()


def test_names_never_become_markup() -> None:
    robot = rttrr_pin.load(AWKWARD)
    state = at_rest(robot.model)
    numbers = Evaluator(robot)(state)
    shown = joint_table(robot.model, state, numbers)
    shown += "".join(link_table(robot.model, i, numbers.values["rttrr-pin"], "<u>") for i in range(3))
    assert "<img" not in shown and "<script" not in shown and "<u>" not in shown
    assert "&lt;img src=x onerror=alert(1)&gt;" in shown and "&lt;script&gt;" in shown


def test_two_programs_and_their_difference() -> None:
    robot = rttrr_pin.load("rttrr")
    run = Run.of(robot, lambda q, v, a: 2.0 * robot.inverse_dynamics(q, v, a).tau, "kernel", 0, "uniform", None)
    numbers = Evaluator(robot, run)(random_state(robot))
    subject, reference, difference = numbers.values
    assert difference == DIFFERENCE and reference.startswith("kernel")
    values = numbers.values
    assert (values[DIFFERENCE]["tau"] == values[subject]["tau"] - values[reference]["tau"]).all()
    assert set(values[DIFFERENCE]) == {"tau"} and set(values[reference]) == {"tau", "F", "N", "f", "n"}
    assert "gives no F, N, f, n" in quantities_missing(numbers)
    assert "of what rounding explains" in numbers.worst
    for row, own in zip(
        cells(joint_table(robot.model, random_state(robot), numbers)), values[DIFFERENCE]["tau"], strict=True
    ):
        assert row[4] == digits(own)


def test_a_program_beside_itself_has_two_names() -> None:
    robot = rttrr_pin.load("rttrr")
    names = Evaluator(robot, Run.of(robot, "kernel", "kernel", 0, "uniform", None)).names
    assert len(set(names)) == 3
