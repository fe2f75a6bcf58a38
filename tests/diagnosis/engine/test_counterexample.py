"""The test that `diagnose` gives to paste: it runs, fails with the program that differs, and passes once that is mended."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from rttrr_pin import load
from rttrr_pin.diagnosis import diagnose
from support.serial_chains import EXAMPLES


@pytest.mark.one_in(2)
@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_the_pasted_test_tells_wrong_from_right(direction: float) -> None:
    """The expected value may have either sign."""
    robot = load(
        EXAMPLES["one-joint"].replace('name="joint_1"', 'name="j-1 \'&quot;"'),
        gravity=(direction, 2 * direction, 3 * direction),
    )

    def right(q: Any, v: Any, a: Any) -> Any:
        return robot.inverse_dynamics(q, v, a).tau

    def wrong(q: Any, v: Any, a: Any) -> Any:
        return 1.5 * right(q, v, a)

    code = diagnose(robot, wrong, n_states=20).counterexample
    passed = []
    for program in (right, wrong):
        own: dict[str, Any] = {"inverse_dynamics": lambda q, v, a, f=program: f(*map(np.array, (q, v, a)))}
        exec(code, own)
        [test] = [own[name] for name in own if name.startswith("test_")]
        try:
            test()
            passed.append(True)
        except AssertionError:
            passed.append(False)
    assert passed == [True, False]
    assert "- -" not in code


def test_the_pasted_test_is_for_the_program_that_is_wrong() -> None:
    """Where the reference is, a test of the subject would pass, and tell nothing."""
    robot = load(EXAMPLES["one-joint"])

    def doubled(q: Any, v: Any, a: Any) -> Any:
        return 2.0 * robot.inverse_dynamics(q, v, a).tau

    code = diagnose(robot, "recursion", reference=doubled, n_states=20).counterexample
    assert "# doubled" in code and "your program" not in code
    right = {"inverse_dynamics": lambda q, v, a: robot.inverse_dynamics(*map(np.array, (q, v, a))).tau}
    wrong = {"inverse_dynamics": lambda q, v, a: doubled(*map(np.array, (q, v, a)))}
    for own in (right, wrong):
        exec(code, own)
    next(own for name, own in right.items() if name.startswith("test_"))()
    with pytest.raises(AssertionError):
        next(own for name, own in wrong.items() if name.startswith("test_"))()
