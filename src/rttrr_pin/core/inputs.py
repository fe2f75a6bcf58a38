"""From what a user passes for q, v, a and payloads to float64 arrays, or to an error that names joint and index."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.errors import MissingJointError, NumberError, ShapeError, UnknownNameError, listed

if TYPE_CHECKING:
    from rttrr_pin.core.joint import Joint

Coordinates: TypeAlias = ArrayLike | Mapping[str, ArrayLike]
"""An array with the joints on its last axis, or a dict with one entry for each joint."""

UNIT_QUATERNION = 1e-12
"""How far the squared length of a quaternion may be from 1; what float64 normalised is within 1e-15."""

EXACT_INTEGER = 2**53
"""Integers beyond it have no float64 of their own."""


def coordinates(
    name: str, values: Coordinates, joints: Sequence[Joint], unit_quaternion: float = UNIT_QUATERNION
) -> Array:
    """One of q, v, a as float64.

    Args:
        name: "q", "v" or "a".
        values: an array (..., n), or a dict from joint name to array (...); of a joint with several coordinates
            (..., that many). Dict entries broadcast.
        joints: the joints along the last axis.
        unit_quaternion: how far the squared length of a quaternion may be from 1.

    Returns:
        A float64 array (..., n).

    Raises:
        ShapeError: the last axis has not one value for each coordinate, or dict entries do not broadcast.
        NumberError: NaN, inf, complex, text, bool, an integer that float64 cannot hold, or no unit quaternion.
        UnknownNameError, MissingJointError: a dict's keys are not the joints' names.
    """
    labels = [label for joint in joints for label in (joint.q_labels() if name == "q" else joint.v_labels())]
    if isinstance(values, Mapping):
        array = _from_dict(name, values, joints)
    else:
        array = real(name, values)
        if array.ndim == 0 or array.shape[-1] != len(labels):
            each = "joint" if all(joint.nq == 1 for joint in joints) else "coordinate"
            known = listed(labels, 8) or "the robot has no moving joint"
            got = "no axis" if array.ndim == 0 else f"{array.shape[-1]} values on its last axis"
            raise ShapeError(
                f"{name} has {got}, expected {len(labels)} ({known}): pass one per {each}",
                name=name,
                got=array.shape,
                wanted=f"(..., {len(labels)})",
            )
    finite(name, array, labels)
    if name == "q":
        check_quaternions(array, joints, unit_quaternion)
    return array


def copied(values: Coordinates) -> Coordinates:
    """What was passed for q, v or a, and was taken, as it is now."""
    if type(values) is np.ndarray:  # what a control loop passes
        return values.copy()
    if isinstance(values, Mapping):
        return {name: np.array(x) for name, x in values.items()}
    return np.array(values)


def vectors(name: str, values: ArrayLike) -> Array:
    """A force, a moment or a gravity field, (..., 3), as float64.

    Raises:
        ShapeError: the last axis has not three values.
        NumberError: a value is not a finite real number.
    """
    array = real(name, values)
    if array.ndim == 0 or array.shape[-1] != 3:
        got = "is a single number" if array.ndim == 0 else f"has {array.shape[-1]} values on its last axis"
        raise ShapeError(
            f"{name} {got}, expected 3 (x, y, z): pass a vector", name=name, got=array.shape, wanted="(..., 3)"
        )
    return finite(name, array)


def real(name: str, values: ArrayLike) -> Array:
    """Anything that is an array of real numbers, as float64 without losing a digit.

    Raises:
        ShapeError: rows of different lengths.
        NumberError: a kind of number that float64 cannot hold.
    """
    subclass = isinstance(values, np.ndarray) and type(values) is not np.ndarray  # NumPy loads np.ma only where asked
    if subclass and isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        raise NumberError(f"{name} has masked entries: fill them, or drop those states", name=name, value="masked")
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise ShapeError(
            f"{name} is no rectangular array ({error}): give every row the same length",
            name=name,
            got=(),
            wanted="a rectangular array",
        ) from error
    if array.dtype == object:
        array = _from_objects(name, array)
    if array.dtype.kind in "iu":
        inexact = np.argwhere((array > EXACT_INTEGER) | (array < -EXACT_INTEGER))
        if len(inexact):
            index = tuple(int(k) for k in inexact[0])
            raise _too_large(name, index, int(array[index]))
    elif array.dtype.kind != "f" or array.dtype.itemsize > 8:
        kinds = {"b": "bool", "c": "complex", "U": "text", "S": "bytes", "M": "date", "m": "duration"}
        kind = kinds.get(array.dtype.kind, str(array.dtype))
        raise NumberError(
            f"{name} is an array of {kind}, expected real numbers: "
            f"{'take .real' if kind == 'complex' else 'convert it with .astype(float)'} if that is what you mean",
            name=name,
            value=kind,
        )
    return np.asarray(array, dtype=np.float64)


def finite(name: str, array: Array, labels: Sequence[str] = ()) -> Array:
    """The array, all of whose values are finite.

    Raises:
        NumberError: the first NaN or inf, with its index, and its joint where the last axis has labels.
    """
    if np.isfinite(array).all():
        return array
    bad = np.argwhere(~np.isfinite(array))
    index = tuple(int(k) for k in bad[0])
    value = float(array[index])
    joint = labels[index[-1]] if labels else None
    more = f" ({len(bad)} such values in all)" if len(bad) > 1 else ""
    state = ", or drop that state" if labels else ""
    raise NumberError(
        f"{name}{list(index) if index else ''}{f', joint {joint!r},' if joint else ''} is {value}, "
        f"expected a finite number{more}: look where it comes from{state}",
        name=name,
        joint=joint,
        index=index,
        value=value,
    )


def check_quaternions(q: Array, joints: Sequence[Joint], tolerance: float = UNIT_QUATERNION) -> None:
    """The four numbers of a quaternion are a rotation only if their length is 1.

    Raises:
        NumberError: they have not.
    """
    at = 0
    for joint in joints:
        for first in (at + k for k in joint.type.quaternions):
            own = slice(first, first + 4)
            with np.errstate(over="ignore"):
                squares = (q[..., own] ** 2).sum(axis=-1)
            bad = np.argwhere(np.abs(squares - 1.0) > tolerance)
            if not len(bad):
                continue
            index = tuple(int(k) for k in bad[0])
            raise NumberError(
                f"q{list(index) if index else ''}, joint {joint.name!r}, has a quaternion (x, y, z, w) of length "
                f"{float(squares[index]) ** 0.5:.17g}, expected 1: divide it by its length (the last of its four "
                "numbers is the real part)",
                name="q",
                joint=joint.name,
                index=index,
                value=q[index][own].tolist(),
            )
        at += joint.nq


def _from_dict(name: str, values: Mapping[str, ArrayLike], joints: Sequence[Joint]) -> Array:
    """A dict from joint name to array, stacked in the order of the joints."""
    names = [joint.name for joint in joints]
    for key in values:
        if key not in names:
            raise UnknownNameError("moving joint", key, names, f"{name} must have one entry for each")
    missing = [joint for joint in names if joint not in values]
    if missing:
        raise MissingJointError(name, missing)
    columns = []
    for joint in joints:
        label = f"{name}[{joint.name!r}]"
        entry = finite(label, real(label, values[joint.name]))
        width = joint.nq if name == "q" else joint.nv
        if width > 1 and (entry.ndim == 0 or entry.shape[-1] != width):
            slots = [own.name for own in (joint.type.coordinates if name == "q" else joint.type.rates)]
            raise ShapeError(
                f"{label} has shape {entry.shape}, expected (..., {width}): pass {', '.join(slots)}",
                name=label,
                got=entry.shape,
                wanted=f"(..., {width})",
            )
        columns += [entry] if width == 1 else [entry[..., k] for k in range(width)]
    try:
        return np.stack(np.broadcast_arrays(*columns), axis=-1) if columns else np.zeros((0,))
    except ValueError:
        shapes = ", ".join(f"{key}: {np.shape(values[key])}" for key in names)
        raise ShapeError(
            f"the entries of {name} have shapes that do not broadcast ({shapes}): give all the same shape",
            name=name,
            got=(),
            wanted="shapes that broadcast",
        ) from None


def _from_objects(name: str, array: NDArray[np.object_]) -> Array:
    """An object array holds what NumPy has no type for: huge integers, fractions, None, nested lists."""
    for index, value in np.ndenumerate(array):
        if isinstance(value, int) and not isinstance(value, bool) and abs(value) > EXACT_INTEGER:
            raise _too_large(name, index, value)
        if not isinstance(value, (int, float)) or isinstance(value, bool):
            raise NumberError(
                f"{name}{list(index)} is {value!r} ({type(value).__name__}), "
                "expected a real number: convert it with float()",
                name=name,
                index=index,
                value=value,
            )
    return array.astype(np.float64)


def _too_large(name: str, index: tuple[int, ...], value: int) -> NumberError:
    digits = str(value) if abs(value) < 10**40 else f"an integer of {len(str(abs(value)))} digits"
    return NumberError(
        f"{name}{list(index)} is {digits}, which float64 cannot hold exactly: pass a float if rounding it is meant",
        name=name,
        index=index,
        value=value,
    )
