"""What the results of all features have in common: a line in an interactive session, and data for JSON."""

from __future__ import annotations

import math
from typing import Any


class Summarised:
    """A result whose representation is its verdict; the data can be large."""

    __slots__ = ()

    def summary(self) -> str:
        """The verdict, its first line by itself."""
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self.summary().partition(chr(10))[0]}>"


def counted(number: int, what: str) -> str:
    """Such as `1 finding`, `2 findings`."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def finite(data: dict[str, Any]) -> dict[str, Any]:
    """Data for JSON, which has no number for NaN and infinities: these become text, "nan" and "inf"."""
    return {key: _finite(value) for key, value in data.items()}


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return finite(value)
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value
