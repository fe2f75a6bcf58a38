"""Arrays as compiled code takes them: rows of states, read and written where they lie if that is possible."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.errors import InputError, ShapeError


def readable(x: Any, width: int) -> bool:
    """Whether compiled code can read an array where it lies; all else is checked, and copied if need be."""
    if type(x) is not np.ndarray or x.dtype not in (np.float64, np.float32) or not x.flags.aligned:
        return False
    return bool(x.dtype.isnative and x.ndim and x.shape[-1] == width)


def as_rows(x: NDArray[Any], batch: tuple[int, ...], rows: int) -> NDArray[Any]:
    """(N, width) of the same memory where strides can say that, else as it is, (*batch, width)."""
    if x.shape[:-1] == batch == (rows,):
        return x
    if x.shape[:-1] != batch:
        x = np.broadcast_to(x, (*batch, x.shape[-1]))
    return x.reshape(rows, x.shape[-1]) if even(x.shape[:-1], x.strides[:-1]) else x


def even(shape: tuple[int, ...], strides: tuple[int, ...]) -> bool:
    """Whether axes can be made one: each strides as far as all that is inside it."""
    axes = [(size, stride) for size, stride in zip(shape, strides, strict=True) if size != 1]
    return all(outer == size * inner for (_, outer), (size, inner) in pairwise(axes))


def rows_in_place(x: Array, rows: int, width: int) -> Array | None:
    """(N, width) of the same memory, if there is such a view."""
    if x.ndim == 2 and x.shape == (rows, width):
        return x
    return x.reshape(rows, width) if x.flags.c_contiguous else None


def check_out(name: str, x: Any, shape: tuple[int, ...], dtype: np.dtype[Any]) -> None:
    """Refuse what results cannot be written to.

    Raises:
        InputError: it is no array of that type, or one that cannot be written.
        ShapeError: it has another shape.
    """
    if not isinstance(x, np.ndarray) or x.dtype != dtype or not x.flags.aligned or not x.dtype.isnative:
        description = f"a {type(x).__name__}"
        if isinstance(x, np.ndarray):
            description = f"{'an' if x.flags.aligned else 'a misaligned'} array of {x.dtype}"
        wanted = f"np.empty({shape}{'' if dtype == np.float64 else f', np.{dtype}'})"
        raise InputError(f"out for {name} is {description}: expected a {dtype} array, such as {wanted}")
    if x.shape != shape:
        raise ShapeError(
            f"out for {name} has shape {x.shape}, expected {shape}: pass np.empty({shape})",
            name="out",
            got=x.shape,
            wanted=str(shape),
        )
    if not x.flags.writeable:
        raise InputError(f"out for {name} cannot be written: pass an array of your own, such as np.empty({shape})")
