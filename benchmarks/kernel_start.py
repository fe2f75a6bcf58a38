"""Claim: a robot is compiled within seconds, read from the cache in a moment, and importing the package costs little.

Run: python benchmarks/kernel_start.py [--repeats N] [--save]. Each figure is of fresh processes, medians of repeats:

- import: `import rttrr_pin`, which loads NumPy only when something is asked of it, and `import numpy`;
- compile: the first `kernel(q, v, a)` with an empty cache folder, everything that it imports included;
- cached: the same with the cache filled by the process before;
- commands: `rttrr-pin` from start to end, the cache filled, less `import numpy, pinocchio`; in turns.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from typing import Any

from common import arguments, finish

ROBOTS = ("rttrr", "example:ur5_robot", "example:panda", "example:talos_reduced")

FIRST_CALL = """
import sys, time
import numpy as np
import rttrr_pin
robot = rttrr_pin.load(sys.argv[1])
zeros = np.zeros(robot.model.nv)
start = time.perf_counter()
robot.compile()(np.zeros(robot.model.nq), zeros, zeros)
print(time.perf_counter() - start)
"""

IMPORT = """
import sys, time
start = time.perf_counter()
__import__(sys.argv[1])
print(time.perf_counter() - start)
"""


def measured(code: str, argument: str, cache: str) -> float:
    """What a fresh process prints [s]."""
    environment = os.environ | {"RTTRR_PIN_CACHE": cache}
    command = [sys.executable, "-c", code, argument]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return float(done.stdout)


def first_calls(robot: str, repeats: int) -> dict[str, Any]:
    """Seconds to the first result: compiled, and from the cache."""
    compiled, cached = [], []
    for _ in range(repeats):
        with tempfile.TemporaryDirectory() as folder:
            compiled.append(measured(FIRST_CALL, robot, folder))
            cached.append(measured(FIRST_CALL, robot, folder))
    return {"robot": robot, "compile_s": statistics.median(compiled), "cached_s": statistics.median(cached)}


COMMANDS = {"validate": ("validate", "--states", "10"), "inspect": ("inspect", "rttrr")}


def commands(repeats: int) -> dict[str, float]:
    """Seconds of the commands beyond the imports, which no command with Pinocchio can be without."""
    words = {"imports": ["-c", "import numpy, pinocchio"]}
    words |= {name: ["-m", "rttrr_pin", *own] for name, own in COMMANDS.items()}
    times: dict[str, list[float]] = {name: [] for name in words}
    for _ in range(repeats + 1):  # the first fills the cache
        for name, own in words.items():
            start = time.perf_counter()
            subprocess.run([sys.executable, *own], capture_output=True, check=True)
            times[name].append(time.perf_counter() - start)
    medians = {name: statistics.median(own[1:]) for name, own in times.items()}
    return {"imports_s": medians["imports"]} | {
        f"{name}_beyond_s": medians[name] - medians["imports"] for name in COMMANDS
    }


def main() -> None:
    parser = arguments(__doc__ or "")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    imports = {
        name: [measured(IMPORT, name, "") for _ in range(3 * options.repeats)] for name in ("numpy", "rttrr_pin")
    }
    medians = {name: statistics.median(times) for name, times in imports.items()}
    figures = {
        "repeats": options.repeats,
        "import_numpy_s": medians["numpy"],
        "import_rttrr_pin_s": medians["rttrr_pin"],
        "commands": commands(4 * options.repeats),
        "first_calls": [first_calls(robot, options.repeats) for robot in ROBOTS],
    }
    finish("kernel_start", figures, options.save)


if __name__ == "__main__":
    main()
