"""What a library built, compared with the file: a line for each number that differs."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.scalars import EPS

TOLERANCE = 64 * EPS
"""Relative; merging inertias over fixed joints and turning them by rpy rounds a few times."""


def differs(what: str, expected: ArrayLike, built: ArrayLike, scale: float = 0.0) -> Iterator[str]:
    """A line, if two numbers or arrays are apart by more than rounding.

    Args:
        what: they are, in words.
        expected: what the file says.
        built: what the library has.
        scale: of what was rounded on the way, where that is larger than the numbers themselves.
    """
    x, y = np.asarray(expected, dtype=float), np.asarray(built, dtype=float)
    size = max(float(np.linalg.norm(x)), scale)
    if x.shape != y.shape or not np.linalg.norm(x - y) <= TOLERANCE * size:
        yield f"{what}: {_short(y)}, the file says {_short(x)}"


def _short(x: Array) -> str:
    return np.array2string(x, precision=17, separator=", ").replace("\n", "")
