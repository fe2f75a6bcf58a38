"""The states at which programs are compared.

State k of a seed is the same however the work is cut: it is made from the block of a counter-based generator
(Philox; Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", 2011) that belongs to k alone.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, RandomPayload, load_of, payload_link
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.implementations.protocol import Batch

Indices = NDArray[np.int64]

Payload = Wrench | RandomPayload | None
"""None; a wrench, the same in every state; or a random one in each."""

PER_COUNTER = 4
"""Doubles that one value of Philox's counter yields."""

DEFAULT = {"rad": math.pi, "m": 1.0}
"""Half range of a coordinate, and largest rate per second, where the file leaves them open or sets them to 0."""

NO_LIMIT = 1e9
"""Beyond it a limit says that there is none: files have 1e16 or the largest double for that."""

ACCELERATION = 10.0
"""Largest acceleration, per second squared; URDF has no limit for it."""

LARGE_VELOCITY = 100.0
"""Times the velocity limit: velocity terms then rule, as gravity does at rest."""

LAST_STATE = 10**15
"""More than anyone can compute, and far below what an index holds."""


@dataclass(frozen=True, slots=True, eq=False)
class Ranges:
    """From where to where each degree of freedom goes, (nv,) each.

    A floating joint's rotation is drawn as a rotation vector, and becomes a quaternion at the end.
    """

    lower: Array
    upper: Array
    rate: Array
    angle: NDArray[np.bool_]

    @classmethod
    def of(cls, model: Model) -> Ranges:
        """The limits of the file, and finite defaults where it has none."""
        freedoms = [(joint, "rad" if rotates else "m") for joint in model.moving for rotates in joint.type.rotations]
        lower, upper = np.array([_range(joint, DEFAULT[unit]) for joint, unit in freedoms]).reshape(-1, 2).T
        limits = [(_limit(joint.limits.velocity), DEFAULT[unit]) for joint, unit in freedoms]
        rate = [limit if math.isfinite(limit) and limit > 0.0 else default for limit, default in limits]
        return cls(lower, upper, np.array(rate), np.array([unit == "rad" for _, unit in freedoms], dtype=bool))


Triple = tuple[Array, Array, Array]
Sampling = Callable[[Array, Indices, Ranges], Triple]


def _uniform(unit: Array, k: Indices, ranges: Ranges) -> Triple:
    """Every coordinate, rate and acceleration uniform within its range."""
    q, v, a = np.split(unit, 3)
    lower, upper, rate = (x[:, None] for x in (ranges.lower, ranges.upper, ranges.rate))
    return lower + q * (upper - lower), (2 * v - 1) * rate, (2 * a - 1) * ACCELERATION


def _corners(unit: Array, k: Indices, ranges: Ranges) -> Triple:
    """Each at its lower end, zero, or its upper end; angles also at plus or minus a right angle. All within limits."""
    q, v, a = np.split(unit, 3)
    zero = np.zeros_like(ranges.lower)
    right = np.where(ranges.angle, math.pi / 2, 0.0)
    corners = np.clip(np.stack([ranges.lower, ranges.upper, zero, right, -right]), ranges.lower, ranges.upper)
    at = np.take_along_axis(corners.T, (q * len(corners)).astype(int), axis=1)
    return at, (np.floor(3 * v) - 1) * ranges.rate[:, None], (np.floor(3 * a) - 1) * ACCELERATION


def _zeros(unit: Array, k: Indices, ranges: Ranges) -> Triple:
    """State k has zero q, v and a as the bits of k mod 8 say; the rest is uniform. State 7 is all zeros."""
    q, v, a = (x * ((k >> bit & 1) == 0) for bit, x in enumerate(_uniform(unit, k, ranges)))
    return q, v, a


def _one_joint(unit: Array, k: Indices, ranges: Ranges) -> Triple:
    """Joint k mod nv at a uniform state, the others at zero and at rest."""
    moving = np.arange(len(ranges.lower))[:, None] == k % max(len(ranges.lower), 1)
    q, v, a = (x * moving for x in _uniform(unit, k, ranges))
    return q, v, a


def _large_velocities(unit: Array, k: Indices, ranges: Ranges) -> Triple:
    """Uniform, with rates a hundred times the limit."""
    q, v, a = _uniform(unit, k, ranges)
    return q, v * LARGE_VELOCITY, a


