"""Claim: `validate` costs a few times what Pinocchio's arithmetic costs: all five quantities, allowances, adjudication.

Each robot is validated and `rneaInParallel` runs on one thread at the same states, in turns in this process, after both
have run once. Times are of the processor, all threads together, so that what else the machine does counts little; the
clock may differ from run to run, and the quotient is what stands. Then the whole command, from outside.

Run: python benchmarks/validate_speed.py [--states N] [--repeats N] [--million N] [--save].
Exit 1 if one disagrees.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio as pin

from common import arguments, finish
from rttrr_pin import Robot, load
from rttrr_pin.implementations.library import Motion, own_states
from rttrr_pin.implementations.pinocchio import Pinocchio, _in_cosines
from rttrr_pin.validation import Sampler, validate

ROBOTS = {"RTTRR": "rttrr", "Panda with fingers": "example:panda", "Talos reduced": "example:talos_reduced"}


def measure(robot: Robot, states: int, repeats: int) -> dict[str, Any]:
    """Microseconds of the processor for a state, in a validation and in `rneaInParallel`."""
    recursion = pinocchio(robot, states)
    passed = validate(robot, n_states=states).passed
    recursion()
    times: dict[str, list[float]] = {"validate": [], "rneaInParallel": []}
    for _ in range(repeats):
        times["validate"].append(seconds(lambda: validate(robot, n_states=states)) / states * 1e6)
        times["rneaInParallel"].append(seconds(recursion) / states * 1e6)
    quotients = [x / y for x, y in zip(*times.values(), strict=True)]
    return {
        "links": len(robot.link_names),
        "passed": passed,
        **{name: [round(f(own), 3) for f in (min, statistics.median)] for name, own in times.items()},
        "quotient": round(statistics.median(quotients), 1),
    }


def pinocchio(robot: Robot, states: int) -> Callable[[], object]:
    """The driving forces of the states that `validate` compares, on one thread."""
    program, batch = Pinocchio(robot.model), Sampler(robot.model).draw(0, states)
    model = program.pin_model
    # Joints that follow others move by themselves there, and angles without limits are cosine and sine.
    motion = Motion.of(program.joints, own_states(robot.model, batch), states, model.nq, model.nv, _in_cosines)
    q, v, a = (np.asfortranarray(x.T) for x in (motion.q, motion.v, motion.a))
    tau, pool = np.zeros_like(v, order="F"), pin.ModelPool(model, 1)
    return lambda: pin.rneaInParallel(1, pool, q, v, a, tau)


def seconds(work: Callable[[], object]) -> float:
    """What a call takes of the processor, all threads together."""
    start = time.process_time()
    work()
    return time.process_time() - start


def command(states: int) -> float:
    """Wall time [s] of `rttrr-pin validate`, process start included."""
    words = [sys.executable, "-m", "rttrr_pin", "validate", "--states", str(states), "--quiet"]
    start = time.perf_counter()
    subprocess.run(words, check=True)
    return time.perf_counter() - start


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--states", type=int, default=50_000)
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument("--million", type=int, default=3, help="how often the command runs")
    chosen = parser.parse_args()
    rows = [{"robot": name, **measure(load(source), chosen.states, chosen.repeats)} for name, source in ROBOTS.items()]
    command(1000)  # fills the disk cache
    walls = sorted(round(command(1_000_000), 2) for _ in range(chosen.million))
    figures = {
        "states": chosen.states,
        "columns": "of times: least and median [us], of the processor",
        "rows": rows,
        "million_wall_s": walls,
    }
    finish("validate_speed", figures, chosen.save)
    return int(not all(row["passed"] for row in rows))


if __name__ == "__main__":
    sys.exit(main())
