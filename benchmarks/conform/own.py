"""Our own two programs: the reference recursion and the compiled kernel, timed as users call them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

from rttrr_pin.conformance import cases

OWN = {
    "recursion": "robot.inverse_dynamics(q, v, a), with F, N, f, n",
    "kernel": "kernel = robot.compile(); kernel(q, v, a)",
}
"""Names of implementations, and the call that is timed."""

SHORTEST, REPEATS = 0.02, 3


def own_times(name: str, robot_name: str, counts: Sequence[int]) -> dict[str, Any]:
    """Nanoseconds a state, by number of states."""
    import numpy as np

    found: dict[str, Any] = {}
    case = next(case for case in cases(levels=["accelerations"], n_states=256) if case.name == robot_name)
    run: Callable[..., Any] = case.robot.compile() if name == "kernel" else case.robot.inverse_dynamics
    for count in counts:
        at = np.arange(count) % len(case.batch)
        q, v, a = (x[at] if count > 1 else x[0] for x in (case.batch.q, case.batch.v, case.batch.a))
        run(q, v, a)
        calls = max(1, round(SHORTEST / max(seconds(run, q, v, a), 1e-6)))
        times = [seconds(run, q, v, a, calls=calls) / count for _ in range(REPEATS)]
        found[str(count)] = {"ns": 1e9 * min(times), "states": count}
    return found


def seconds(run: Callable[..., Any], *args: Any, calls: int = 1) -> float:
    """The mean processor time of a call [s]."""
    start = time.process_time()
    for _ in range(calls):
        run(*args)
    return (time.process_time() - start) / calls
