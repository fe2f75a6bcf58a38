"""The reference recursion with an error planted in it."""

from __future__ import annotations

import inspect
from types import ModuleType

import pytest

from rttrr_pin.core import dynamics, newton_euler
from rttrr_pin.core.joints import revolute


def put_in(monkeypatch: pytest.MonkeyPatch, module: ModuleType, old: str, new: str) -> None:
    """Run the specification from here on with a slip in its source."""
    source = inspect.getsource(module)
    assert source.count(old) == 1, f"{old!r} must stand once in {module.__name__}"
    mutant = ModuleType(module.__name__)
    exec(compile(source.replace(old, new), module.__name__, "exec"), mutant.__dict__)
    if module is newton_euler:
        monkeypatch.setattr(dynamics, "newton_euler", mutant.newton_euler)
    else:
        monkeypatch.setattr(revolute.Revolute, "motion", mutant.Revolute.motion)
