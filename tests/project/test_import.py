"""Importing the package costs little: what is large is loaded when it is first used."""

from __future__ import annotations

import subprocess
import sys
from importlib.util import find_spec

LARGE = ("pinocchio", "llvmlite", "yourdfpy", "trimesh", "rich", "click", "lxml", "importlib.metadata")

UNUSED = (
    "compile.build", "core.identification", "core.statics", "exact.rounding", "implementations.program",
    "implementations.table", "inspection.run", "inspection.shapes", "validation.state",
)  # fmt: skip
"""What of ours `validate` does not run, where one robot agrees with Pinocchio and the kernel is on disk."""


def test_validate_loads_nothing_of_ours_that_it_does_not_run() -> None:
    names = [f"rttrr_pin.{name}" for name in UNUSED]
    assert all(map(find_spec, names))
    code = f"""
import sys
from rttrr_pin.cli import main
assert main(["validate", "rttrr", "--states", "10", "-q"]) == 0
print([name for name in {names!r} if name in sys.modules])
"""
    for _ in range(2):  # the first may have to compile
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_nothing_large_is_imported() -> None:
    code = f"import sys, numpy, rttrr_pin; print([name for name in {LARGE!r} if name in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", with_packages(code)], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]", done.stdout


def with_packages(code: str) -> str:
    """Without site, whose .pth files may import what they like."""
    return f"import sys; sys.path[:] = {sys.path!r}\n{code}"
