"""The umpire: between which two doubles the true value of each of the five quantities lies, proven by balls."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
from flint import arb
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import batch_shape, check_overflow, flat
from rttrr_pin.core.dynamics import bodies
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import LINK_QUANTITIES, QUANTITIES, LinkWrenches
from rttrr_pin.errors import InputError
from rttrr_pin.exact.intervals import INTERVAL, interval, precision
from rttrr_pin.exact.parameters import Numbers, exact_parameters
from rttrr_pin.exact.recursion import Slots, results_of

PRECISIONS = (128, 256, 512, 1024, 2048, 4096)
"""Bits of the balls, one after the other. At 64 bits, which take as long, one state in two is not tight."""

STRAIGHT_FROM = 32
"""States from which recording the operations costs less than it saves."""

OWN, LARGEST = 2.0**-80, 2.0**-200
"""Widths that do for what is zero or nearly: of the number's own vector, and of the largest of its quantity."""


@dataclass(frozen=True, slots=True, eq=False)
class Enclosure:
    """Two doubles that the true value lies between, for each number of an array.

    Attributes:
        lower: at most the true value.
        upper: at least the true value.
    """

    lower: Array
    upper: Array

    @property
    def mid(self) -> Array:
        """A double between the two."""
        between: Array = self.lower + (self.upper - self.lower) / 2
        return between

    def __getitem__(self, index: int | slice) -> Enclosure:
        """The same for some states."""
        return Enclosure(self.lower[index], self.upper[index])


@dataclass(frozen=True, slots=True, eq=False)
class Enclosures:
    """What the five quantities truly are, to the last bit of a double; shapes, frames and units as in `LinkWrenches`.

    Attributes:
        tau: driving forces, (..., nv) [N m or N].
        F: net force on each link, (..., links, 3) [N].
        N: net moment about its centre of mass, (..., links, 3) [N m].
        f: force from the parent, (..., links, 3) [N].
        n: moment from the parent about the origin of {i}, (..., links, 3) [N m].
        bits: precision that it took, (...).
        tight: whether every enclosure is as narrow as it can be, (...); see `enclose`.
        links: the names along the links axis.
        joints: the names along the last axis of tau.
    """

    tau: Enclosure
    F: Enclosure
    N: Enclosure
    f: Enclosure
    n: Enclosure
    bits: NDArray[np.int64]
    tight: NDArray[np.bool_]
    links: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()

    def items(self) -> Iterator[tuple[str, Enclosure]]:
        """The five quantities with their names, in the order of reports."""
        return ((key, getattr(self, key)) for key in QUANTITIES)

    def __getitem__(self, index: int | slice) -> Enclosures:
        """The same for one state or some states of a batch."""
        parts = {key: value[index] for key, value in self.items()}
        return Enclosures(**parts, bits=self.bits[index], tight=self.tight[index], links=self.links, joints=self.joints)


def enclose(
    model: Model, q: Array, v: Array, a: Array, loads: Sequence[Load] = (), numbers: Numbers = "doubles"
) -> Enclosures:
    """The specification on balls, to a precision that rises until every enclosure is tight.

    Tight is a number whose enclosure is one double, or two neighbours (or, where balls cannot tell the true value from
    a double, the neighbours of that one). Nor need it be narrower than 2^-80 of the norm of its vector (of itself, for
    tau), or 2^-200 of the largest number of its quantity or of 1 SI unit: what is truly zero has no last bit.

    The specification's formulas are taken as they stand: a quaternion whose length is not exactly 1 in doubles turns by
    the matrix that they yield.

    Args:
        model: the robot.
        q: coordinates, (..., nq) [rad or m]; these doubles are exact.
        v: rates, (..., nv).
        a: accelerations, (..., nv).
        loads: payloads; leading axes broadcast with those of q, v, a.
        numbers: `"doubles"`: those of the model, with rotations and axes as they were rounded; `"read"`: the doubles
            that the file's words stand for, with rotations, axes and turned tensors computed from them without
            rounding; `"text"`: the same from the decimals themselves.

    Returns:
        The enclosures, rounded outwards.

    Raises:
        InputError: there are no such numbers: the model has no file, or was altered since it was read.
        NumberError: a result is beyond float64.
        ShapeError: leading axes do not broadcast.
    """
    if numbers not in get_args(Numbers):
        raise InputError(f"numbers is {numbers!r}: expected one of {', '.join(map(repr, get_args(Numbers)))}")
    batch = batch_shape((q, v, a), loads)
    rows = math.prod(batch)
    q, v, a = (np.broadcast_to(x, (*batch, x.shape[-1])).reshape(rows, x.shape[-1]) for x in (q, v, a))
    loads = [flat(load, batch, rows) for load in loads]
    sides = [np.broadcast_to(x, (rows, 3)) for load in loads for x in (load.f, load.n)]
    slots = tuple((load.link, load.in_base) for load in loads)
    lower, upper, bits, tight = _enclosed(model, np.hstack([q, v, a, *sides]), slots, numbers)
    for side in (lower, upper):
        check_overflow(_wrenches(model, side), q, v, a)
    parts = {
        key: Enclosure(*(_shaped(model, side)[key].reshape(*batch, *_shape(model, key)) for side in (lower, upper)))
        for key in QUANTITIES
    }
    return Enclosures(
        **parts,
        bits=bits.reshape(batch),
        tight=tight.reshape(batch),
        links=model.link_names,
        joints=model.v_names,
    )


