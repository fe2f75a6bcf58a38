"""Which rows are kept and which is the worst, whatever the size of the blocks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import InputError
from rttrr_pin.core.payload import Load
from rttrr_pin.validation.comparison import Run
from rttrr_pin.viewing import recording
from rttrr_pin.viewing.recording import Rows, by_difference, by_torque, record, recorded, sampled
from support.viewed import MASSLESS, Swing


def rows(values: list[float]) -> Rows:
    n = len(values)
    q = np.array(values).reshape(n, 1)
    moment = np.arange(3.0 * n).reshape(n, 3)
    loads = (Load(0, np.ones(3), moment), Load(1, moment, np.zeros(3)))
    return Rows(np.arange(n, dtype=np.int64) + 5, np.arange(n) * 0.1, q, q, q, loads)


def by_q(own: Rows) -> tuple[np.ndarray, Callable[[int], str]]:
    return own.q[:, 0], lambda k: f"q is {own.q[k, 0]}"


@pytest.mark.parametrize("size", [1, 3, 7, 64, 1000])
@pytest.mark.parametrize("kept", [4, 9, 100, 1000])
def test_what_is_kept_does_not_depend_on_blocks(size: int, kept: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recording, "KEPT", kept)
    values = np.random.default_rng(1).normal(size=101).tolist()
    whole = rows(values)
    made = recorded("x", (whole.taken(slice(k, k + size)) for k in range(0, 101, size)), by_q)
    worst = int(np.argmax(values))
    stride = next(2**n for n in range(10) if -(-101 // 2**n) <= kept)
    wanted = sorted({*range(0, 101, stride), worst})
    assert (made.rows.row - 5).tolist() == wanted
    assert made.rows.row[made.worst] - 5 == worst and made.why == f"q is {values[worst]}"
    assert made.total == 101 and bool(made.note) == (len(wanted) < 101)
    state = made.rows.state(made.worst)
    assert state.q == values[worst]
    assert state.loads[0].n.tolist() == state.loads[1].f.tolist() == [3 * worst, 3 * worst + 1, 3 * worst + 2]


def test_the_first_of_equals_and_what_is_no_number_is_the_worst() -> None:
    assert recorded("x", [rows([1, 2, 2])], by_q).worst == 1
    assert recorded("x", (rows([1, 2, 2]).taken(slice(k, k + 1)) for k in range(3)), by_q).worst == 1
    assert recorded("x", [rows([1, float("nan"), 5, float("nan")])], by_q).worst == 1
    assert recorded("x", [rows([-3, -1, -2])], by_q).worst == 1


def test_no_row_is_an_error() -> None:
    with pytest.raises(InputError, match="empty.csv has no row"):
        recorded("empty.csv", [], by_q)


def test_the_row_at_a_time() -> None:
    made = recorded("x", [rows([1, 2, 3])], by_q)
    assert [made.at(t) for t in (-1, 0, 0.05, 0.1, 0.15, 0.2, 9)] == [0, 0, 0, 1, 1, 2, 2]
    assert made.place(1) == "row 6, t = 0.1000 s"


def test_the_worst_state_uses_most_of_a_limit() -> None:
    robot = rttrr_pin.load("rttrr")
    swing = Swing(robot)
    made = record(swing, by_torque(robot))
    tau = robot.inverse_dynamics(swing.q, swing.v, swing.a).tau
    share = np.abs(tau) / [joint.limits.effort for joint in robot.model.moving]
    k, j = np.unravel_index(np.argmax(share), share.shape)
    assert (made.worst, made.rows.row[made.worst]) == (k, k + 2)
    assert robot.joint_names[j] in made.why and f"{share[k, j]:.1%}" in made.why


def test_without_limits_it_is_the_largest() -> None:
    robot = rttrr_pin.load(MASSLESS)
    made = record(Swing(robot), by_torque(robot))
    assert made.why == "tau of j is 0 N m, the largest"


def test_two_programs_differ_most_where_validate_says() -> None:
    robot = rttrr_pin.load("rttrr")
    run = Run.of(robot, "recursion", "kernel", 0, "uniform", None)
    swing = Swing(robot)
    made = record(swing, by_difference(run))
    rows_ = Rows(np.arange(101), swing.time, swing.q, swing.v, swing.a)
    values, sentence = by_difference(run)(rows_)
    assert made.worst == int(np.argmax(values)) and made.why == sentence(made.worst)
    assert 0.0 < values.max() <= 1.0


def test_without_a_trajectory_it_is_one_of_the_states_of_validate() -> None:
    robot = rttrr_pin.load("rttrr")
    wrong = lambda q, v, a: robot.inverse_dynamics(q, v, a).tau * (1.0 + 1e-9 * np.abs(q[..., :1]))
    made = sampled(Run.of(robot, wrong, "kernel", 0, "uniform", None))
    report = rttrr_pin.validate(robot, wrong, "kernel", n_states=recording.SAMPLED)
    worst = max((row.of_tolerance for row in report.rows), key=lambda own: own.value)
    assert made.rows.row[made.worst] == worst.state and made.place(made.worst) == f"state {worst.state}"
    assert made.rows.time is None and made.total == recording.SAMPLED
