"""The umpire: what a state costs, and how far ours and Pinocchio are off the true values.

Errors are distances to the enclosure in eps of the norm of the true vector (for a torque, of the n or f of its joint),
over all links; the median, the 99.9 % quantile and the worst of the states, and in how many of them which program is
nearer. Ours is what `validate` takes for as many states. The truth is
that of the file's doubles. Before anything is timed, the enclosures of the recorded operations are compared with those
of the recursion run directly on balls, and no error of ours may exceed its bound, nor one of Pinocchio's its allowance.

    python benchmarks/umpire.py --save
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import rttrr_pin
from common import arguments, finish
from rttrr_pin import Robot
from rttrr_pin.errors import InputError
from rttrr_pin.exact import Enclosures, enclose
from rttrr_pin.exact.adjudication import nearest
from rttrr_pin.exact.enclosures import STRAIGHT_LINE_FROM
from rttrr_pin.implementations import Batch, Evaluation, make_implementation
from rttrr_pin.validation import Sampler
from rttrr_pin.validation.compare import Comparison

ROBOTS = {"rttrr": "RTTRR", "example:panda": "Panda with fingers", "example:talos_reduced": "Talos reduced"}

TIMED, REPEATS = 500, 5

Array = NDArray[np.float64]


def main() -> None:
    parser = arguments(__doc__.splitlines()[0])
    parser.add_argument("--states", type=int, default=150_000, help="states whose errors are measured")
    options = parser.parse_args()
    figures: dict[str, Any] = {"states": options.states, "robots": {}}
    for source, name in ROBOTS.items():
        try:
            robot = rttrr_pin.load(source)
        except InputError as error:
            print(f"{name} is left out: {error}")
            continue
        figures["robots"][name] = {"errors_eps": errors(robot, options.states), "ms_a_state": cost(robot)}
    finish("umpire", figures, options.save)


def errors(robot: Robot, count: int) -> dict[str, Any]:
    """Figures of each program, by quantity; of a state the largest over all links or joints."""
    drawn = Sampler(robot.model, payload=rttrr_pin.RandomPayload(robot.link_names[-1])).draw(0, count)
    arrays = (drawn.q, drawn.v, drawn.a, drawn.loads)
    enclosures = enclose(robot.model, *arrays, "read")
    out: dict[str, Any] = {
        "bits": {str(bits): int((enclosures.bits == bits).sum()) for bits in set(enclosures.bits)},
    }
    largest: dict[str, dict[str, Array]] = {}
    for program in ("kernel", "pinocchio"):
        computed = make_implementation(program, robot.model).evaluate(drawn)
        comparison = Comparison(robot.model)
        values = nearest(enclosures, computed.values)
        truth = Evaluation(values, {key: np.zeros(x.shape[:2]) for key, x in values.items()}, computed.tau_joint)
        differences = comparison.differences(drawn, computed, truth)
        by_quantity: dict[str, list[Array]] = {}
        for row, one in zip(comparison.rows, differences, strict=True):
            if (one.error > one.of_subject).any():
                raise SystemExit(f"{program} is beyond its allowance in {row.quantity} at {row.at}")
            by_quantity.setdefault(row.quantity, []).append(one.relative)
        largest[program] = {quantity: np.max(columns, axis=0) for quantity, columns in by_quantity.items()}
        out[program] = {quantity: _figures(eps) for quantity, eps in largest[program].items()}
    for nearer, farther in (("kernel", "pinocchio"), ("pinocchio", "kernel")):
        pairs = zip(largest[nearer].items(), largest[farther].values(), strict=True)
        out[f"{nearer}_nearer"] = {quantity: round(float((one < other).mean()), 3) for (quantity, one), other in pairs}
    return out


def _figures(eps: Array) -> dict[str, float]:
    return {
        "median": round(float(np.median(eps)), 2),
        "p999": round(float(np.quantile(eps, 0.999)), 1),
        "worst": round(float(eps.max()), 1),
    }


def cost(robot: Robot) -> dict[str, float]:
    """Of one state: in a batch, one at a time, and what recording the operations takes once."""
    drawn = Sampler(robot.model).draw(0, TIMED)
    few = Sampler(robot.model).draw(0, STRAIGHT_LINE_FROM - 1)
    start = time.perf_counter()
    batch = _certified(robot, drawn)
    first = time.perf_counter() - start
    alone = _certified(robot, few)
    for key, ends in alone.items():
        same = getattr(batch, key)[: len(few.q)]
        if not ((ends.lower <= same.upper) & (same.lower <= ends.upper)).all():
            raise SystemExit(f"enclosures of {key} have nothing in common")
    each = _median(lambda: _certified(robot, drawn)) / TIMED
    return {
        "batch": round(1e3 * each, 3),
        "directly": round(1e3 * _median(lambda: _certified(robot, few)) / len(few.q), 3),
        "recording_once": round(1e3 * (first - each * TIMED), 1),
    }


def _certified(robot: Robot, drawn: Batch) -> Enclosures:
    return enclose(robot.model, drawn.q, drawn.v, drawn.a)


def _median(work: Callable[[], object]) -> float:
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds)


if __name__ == "__main__":
    main()
