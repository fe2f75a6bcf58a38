"""The array type of the package, and the norm of its vectors."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
"""An array of float64."""


def norm(vectors: Array) -> Array:
    """The Euclidean norm of the last axis.

    Each vector is divided by a power of two before its numbers are squared: no square of a number that float64 holds
    overflows or vanishes, and the bits are those of the plain formula. A norm that itself is too large is infinite.
    """
    size = np.abs(vectors).max(axis=-1, initial=0.0)
    exponent = np.frexp(np.where(np.isfinite(size), size, 0.0))[1]
    scaled = np.ldexp(vectors, -exponent[..., None])
    with np.errstate(over="ignore"):
        return np.ldexp(np.sqrt(np.add.reduce(scaled * scaled, axis=-1)), exponent)
