"""Claim: `rttrr-pin diagnose` names one fault in 500 states of Panda within 10 s, of RTTRR within 3 s, start included.

The states are those of `rttrr-pin sample`, the results those of a program that has another tensor of one link, or
counts no gravity; each in a fresh process, medians of repeats.

Run: python benchmarks/diagnose_time.py [--repeats N] [--save]. Exit 1 if a cause is not named, or it takes longer.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import rttrr_pin
from common import arguments, finish
from rttrr_pin import Robot
from rttrr_pin.core.arrays import Array

MOST = {"rttrr": 3.0, "example:panda": 10.0}
"""Seconds."""

Fault = Callable[[Robot, Array, Array, Array], Array]


def tensor(robot: Robot, q: Array, v: Array, a: Array) -> Array:
    """The entry of a tensor that shows most is larger by 0.01 kg m^2."""
    Y = robot.regressor(q, v, a)
    sizes = np.abs(Y).sum(axis=(0, 1)).reshape(-1, 10)
    sizes[:, :4] = 0.0
    return np.asarray(robot.inverse_dynamics(q, v, a).tau + 0.01 * Y[..., int(np.argmax(sizes))])


def gravity(robot: Robot, q: Array, v: Array, a: Array) -> Array:
    """Gravity is not counted."""
    return np.asarray(robot.inverse_dynamics(q, v, a).tau - robot.gravity_torque(q))


FAULTS: dict[str, Fault] = {"a tensor": tensor, "gravity missing": gravity}


def table(name: str, fault: Fault, states: int, path: Path) -> None:
    """The results of a program with the fault, all digits."""
    command = ["rttrr-pin", "sample", name, "-n", str(states), "-o", str(path), "--payload", "none", "-q"]
    subprocess.run(command, check=True)
    header, *rows = path.read_text().splitlines()
    columns = header.split(",")
    robot = rttrr_pin.load(name)
    numbers = {key: [row.split(",")[k] for row in rows] for k, key in enumerate(columns)}
    names = {"q": robot.model.q_names, "v": robot.model.v_names, "a": robot.model.v_names}
    state = {key: np.array([numbers[f"{key}_{own}"] for own in names[key]], dtype=float).T for key in names}
    tau = fault(robot, state["q"], state["v"], state["a"])
    lines = [",".join([header, *(f"tau_{own}" for own in robot.model.v_names)])]
    lines += [",".join([row, *(f"{x:.17g}" for x in own)]) for row, own in zip(rows, tau.tolist(), strict=True)]
    path.write_text("\n".join(lines) + "\n")


def timed(name: str, path: Path) -> tuple[float, dict[str, Any]]:
    """Seconds of the command from start to end, and what it said."""
    out = path.with_suffix(".json")
    start = time.perf_counter()
    done = subprocess.run(["rttrr-pin", "diagnose", name, str(path), "--json", str(out), "-q"], check=False)
    seconds = time.perf_counter() - start
    assert done.returncode == 1, done.returncode
    return seconds, json.loads(out.read_text())


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--states", type=int, default=500)
    chosen = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for name in MOST:
            for what, fault in FAULTS.items():
                path = Path(folder) / "results.csv"
                path.unlink(missing_ok=True)
                table(name, fault, chosen.states, path)
                runs = [timed(name, path) for _ in range(chosen.repeats)]
                said = runs[0][1]
                rows.append(
                    {
                        "robot": name,
                        "fault": what,
                        "states": chosen.states,
                        "hypotheses": said["tried"],
                        "verdict": said["verdict"],
                        "named": [cause["sentence"] for cause in said["causes"]],
                        "seconds": statistics.median(seconds for seconds, _ in runs),
                    }
                )
    finish("diagnose_time", {"repeats": chosen.repeats, "rows": rows}, chosen.save)
    good = all(row["verdict"] == "explained" and row["seconds"] <= MOST[row["robot"]] for row in rows)  # type: ignore[index]
    return int(not good)


if __name__ == "__main__":
    sys.exit(main())
