"""Arrays of a GPU as a kernel takes them: an address, and the distances from state to state and column to column."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np

from rttrr_pin.compile.arrays import even
from rttrr_pin.compile.emit.cuda_driver import Driver, View
from rttrr_pin.compile.fields import Field
from rttrr_pin.errors import InputError, ShapeError


@dataclass(frozen=True, slots=True)
class Placed:
    """Where the states of an array lie, in the order of a kernel's arguments.

    Attributes:
        address: of the first number.
        row: the distance from state to state, in numbers; 0 where one row serves all states.
        column: that from column to column.
    """

    address: int
    row: int
    column: int

    def range(self, rows: int, width: int, size: int) -> tuple[int, int]:
        """The addresses between which all its numbers lie, of so many bytes each; of none, an empty range."""
        if not rows or not width:
            return self.address, self.address
        down, right = (rows - 1) * self.row, (width - 1) * self.column
        low, high = min(down, 0) + min(right, 0), max(down, 0) + max(right, 0)
        return self.address + low * size, self.address + (high + 1) * size


def looked_at(driver: Driver, name: str, x: Any, stream: Any, dtype: np.dtype[Any], written: bool = False) -> View:
    """An array as it lies on the card.

    Raises:
        InputError: it is none, or one of the host, of another card, of another type, or not to be written.
    """
    try:
        view = None if isinstance(x, dict | list | tuple | int | float) else driver.view(x, stream)
    except (BufferError, TypeError, AttributeError, RuntimeError, NotImplementedError):
        view = None
    if view is None or view.device < 0:
        what = f"a {type(x).__name__}" if view is None else f"an array of the host ({type(x).__name__})"
        raise InputError(
            f"{name} is {what}, expected an array on the GPU of CuPy, PyTorch or JAX, in the order of the robot's "
            "coordinates: copy it there, such as cupy.asarray(x) or torch.as_tensor(x, device='cuda'), or take "
            "emitter='llvm' for arrays of the host"
        )
    if view.device != driver.device:
        raise InputError(f"{name} is on GPU {view.device}, expected {driver.device}, the kernel's: copy it there")
    if written and not view.writable:
        raise InputError(
            f"{name} cannot be written: pass an array of another library, or none and take what is returned"
        )
    if view.dtype != dtype:
        raise InputError(
            f"{name} has numbers of type {view.dtype}, expected {dtype}: convert it, or compile for its type"
        )
    return view


def placed(name: str, view: View, batch: tuple[int, ...], field: Field, own_shape: bool = False) -> Placed:
    """Where the states of an array lie.

    Args:
        name: of the argument.
        view: of the array.
        batch: the leading axes of all arrays; one that has none of its own serves every state.
        field: what belongs to one state.
        own_shape: whether the array has the axes of the field, as results have; else one for all its numbers.

    Raises:
        ShapeError: it has another shape.
        InputError: its states do not lie at even distances.
    """
    shape = field.shape if own_shape else (field.width,)
    axes = len(view.shape) - len(shape)
    leading, inner = view.shape[: max(axes, 0)], view.shape[max(axes, 0) :]
    alone = prod(leading) == 1 and not own_shape
    if axes < 0 or inner != shape or not (alone or leading == batch):
        wanted = f"{(*batch, *shape)}" if own_shape or batch else f"(..., {field.width})"
        raise ShapeError(
            f"{name} has shape {view.shape}, expected {wanted}: leading axes are those of all arrays, or none",
            name=name,
            got=view.shape,
            wanted=wanted,
        )
    rows, columns = view.strides[:axes], view.strides[axes:]
    if not even(leading, rows) or not even(inner, columns):
        raise InputError(
            f"{name} has strides {view.strides}, expected states and columns at even distances: make it contiguous"
        )
    return Placed(view.address, 0 if alone and prod(batch) != 1 else _last(leading, rows), _last(inner, columns))


def _last(shape: tuple[int, ...], strides: tuple[int, ...]) -> int:
    """The distance along axes that are made one."""
    return next((stride for size, stride in zip(shape[::-1], strides[::-1], strict=True) if size != 1), 1)
