"""Importing the package costs little: what is large is loaded when it is first used."""

from __future__ import annotations

import subprocess
import sys

LARGE = ("pinocchio", "llvmlite", "yourdfpy", "trimesh", "rich", "click", "lxml", "importlib.metadata")


def test_nothing_large_is_imported() -> None:
    code = f"import sys, numpy, rttrr_pin; print([name for name in {LARGE!r} if name in sys.modules])"
    done = subprocess.run(
        [sys.executable, "-I", "-S", "-c", with_packages(code)], capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == "[]", done.stdout


def with_packages(code: str) -> str:
    """Without site, whose .pth files may import what they like."""
    return f"import sys; sys.path[:] = {sys.path!r}\n{code}"
