"""Claim: one state from Python costs less than Pinocchio's `rnea`, and all wrenches less than reading `data.f`.

Run: python benchmarks/kernel_one.py [--repeats N] [--save]. Microseconds a call, as the README writes it, in turns with
Pinocchio, medians of repeats; results are compared before anything is timed. Also: peak memory of a batch against its
size.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import timeit
from collections.abc import Callable
from typing import Any

import numpy as np
import pinocchio

import rttrr_pin
from common import arguments, finish
from rttrr_pin import Robot

ROBOTS = ("rttrr", "example:ur5_robot", "example:panda", "example:talos_reduced")

CALLS = 1000

STATES = (10_000, 100_000, 1_000_000, 3_000_000)

REFERENCES = {
    "kernel(q, v, a)": "pin.rnea",
    "kernel(q, v, a, out=out)": "pin.rnea",
    "kernel(q, v, a, payload=w)": "pin.rnea",
    "robot.inverse_dynamics(q, v, a)": "pin.rnea and data.f",
    "robot.mass_matrix(q)": "pin.crba",
}
"""Calls, and what of Pinocchio each is compared with."""

MEMORY = """
import resource, sys
import numpy as np
import rttrr_pin
robot = rttrr_pin.load("rttrr")
kernel = robot.compile()
N = int(sys.argv[1])
q, v, a, out = (np.full((N, 5), 0.1) for _ in range(4))
kernel(q[:1], v[:1], a[:1], out=out[:1])
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
kernel(q, v, a, out=out, threads=2)
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024)
"""


def one_state(robot: Robot, repeats: int) -> dict[str, Any]:
    """Microseconds of one call, ours and Pinocchio's in turns."""
    model = pinocchio.buildModelFromXML(robot.model.urdf, mimic=True)
    data = model.createData()
    q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, robot.model.nv))
    kernel, wrench = robot.compile(), rttrr_pin.Wrench((0, 0, 20), link=robot.link_names[-1])
    out = kernel(q, v, a)
    pq = _configuration(model, q)
    reference = pinocchio.rnea(model, data, pq, v, a)
    difference = np.linalg.norm(out - reference) / np.linalg.norm(reference)

    def wrenches() -> list[Any]:
        pinocchio.rnea(model, data, pq, v, a)
        return [data.f[i].vector for i in range(1, model.njoints)]

    times = _in_turns(
        {
            "kernel(q, v, a)": lambda: kernel(q, v, a),
            "kernel(q, v, a, out=out)": lambda: kernel(q, v, a, out=out),
            "pin.rnea": lambda: pinocchio.rnea(model, data, pq, v, a),
            "kernel(q, v, a, payload=w)": lambda: kernel(q, v, a, payload=wrench),
            "robot.inverse_dynamics(q, v, a)": lambda: robot.inverse_dynamics(q, v, a),
            "pin.rnea and data.f": wrenches,
            "robot.mass_matrix(q)": lambda: robot.mass_matrix(q),
            "pin.crba": lambda: pinocchio.crba(model, data, pq),
        },
        repeats,
    )
    ratios = {name: times[name] / times[reference] for name, reference in REFERENCES.items()}
    return {
        "robot": robot.name,
        "normwise_difference": float(difference),
        "us": times,
        "ratios": ratios,
        "ratio_tau": 1.0 / ratios["kernel(q, v, a)"],
        "ratio_all": 1.0 / ratios["robot.inverse_dynamics(q, v, a)"],
    }


def _configuration(model: Any, q: np.ndarray) -> np.ndarray:
    """Pinocchio's q: cosine and sine of a joint that turns without end."""
    parts = []
    for joint in list(model.joints)[1:]:
        x = q[joint.idx_v]
        parts += [x] if joint.nq == 1 else [np.cos(x), np.sin(x)] if joint.nq == 2 else []
    return np.array(parts)


def _in_turns(calls: dict[str, Callable[[], Any]], repeats: int) -> dict[str, float]:
    """Medians [us]."""
    times: dict[str, list[float]] = {name: [] for name in calls}
    for call in calls.values():
        call()
    for _ in range(repeats):
        for name, call in calls.items():
            times[name].append(timeit.timeit(call, number=CALLS) / CALLS * 1e6)
    return {name: statistics.median(found) for name, found in times.items()}


def peak(states: int) -> float:
    """MiB that a batch takes beyond its inputs and outputs."""
    done = subprocess.run([sys.executable, "-c", MEMORY, str(states)], capture_output=True, text=True, check=True)
    return float(done.stdout)


def main() -> None:
    parser = arguments(__doc__ or "")
    parser.add_argument("--repeats", type=int, default=101)
    options = parser.parse_args()
    figures = {
        "repeats": options.repeats,
        "references": REFERENCES,
        "robots": [one_state(rttrr_pin.load(name), options.repeats) for name in ROBOTS],
        "memory_beyond_arrays_mib": {f"{states:,} states": peak(states) for states in STATES},
    }
    finish("kernel_one", figures, options.save)


if __name__ == "__main__":
    main()
