"""Importing the package costs little: what is large is loaded when it is first used."""

from __future__ import annotations

import subprocess
import sys

LARGE = ("pinocchio", "llvmlite", "yourdfpy", "trimesh", "rich", "click", "lxml", "importlib.metadata")

OWN = (
    "rttrr_pin.validation.run",
    "rttrr_pin.validation.report",
    "rttrr_pin.validation.command",
    "rttrr_pin.inspection.telling",
)
"""What `rttrr-pin validate` loads."""

UNUSED = (
    "compile.build", "core.identification", "core.statics", "exact.rounding", "implementations.program",
    "implementations.table", "inspection.run", "inspection.shapes", "validation.state",
)  # fmt: skip
"""What of ours it does not run, where one robot agrees with Pinocchio and the kernel is on disk."""


def test_validate_loads_nothing_of_ours_that_it_does_not_run() -> None:
    code = f"import sys; [__import__(name) for name in {OWN!r}]; print([name for name in {UNUSED!r} if f'rttrr_pin.{{name}}' in sys.modules])"
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