def _enclosed(
    model: Model, states: Array, slots: Slots, numbers: Numbers
) -> tuple[Array, Array, NDArray[np.int64], NDArray[np.bool_]]:
    """Lower and upper ends of all numbers, the bits that they took, and which states are tight."""
    rows, size = len(states), model.nv + 12 * len(model.links)
    lower, upper = np.zeros((rows, size)), np.zeros((rows, size))
    bits, tight = np.zeros(rows, dtype=np.int64), np.zeros(rows, dtype=np.bool_)
    waiting = np.arange(rows)
    ready, places = _recursion(model, slots, numbers, rows)
    for some in PRECISIONS:
        if not len(waiting):
            break
        with precision(some):
            run = ready()
            for row in waiting:
                ends = np.array([enclosing_doubles(x) for x in run(states[row].tolist())], dtype=np.float64).reshape(
                    -1, 2
                )
                lower[row], upper[row] = ends[places, 0], ends[places, 1]
        bits[waiting] = some
        tight[waiting] = _tight(model, lower[waiting], upper[waiting])
        waiting = waiting[~tight[waiting]]
    return lower, upper, bits, tight


Run = Callable[[Sequence[float]], list[arb]]


def _recursion(model: Model, slots: Slots, numbers: Numbers, rows: int) -> tuple[Callable[[], Run], NDArray[np.intp]]:
    """What makes, at the precision in force, a function from a state's numbers to balls, and the places of these."""
    if rows >= STRAIGHT_FROM:
        from rttrr_pin.exact.straight_line import straight_line  # loads the kernel

        program = straight_line(model, slots, numbers)
        return program.ready, program.places

    def ready() -> Run:
        exact, links = model, bodies(model, INTERVAL)
        if numbers != "doubles":
            of_file = exact_parameters(model, numbers)
            exact, links = of_file.model, of_file.bodies(INTERVAL, lambda square: interval(square).rsqrt())
        return lambda state: [arb(x) for x in results_of(exact, INTERVAL, [arb(x) for x in state], slots, links)]

    return ready, np.arange(model.nv + 12 * len(model.links))


def enclosing_doubles(x: arb) -> tuple[float, float]:
    """The nearest doubles that a ball lies between: one, two neighbours, or as far apart as the ball is wide."""
    middle = float(x)
    if not math.isfinite(middle):
        return middle, middle
    if x >= middle:
        if x <= middle:
            return middle, middle
        above = math.nextafter(middle, math.inf)
        if x <= above:
            return middle, above
    elif x <= middle:
        below = math.nextafter(middle, -math.inf)
        if x >= below:
            return below, middle
    lower, upper = float(x.lower()), float(x.upper())
    while not x >= lower:
        lower = math.nextafter(lower, -math.inf)
    while not x <= upper:
        upper = math.nextafter(upper, math.inf)
    return lower, upper


def _tight(model: Model, lower: Array, upper: Array) -> NDArray[np.bool_]:
    """Which states are tight, (N,)."""
    enough = np.nextafter(np.nextafter(lower, np.inf), np.inf) >= upper
    if enough.all():
        return np.ones(len(lower), dtype=np.bool_)
    with np.errstate(over="ignore", invalid="ignore"):
        low, high = _shaped(model, lower), _shaped(model, upper)
        for key, some in _shaped(model, enough).items():
            size = np.maximum(np.abs(low[key]), np.abs(high[key]))
            own = size if key == "tau" else np.linalg.norm(size, axis=-1, keepdims=True)
            axes = tuple(range(1, size.ndim))
            largest = np.maximum(size.max(axis=axes, keepdims=True, initial=0.0), 1.0)
            some |= high[key] - low[key] <= np.maximum(OWN * own, LARGEST * largest)
    return np.asarray(enough.all(axis=1))


def _shape(model: Model, key: str) -> tuple[int, ...]:
    return (len(model.links), 3) if key in LINK_QUANTITIES else (model.nv,)


def _shaped(model: Model, numbers: NDArray[Any]) -> dict[str, NDArray[Any]]:
    """Views of (N, all numbers) by quantity."""
    ends = [model.nv + 3 * len(model.links) * k for k in range(4)]
    parts = np.split(numbers, ends, axis=1)
    return {key: part.reshape(len(numbers), *_shape(model, key)) for key, part in zip(QUANTITIES, parts, strict=True)}


def _wrenches(model: Model, numbers: Array) -> LinkWrenches:
    parts = _shaped(model, numbers)
    return LinkWrenches.of(parts | {"tau_joint": parts["tau"]}, model.link_names, model.v_names)
