"""Enclosures: two doubles that each true value of the five quantities lies between, by interval arithmetic."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, get_args

import numpy as np
from flint import arb
from numpy.typing import NDArray

from rttrr_pin.core.arguments import choice
from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.batch import batch_shape, check_overflow, flat, split_columns
from rttrr_pin.core.dynamics import body_of
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES, LinkWrenches
from rttrr_pin.exact.intervals import INTERVAL, LoadFrames, Run, flat_dynamics, interval, precision
from rttrr_pin.exact.parameters import Parameters, exact_parameters

PRECISIONS = (128, 256, 512, 1024, 2048, 4096)
"""Bits of the intervals, tried in this order. At 64 bits, which take as long, one state in two is not tight."""

STRAIGHT_LINE_FROM = 256
"""States from which recording the operations costs less time than it saves: of arms of six joints, and small trees."""

RELATIVE_WIDTH, ABSOLUTE_WIDTH, ROUNDING_WIDTH = 2.0**-80, 2.0**-200, 2.0**-147
"""Widths that suffice near zero: relative to the norm of the vector; or else to the largest number of the quantity, and
to what rounding in float64 can do to the vector, which is 2^-53 of all terms that add up to it."""


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
        """The enclosure of one state or some states."""
        return Enclosure(self.lower[index], self.upper[index])


@dataclass(frozen=True, slots=True, eq=False)
class Enclosures:
    """The true values of the five quantities, to the last bit of a double; shapes, frames, units as in `LinkWrenches`.

    Attributes:
        tau: driving forces, (..., nv) [N m or N].
        F: net force on each link, (..., links, 3) [N].
        N: net moment about its centre of mass, (..., links, 3) [N m].
        f: force from the parent, (..., links, 3) [N].
        n: moment from the parent about the origin of {i}, (..., links, 3) [N m].
        bits: precision that was needed, (...).
        tight: whether every enclosure is as narrow as it can be, (...); see `enclose`.
        links: the names along the links axis.
        joints: the names along the last axis of tau.
        parameters: whose numbers are enclosed, as in `enclose`.
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
    parameters: Parameters = "doubles"

    def items(self) -> Iterator[tuple[str, Enclosure]]:
        """The five quantities with their names, in the order of reports."""
        return ((key, getattr(self, key)) for key in QUANTITIES)

    def __getitem__(self, index: int | slice) -> Enclosures:
        """The enclosures of one state or some states of a batch."""
        parts: dict[str, Any] = {key: value[index] for key, value in self.items()}
        return replace(self, **parts, bits=self.bits[index], tight=self.tight[index])

    def to_dict(self) -> dict[str, Any]:
        """The enclosures as lists, for JSON."""
        return {
            "schema": 1,
            "links": list(self.links),
            "joints": list(self.joints),
            "parameters": self.parameters,
            "bits": self.bits.tolist(),
            "tight": self.tight.tolist(),
            **{key: {"lower": x.lower.tolist(), "upper": x.upper.tolist()} for key, x in self.items()},
        }


def enclose(
    model: Model, q: Array, v: Array, a: Array, loads: Sequence[Load] = (), parameters: Parameters = "doubles"
) -> Enclosures:
    """Run the reference recursion in interval arithmetic, at a precision that rises until every enclosure is tight.

    An enclosure is tight if it is one double, or two neighbours (three where the true value cannot be told from the
    middle one). It need not be narrower than 2^-80 of the norm of its vector (of the number itself, for tau), nor than
    2^-200 of the terms that add up to it and of the largest number of its quantity or of 1 SI unit, because a true zero
    has no last bit.

    The formulas are taken as they stand: a quaternion whose length is not exactly 1 rotates by the matrix that they
    yield.

    Args:
        model: the robot.
        q: coordinates, (..., nq) [rad or m]; these doubles are exact.
        v: rates, (..., nv).
        a: accelerations, (..., nv).
        loads: payloads; leading axes broadcast with those of q, v, a.
        parameters: `"doubles"`: the model's own, with rounded rotations and axes; `"read"`: the doubles nearest to the
            file's decimals, with rotations, axes and turned tensors computed from them without rounding; `"text"`: the
            same from the decimals themselves.

    Returns:
        The enclosures, rounded outwards.

    Raises:
        InputError: the model has no such parameters, because it has no file or was altered since it was read.
        NumberError: a result is beyond float64.
        ShapeError: leading axes do not broadcast.
    """
    choice("parameters", parameters, *get_args(Parameters))
    batch = batch_shape((q, v, a), loads)
    rows = math.prod(batch)
    q, v, a = (np.broadcast_to(x, (*batch, x.shape[-1])).reshape(rows, x.shape[-1]) for x in (q, v, a))
    loads = [flat(load, batch, rows) for load in loads]
    vectors = [np.broadcast_to(x, (rows, 3)) for load in loads for x in (load.f, load.n)]
    frames = tuple((load.link, load.in_base) for load in loads)

    @cache
    def rounding() -> dict[str, Array]:
        """A running error bound on each number of each state; asked for only where something is near zero."""
        from rttrr_pin.exact.rounding import bounded_dynamics

        return dict(bounded_dynamics(model, q, v, a, loads)[1].items())

    numbers, bits, tight = _enclosed(model, np.hstack([q, v, a, *vectors]), frames, parameters, rounding)
    ends = [split_columns(model, end) for end in numbers]
    for parts in ends:
        check_overflow(LinkWrenches.of(parts | {"tau_joint": parts["tau"]}, model.link_names, model.v_names), q, v, a)
    return Enclosures(
        **{key: Enclosure(*(x[key].reshape(*batch, *x[key].shape[1:]) for x in ends)) for key in QUANTITIES},
        bits=bits.reshape(batch),
        tight=tight.reshape(batch),
        links=model.link_names,
        joints=model.v_names,
        parameters=parameters,
    )


