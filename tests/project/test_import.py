"""Importing the package costs little: what is large is loaded when it is first used."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
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
    assert loaded(LARGE, "import numpy, rttrr_pin") == "[]"


def test_scipy_is_for_logs_whose_rates_are_derived_and_other_results_load_none() -> None:
    assert loaded(["scipy"], "import rttrr_pin.diagnosis.run, rttrr_pin.diagnosis.logs.log_diagnosis") == "[]"


def loaded(names: Sequence[str], imports: str) -> str:
    """Which of these modules are loaded; without site, whose .pth files may import what they like."""
    code = f"""
import sys
sys.path[:] = {sys.path!r}
{imports}
print([name for name in {list(names)!r} if name in sys.modules])
"""
    done = subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()
