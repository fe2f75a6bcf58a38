"""How far the kernel and Pinocchio are from the true values, and what an enclosure of these costs.

Errors are distances to the enclosure in eps of the norm of the true vector (for a torque, of the n or f of its joint),
over all links: the median, the 99.9 % quantile and the worst of the states, and the share of states in which either
program is nearer. The true values are those of the file's doubles. No error may exceed the program's own allowance, and
before anything is timed, enclosures by the straight-line program are compared with those by the recursion itself.

    python benchmarks/accuracy.py --save
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
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.errors import InputError
from rttrr_pin.exact import Enclosures, enclose
from rttrr_pin.exact.adjudication import nearest
from rttrr_pin.exact.enclosures import STRAIGHT_LINE_FROM
from rttrr_pin.implementations import Batch, Evaluation, make_implementation
from rttrr_pin.validation import Comparison, Sampler

ROBOTS = {"rttrr": "RTTRR", "example:panda": "Panda with fingers", "example:talos_reduced": "Talos reduced"}

PROGRAMS = ("kernel", "pinocchio")

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
    finish("accuracy", figures, options.save)


def errors(robot: Robot, count: int) -> dict[str, Any]:
    """Figures of each program, by quantity; of a state the largest over all links or joints."""
    batch = Sampler(robot.model, payload=RandomPayload(robot.link_names[-1])).draw(0, count)
    enclosures = enclose(robot.model, batch.q, batch.v, batch.a, batch.loads, "read")
    bits = {str(bits): int((enclosures.bits == bits).sum()) for bits in set(enclosures.bits)}
    largest = {program: distances(robot, batch, enclosures, program) for program in PROGRAMS}
    out: dict[str, Any] = {"bits": bits} | {
        program: {quantity: _figures(eps) for quantity, eps in by_quantity.items()}
        for program, by_quantity in largest.items()
    }
    for nearer, farther in (PROGRAMS, PROGRAMS[::-1]):
        out[f"{nearer}_nearer"] = {
            quantity: round(float((eps < largest[farther][quantity]).mean()), 3)
            for quantity, eps in largest[nearer].items()
        }
    return out


def distances(robot: Robot, batch: Batch, enclosures: Enclosures, program: str) -> dict[str, Array]:
    """By quantity, the largest distance from the true values of each state, in eps."""
    computed = make_implementation(program, robot.model).evaluate(batch)
    true = nearest(enclosures, computed.values)
    exact = {key: np.zeros(x.shape[:2]) for key, x in true.items()}
    comparison = Comparison(robot.model)
    by_quantity: dict[str, list[Array]] = {}
    differences = comparison.differences(batch, computed, Evaluation(true, exact, computed.tau_joint))
    for row, difference in zip(comparison.rows, differences, strict=True):
        if (difference.of_tolerance > 1.0).any():
            raise SystemExit(f"{program} is beyond its allowance in {row.quantity} at {row.at}")
        by_quantity.setdefault(row.quantity, []).append(difference.relative)
    return {quantity: np.max(columns, axis=0) for quantity, columns in by_quantity.items()}


def _figures(eps: Array) -> dict[str, float]:
    return {
        "median": round(float(np.median(eps)), 2),
        "p999": round(float(np.quantile(eps, 0.999)), 1),
        "worst": round(float(eps.max()), 1),
    }


def cost(robot: Robot) -> dict[str, float]:
    """Milliseconds for one state: in a batch, alone, and for recording the straight-line program once."""
    many, few = (Sampler(robot.model).draw(0, count) for count in (TIMED, STRAIGHT_LINE_FROM - 1))
    start = time.perf_counter()
    batch = _enclosed(robot, many)
    first = time.perf_counter() - start
    for key, ends in _enclosed(robot, few).items():
        same = getattr(batch, key)[: len(few)]
        if not ((ends.lower <= same.upper) & (same.lower <= ends.upper)).all():
            raise SystemExit(f"enclosures of {key} have nothing in common")
    each = _median(lambda: _enclosed(robot, many)) / TIMED
    return {
        "batch": round(1e3 * each, 3),
        "directly": round(1e3 * _median(lambda: _enclosed(robot, few)) / len(few), 3),
        "recording_once": round(1e3 * (first - each * TIMED), 1),
    }


def _enclosed(robot: Robot, batch: Batch) -> Enclosures:
    return enclose(robot.model, batch.q, batch.v, batch.a)


def _median(work: Callable[[], object]) -> float:
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds)


if __name__ == "__main__":
    main()