def _enclosed(
    model: Model, states: Array, frames: LoadFrames, parameters: Parameters, rounding: Callable[[], dict[str, Array]]
) -> tuple[Array, NDArray[np.int64], NDArray[np.bool_]]:
    """Lower and upper ends of all numbers, (2, N, numbers), the bits that were needed, and which states are tight."""
    rows = len(states)
    ends = np.zeros((2, rows, model.nv + 12 * len(model.links)))
    bits, tight = np.zeros(rows, dtype=np.int64), np.zeros(rows, dtype=np.bool_)
    pending = np.arange(rows)
    prepare, columns = _recursion(model, frames, parameters, rows)
    for bits_now in PRECISIONS:
        if not len(pending):
            break
        with precision(bits_now):
            run = prepare()
            for row in pending:
                pairs = [enclosing_doubles(x) for x in run(states[row].tolist())]
                ends[:, row] = np.array(pairs, dtype=np.float64).reshape(-1, 2)[columns].T
        bits[pending] = bits_now
        tight[pending] = _tight(model, ends[0, pending], ends[1, pending], pending, rounding)
        pending = pending[~tight[pending]]
    return ends, bits, tight


def _recursion(
    model: Model, frames: LoadFrames, parameters: Parameters, rows: int
) -> tuple[Callable[[], Run], NDArray[np.intp]]:
    """A function that prepares, at the precision in force, the evaluation of a state; and the column of each number."""
    if rows >= STRAIGHT_LINE_FROM:
        from rttrr_pin.exact.straight_line import straight_line  # loads the compiler

        return straight_line(model, frames, parameters)

    def prepare() -> Run:
        if parameters == "doubles":
            exact, links = model, [body_of(*pair, INTERVAL) for pair in zip(model.joints, model.links, strict=True)]
        else:
            of_file = exact_parameters(model, parameters)
            exact, links = of_file.model, of_file.bodies(INTERVAL, lambda square: interval(square).rsqrt())
        return lambda state: [arb(x) for x in flat_dynamics(exact, INTERVAL, [arb(x) for x in state], frames, links)]

    return prepare, np.arange(model.nv + 12 * len(model.links))


def enclosing_doubles(x: arb) -> tuple[float, float]:
    """The nearest doubles that an interval lies between: one, two neighbours, or as far apart as it is wide."""
    middle = float(x)
    if not math.isfinite(middle):
        return middle, middle
    # A comparison of intervals holds only where it holds for all their numbers: `not x >= y` does not mean x < y.
    below = middle if x >= middle else math.nextafter(middle, -math.inf)
    above = middle if x <= middle else math.nextafter(middle, math.inf)
    if x >= below and x <= above:
        return below, above
    lower, upper = float(x.lower()), float(x.upper())
    while not x >= lower:
        lower = math.nextafter(lower, -math.inf)
    while not x <= upper:
        upper = math.nextafter(upper, math.inf)
    return lower, upper


def _tight(
    model: Model, lower: Array, upper: Array, states: NDArray[np.intp], rounding: Callable[[], dict[str, Array]]
) -> NDArray[np.bool_]:
    """Which of some states are tight, (N,); `rounding` bounds that of all, by quantity."""
    narrow = np.nextafter(np.nextafter(lower, np.inf), np.inf) >= upper
    if narrow.all():
        return np.ones(len(lower), dtype=np.bool_)
    with np.errstate(over="ignore", invalid="ignore"):
        low, high, bounds = split_columns(model, lower), split_columns(model, upper), rounding()
        for key, part in split_columns(model, narrow).items():
            size, bound = np.maximum(np.abs(low[key]), np.abs(high[key])), bounds[key][states]
            if key != "tau":
                size, bound = norm(size)[..., None], norm(bound)[..., None]
            largest = np.maximum(
                np.abs(high[key]).max(axis=tuple(range(1, size.ndim)), keepdims=True, initial=0.0), 1.0
            )
            enough = np.minimum(ABSOLUTE_WIDTH * largest, ROUNDING_WIDTH * bound)
            part |= high[key] - low[key] <= np.fmax(RELATIVE_WIDTH * size, enough)
    return np.asarray(narrow.all(axis=1))
