"""Which cases of a test the README's test line leaves to `.ci/run`."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pytest


def slow_after(fast: int, values: Iterable[Any]) -> list[Any]:
    """Values of a parameter, all but the first few of them marked slow."""
    return [value if k < fast else pytest.param(value, marks=pytest.mark.slow) for k, value in enumerate(values)]


def slow_but(fast: Iterable[Any], values: Iterable[Any]) -> list[Any]:
    """Values of a parameter, all but these marked slow."""
    kept = list(fast)
    return [value if value in kept else pytest.param(value, marks=pytest.mark.slow) for value in values]