def _mixed(unit: Array, k: Indices, ranges: Ranges) -> Triple:
    """State k by the sampling k mod 5."""
    out = np.empty_like(unit)
    for turn, sampling in enumerate(list(SAMPLINGS.values())[:5]):
        own = np.flatnonzero(k % 5 == turn)
        out[:, own] = np.concatenate(sampling(unit[:, own], k[own] // 5, ranges))
    q, v, a = np.split(out, 3)
    return q, v, a


SAMPLINGS: dict[str, Sampling] = {
    "uniform": _uniform,
    "corners": _corners,
    "zeros": _zeros,
    "one-joint": _one_joint,
    "large-velocities": _large_velocities,
    "mixed": _mixed,
}
"""How states are drawn, by name: from columns of numbers in [0, 1), (3 nv, N), and the indices of the states."""


class Sampler:
    """Draws states of a robot; state k depends on sampling, seed and k alone.

    Attributes:
        model: the robot.
        sampling: one of `SAMPLINGS`.
        seed: from 0 to 2^128 - 1.
        payload: the load of every state; a random one, another in each; or None.
    """

    def __init__(self, model: Model, sampling: str = "uniform", seed: int = 0, payload: Payload | Load = None) -> None:
        """Prepare to draw; a random payload acts at its link, in the link's axes.

        Raises:
            UnknownNameError: there is no such sampling or link.
            InputError: the seed is out of range, or the payload is none, names no link where there are several last
                ones, or has a batch axis.
        """
        if not isinstance(sampling, str) or sampling not in SAMPLINGS:
            raise UnknownNameError("sampling", sampling, SAMPLINGS)
        seed = whole_number("seed", seed, 0, 2**128 - 1, "2^128 - 1", "--seed")
        self.model, self.sampling, self.seed = model, sampling, seed
        self.payload = load_of(model, payload) if isinstance(payload, Wrench) else payload
        if isinstance(self.payload, Load):
            if self.payload.f.ndim + self.payload.n.ndim > 2:
                raise InputError(
                    "the payload of a validation has a batch axis: pass one force and one moment of 3 numbers"
                )
        elif isinstance(self.payload, RandomPayload):
            self._link = payload_link(model, self.payload.link)
        elif self.payload is not None:
            raise InputError(f"payload is {payload!r}: expected None, a Wrench or a RandomPayload()")
        self._ranges = Ranges.of(model)

    def draw(self, first: int, count: int) -> Batch:
        """The states first, first + 1, ..., first + count - 1."""
        whole_number("state", first, 0, LAST_STATE, "10^15", "--index")
        counters = -(-self.numbers // PER_COUNTER)  # whole ones for each state, so that state k begins at one
        generator = np.random.Generator(np.random.Philox(key=self.seed, counter=first * counters))
        return self.made_of(generator.random((count, counters * PER_COUNTER)), first)

    @property
    def numbers(self) -> int:
        """How many numbers make a state, payload included whether it is used or not."""
        return 3 * self.model.nv + 6

    def made_of(self, unit: Array, first: int = 0) -> Batch:
        """The states that numbers in [0, 1] stand for, (N, `numbers`) or wider, counted from `first`."""
        nv = self.model.nv
        k = first + np.arange(len(unit), dtype=np.int64)
        columns = np.ascontiguousarray(unit[:, : 3 * nv].T)
        q, v, a = (np.ascontiguousarray(x.T) for x in SAMPLINGS[self.sampling](columns, k, self._ranges))
        loads = self._loads(2 * unit[:, 3 * nv : 3 * nv + 6] - 1)
        return Batch(self.model, self.model.coordinates_at(q), v, a, loads, first)

    def _loads(self, unit: Array) -> tuple[Load, ...]:
        if self.payload is None:
            return ()
        if isinstance(self.payload, Load):
            return (self.payload,)
        return (Load(self._link, unit[:, :3] * self.payload.force, unit[:, 3:] * self.payload.moment),)


def _limit(limit: float) -> float:
    """A limit, or infinity where it is none in truth."""
    return limit if abs(limit) < NO_LIMIT else math.copysign(math.inf, limit)


def _range(joint: Joint, half: float) -> tuple[float, float]:
    """A finite range of coordinates; half of it where the file leaves an end open."""
    lower, upper = map(_limit, (joint.limits.lower, joint.limits.upper))
    if lower == upper == 0.0 or (math.isinf(lower) and math.isinf(upper)) or joint.nv > 1:
        return -half, half
    if math.isinf(lower):
        return upper - 2 * half, upper
    return lower, lower + 2 * half if math.isinf(upper) else upper
