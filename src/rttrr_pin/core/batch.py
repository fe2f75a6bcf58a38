"""Batches: one shape for all inputs, slices of them, columns of results by quantity."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import LINK_QUANTITIES, QUANTITIES, LinkWrenches
from rttrr_pin.errors import NumberError, ShapeError

Number = TypeVar("Number", bound=np.generic)


def blocks(rows: int, size: int) -> Iterator[slice]:
    """Consecutive slices that cover a batch."""
    return (slice(start, min(start + size, rows)) for start in range(0, rows, size))


KEPT = 31 * 2**20
"""Bytes that are handed back once before a run, see `keep_memory`."""


def keep_memory() -> None:
    """Have the memory of one block serve the next.

    The C library of Linux hands large arrays back to the system, and each page of the next block's is a fault: half of
    the time of a run, and more on a virtual machine. It goes by the largest array that was handed back, up to 32 MiB:
    arrays up to that size, and twice as much in all, it keeps from then on. This one is never written to.
    """
    np.empty(KEPT, dtype=np.uint8)


def split_columns(
    model: Model, numbers: NDArray[Number], quantities: Sequence[str] = QUANTITIES
) -> dict[str, NDArray[Number]]:
    """Views by quantity, (N, nv) or (N, links, 3), of the columns in the order of `Result.scalars`."""
    shapes = [(len(model.links), 3) if key in LINK_QUANTITIES else (model.nv,) for key in quantities]
    parts = np.split(numbers, np.cumsum([math.prod(shape) for shape in shapes])[:-1], axis=1)
    return {key: part.reshape(len(numbers), *shape) for key, part, shape in zip(quantities, parts, shapes, strict=True)}


def batch_shape(arrays: Sequence[Array], loads: Sequence[Load]) -> tuple[int, ...]:
    """The common leading shape."""
    named = dict(zip("qva", (x.shape[:-1] for x in arrays), strict=True))
    for load in loads:
        named[f"payload force at link {load.link + 1}"] = load.f.shape[:-1]
        named[f"payload moment at link {load.link + 1}"] = load.n.shape[:-1]
    return common_shape(named)


def common_shape(named: Mapping[str, tuple[int, ...]]) -> tuple[int, ...]:
    """The shape that leading axes, by the name of their array, broadcast to.

    Raises:
        ShapeError: they do not.
    """
    try:
        return np.broadcast_shapes(*named.values())
    except ValueError:
        shapes = ", ".join(f"{name}: {shape}" for name, shape in named.items())
        raise ShapeError(
            f"the leading axes do not broadcast ({shapes}): give all the same batch shape",
            name="q, v, a",
            got=(),
            wanted="leading axes that broadcast",
        ) from None


def flat(load: Load, batch: tuple[int, ...], rows: int) -> Load:
    """The load with the batch on one axis."""
    f, n = (x if x.ndim == 1 else np.broadcast_to(x, (*batch, 3)).reshape(rows, 3) for x in (load.f, load.n))
    return Load(load.link, f, n, load.in_base)


def check_overflow(out: LinkWrenches, q: Array, v: Array, a: Array) -> None:
    """Finite inputs whose results are not finite have overflowed; say where."""
    for key, x in out.items():
        if not np.isfinite(x).all():
            row = int(np.argwhere(~np.isfinite(x))[0][0])
            raise overflow(key, row, {"q": q, "v": v, "a": a})


def overflow(quantity: str, row: int, arrays: Mapping[str, Array]) -> NumberError:
    """The error of a state whose result is too large for float64, by the largest of its coordinates."""
    sizes = {name: float(np.abs(x[row]).max(initial=0.0)) for name, x in arrays.items()}
    largest = max(sizes, key=sizes.__getitem__)
    return NumberError(
        f"{quantity} overflows in state {row}, where |{largest}| reaches {sizes[largest]:.3g}: "
        "pass coordinates of a size that a robot can have, in rad, m and s",
        name=largest,
        index=(row,),
        value=sizes[largest],
    )
