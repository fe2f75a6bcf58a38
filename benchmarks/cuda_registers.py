"""What NVRTC makes of the kernels: registers, spills, shared memory, seconds of the processor. No GPU is needed.

Run: pip install -e '.[cuda]', then python benchmarks/cuda_registers.py [--architecture sm_90] [--save]. Exit 1 where a
kernel is refused.
"""

from __future__ import annotations

import contextlib
import io
import re
import sys
import time
from importlib import metadata
from typing import Any

import rttrr_pin
from common import arguments, finish
from rttrr_pin.compile import Kernel
from rttrr_pin.compile.emit import cuda_text
from rttrr_pin.compile.emit.cuda_driver import compiled

ROBOTS = ("rttrr", "example:ur5_robot", "example:panda", "example:talos_reduced")

OUTPUTS: dict[str, str | tuple[str, ...]] = {
    "tau": "tau",
    "tau, tau_bound": ("tau", "tau_bound"),
    "F, N, f, n": ("F", "N", "f", "n"),
}

SPILLED = re.compile(r"(\d+) bytes stack frame, (\d+) bytes spill stores, (\d+) bytes spill loads")

USED = re.compile(r"Used (\d+) registers")

VERSIONS = ("cuda-core", "cuda-bindings", "nvidia-cuda-nvrtc")


def measured(robot: rttrr_pin.Robot, outputs: str | tuple[str, ...], dtype: str, architecture: str) -> dict[str, Any]:
    """One kernel, compiled."""
    kernel = Kernel[Any](robot.model, outputs, dtype=dtype)
    text = kernel.source("cuda")
    report, start = io.StringIO(), time.process_time()
    with contextlib.redirect_stderr(report):
        code = compiled(text, architecture, "-v")
    seconds = time.process_time() - start
    said = report.getvalue()
    said = said[said.index("Compiling entry function") :]
    spilled, used = SPILLED.search(said), USED.search(said)
    assert spilled, said
    assert used, said
    program = kernel.program
    shape = cuda_text.shape(program.inputs, program.outputs, program.float_type)
    stack, stores, loads = map(int, spilled.groups())
    return {
        "registers": int(used[1]),
        "stack_bytes": stack,
        "spill_store_bytes": stores,
        "spill_load_bytes": loads,
        "threads": shape.threads,
        "shared_bytes": shape.pitch * shape.threads * program.float_type.size,
        "code_bytes": len(code),
        "compile_s": round(seconds, 1),
    }


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--architecture", default="sm_90")
    options = parser.parse_args()
    try:
        versions = {name: metadata.version(name) for name in VERSIONS}
    except metadata.PackageNotFoundError as error:
        print(f"{error}: pip install -e '.[cuda]'", file=sys.stderr)
        return 1
    rows = []
    for name in ROBOTS:
        robot = rttrr_pin.load(name)
        for said, outputs in OUTPUTS.items():
            for dtype in ("float64", "float32"):
                row = {"robot": name, "outputs": said, "dtype": dtype}
                rows.append(row | measured(robot, outputs, dtype, options.architecture))
                print(rows[-1], file=sys.stderr)
    finish("cuda_registers", {"architecture": options.architecture, "nvrtc": versions, "rows": rows}, options.save)
    return 0


if __name__ == "__main__":
    sys.exit(main())
