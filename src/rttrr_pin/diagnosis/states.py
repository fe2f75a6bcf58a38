"""States that tell programs apart: gravity alone, single rates, single accelerations, pairs of rates, all, payloads.

An error that shows in gravity alone is in masses or centres of mass; one that shows with a single rate, in centrifugal
terms or friction; and so on. The first states of each kind are of round numbers, so that a difference can be followed
by hand.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, RandomPayload
from rttrr_pin.errors import InputError
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.robot import Robot
from rttrr_pin.validation.sampling import ACCELERATION, Ranges
from rttrr_pin.validation.states import model_of

MOST = 10**6
"""States of a sample; a million are far more than a diagnosis reads."""

ROUND = (0.5, 1.0, -1.0)
"""Coordinates, rates and accelerations of the first states of each kind, where the limits of the file allow them."""

WRENCH = 10.0, 1.0
"""Force [N] and moment [N m] of the first states with a payload, along one axis each."""

PARTS = {"gravity": 16, "one rate": 14, "one acceleration": 14, "two rates": 21, "random": 20, "payload": 15}
"""By kind of states its percentage of a sample."""

FIRST = ("random", "gravity", "payload", "one rate", "one acceleration", "two rates")
"""Which kinds a sample has that has fewer states than there are kinds."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """States to run a program on.

    Attributes:
        states: q, v, a, and the payload of each state: zero where it has none.
        kinds: of each state what it shows, one of "gravity", "one rate", "one acceleration", "two rates", "random",
            "payload".
    """

    states: Batch
    kinds: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.kinds)

    @property
    def counts(self) -> dict[str, int]:
        """By kind, how many states there are."""
        return {kind: self.kinds.count(kind) for kind in dict.fromkeys(self.kinds)}


def sample_states(
    robot: Robot,
    n: int = 500,
    seed: int = 0,
    payload: RandomPayload | None = RandomPayload(),  # noqa: B008 - frozen
) -> Sample:
    """States at which a program shows what it does otherwise, kind after kind.

    Coordinates and rates are within the limits of the file; where it has none, within half a turn and half a turn per
    second [m, m/s]. Poses are zero, round or random; gravity acts in all states.

    Args:
        robot: the robot.
        n: how many states; where they are fewer than kinds, there is one of each of the first n in `FIRST`.
        seed: of the generator; the same one gives the same states.
        payload: random ones, at its link or else at each last link in turn; None for no states with payload.

    Raises:
        InputError: an argument cannot be used, or the robot has no joint.
        UnknownNameError: no link is called as the payload's.
    """
    model = model_of(robot, "there is nothing to sample")
    n = whole_number("n", n, 1, MOST, "10^6", "-n")
    seed = whole_number("seed", seed, 0, 2**128 - 1, "2^128 - 1", "--seed")
    if not isinstance(payload, RandomPayload | None):
        raise InputError(f"payload is a {type(payload).__name__}: expected None or a RandomPayload()")
    draw = _Draw.of(model, seed, payload)
    blocks = {kind: KINDS[kind](draw, np.arange(count)) for kind, count in _counts(draw, n).items()}
    q, v, a, f, moment, link = (np.concatenate(columns) for columns in zip(*blocks.values(), strict=True))
    loads = tuple(
        Load(own, np.where((link == own)[:, None], f, 0.0), np.where((link == own)[:, None], moment, 0.0))
        for own in draw.links
        if (link == own).any()
    )
    kinds = tuple(kind for kind, block in blocks.items() for _ in block[0])
    return Sample(Batch(model, model.coordinates_at(q), v, a, loads), kinds)


Indices = NDArray[np.int64]

Block = tuple[Array, Array, Array, Array, Array, Indices]
"""Displacements, rates, accelerations (rows, nv); force and moment (rows, 3) at the link of that index, or at -1."""


@dataclass(frozen=True, slots=True, eq=False)
class _Draw:
    """Where numbers come from.

    Attributes:
        rng: the generator.
        ranges: of each degree of freedom.
        zero: displacements nearest to zero, (nv,).
        q: displacements of each of `ROUND`, (3, nv).
        v: rates of each of them, (3, nv).
        links: indices of the links that payloads act at.
        payload: their ranges.
    """

    rng: np.random.Generator
    ranges: Ranges
    zero: Array
    q: Array
    v: Array
    links: tuple[int, ...]
    payload: RandomPayload

    @classmethod
    def of(cls, model: Model, seed: int, payload: RandomPayload | None) -> _Draw:
        ranges = Ranges.of(model)
        limits, rates = (ranges.lower, ranges.upper), (-ranges.rate, ranges.rate)
        named = None if payload is None else payload.link
        links = model.leaves() if named is None else (model.link_index(named),)
        return cls(
            rng=np.random.Generator(np.random.Philox(key=seed)),
            ranges=ranges,
            zero=_within(0.0, *limits),
            q=np.stack([_within(x, *limits) for x in ROUND]),
            v=np.stack([_within(x, *rates) for x in ROUND]),
            links=() if payload is None else links,
            payload=payload or RandomPayload(),
        )

    @property
    def nv(self) -> int:
        """Degrees of freedom."""
        return len(self.zero)

    def poses(self, rows: int) -> Array:
        """Random displacements."""
        return self.rng.uniform(self.ranges.lower, self.ranges.upper, (rows, self.nv))

    def rates(self, rows: int) -> Array:
        """Random rates."""
        return self.rng.uniform(-1.0, 1.0, (rows, self.nv)) * self.ranges.rate

    def accelerations(self, rows: int) -> Array:
        """Random accelerations."""
        return self.rng.uniform(-ACCELERATION, ACCELERATION, (rows, self.nv))

    def block(self, q: Array, v: Array | None = None, a: Array | None = None) -> Block:
        """States without payload, at rest unless it is said."""
        still, none = np.zeros_like(q), np.zeros((len(q), 3))
        return q, still if v is None else v, still if a is None else a, none, none, np.full(len(q), -1)


def _gravity(draw: _Draw, k: Indices) -> Block:
    """At rest: at zero, one joint after the other at a round number, all at round numbers, at random."""
    q = draw.poses(len(k))
    q[:1] = draw.zero
    singles = min(draw.nv, len(k) // 3)
    for joint, row in enumerate(q[1 : 1 + singles]):
        row[:] = draw.zero
        row[joint] = draw.q[joint % len(ROUND), joint]
    rest = q[1 + singles : 1 + singles + len(ROUND)]
    rest[:] = draw.q[: len(rest)]
    return draw.block(q)


def _one_rate(draw: _Draw, k: Indices) -> Block:
    """One joint after the other runs: at zero, then at round, then at random poses."""
    q, v = _single(draw, k, draw.v, draw.rates(len(k)))
    return draw.block(q, v=v)


def _one_acceleration(draw: _Draw, k: Indices) -> Block:
    """One joint after the other is accelerated, likewise."""
    q, a = _single(draw, k, np.tile(np.array(ROUND)[:, None], draw.nv), draw.accelerations(len(k)))
    return draw.block(q, a=a)


def _single(draw: _Draw, k: Indices, fixed: Array, random: Array) -> tuple[Array, Array]:
    """Poses, and what all joints but one have none of."""
    lap, joint = np.divmod(k, draw.nv)
    q, x = _early(lap, [draw.zero, draw.q[0]], draw.poses(len(k))), _early(lap, [fixed[1], fixed[2]], random)
    return q, np.where(np.arange(draw.nv) == joint[:, None], x, 0.0)


def _two_rates(draw: _Draw, k: Indices) -> Block:
    """One pair of joints after the other runs, neighbours first: at round rates of two signs, then at random."""
    pairs = np.array([(i, i + d) for d in range(1, draw.nv) for i in range(draw.nv - d)])
    lap, pair = np.divmod(k, len(pairs))
    q = _early(lap, [draw.q[0], draw.q[0]], draw.poses(len(k)))
    first, second = (pairs[pair, i][:, None] == np.arange(draw.nv) for i in (0, 1))
    signs = [draw.v[1], draw.v[2]]
    v = np.where(first, _early(lap, [signs[0]] * 2, draw.rates(len(k))), 0.0)
    v = np.where(second, _early(lap, signs, draw.rates(len(k))), v)
    return draw.block(q, v=v)


def _random(draw: _Draw, k: Indices) -> Block:
    """All at once: the first at round numbers."""
    q, v, a = draw.poses(len(k)), draw.rates(len(k)), draw.accelerations(len(k))
    joint = np.arange(draw.nv)
    for row in range(min(len(ROUND), len(k))):
        q[row], v[row] = (x[(row + joint + shift) % len(ROUND), joint] for shift, x in enumerate((draw.q, draw.v)))
        a[row] = np.array(ROUND)[(row + joint + 2) % len(ROUND)]
    return draw.block(q, v, a)


def _payload(draw: _Draw, k: Indices) -> Block:
    """Each last link in turn: at rest, along one axis after the other; then all at random."""
    rows = len(k)
    lap, turn = np.divmod(k, len(draw.links))
    bounds = np.repeat([draw.payload.force, draw.payload.moment], 3)
    units = np.diag(np.minimum(np.repeat(WRENCH, 3), bounds))
    wrench = _early(lap, units, draw.rng.uniform(-1.0, 1.0, (rows, 6)) * bounds)
    still = np.zeros(draw.nv)
    q = _early(lap, [draw.q[0]] * len(units), draw.poses(rows))
    v, a = (_early(lap, [still] * len(units), x) for x in (draw.rates(rows), draw.accelerations(rows)))
    return q, v, a, wrench[:, :3], wrench[:, 3:], np.array(draw.links)[turn]


KINDS: dict[str, Callable[[_Draw, Indices], Block]] = {
    "gravity": _gravity,
    "one rate": _one_rate,
    "one acceleration": _one_acceleration,
    "two rates": _two_rates,
    "random": _random,
    "payload": _payload,
}
"""How the states of each kind are made, from their numbers within the kind."""


def _early(lap: Indices, fixed: list[Array] | Array, random: Array) -> Array:
    """Random rows, the first of which are fixed ones, one for each lap."""
    rows = random.copy()
    for own, row in enumerate(fixed):
        rows[lap == own] = row
    return rows


def _counts(draw: _Draw, n: int) -> dict[str, int]:
    """How many states of each kind that the robot can show, at least one of each where n allows it."""
    impossible = {"one rate": draw.nv < 1, "one acceleration": draw.nv < 1, "two rates": draw.nv < 2}
    impossible["payload"] = not draw.links
    kinds = [kind for kind in PARTS if not impossible.get(kind)]
    if n < len(kinds):
        chosen = [kind for kind in FIRST if kind in kinds][:n]
        return {kind: 1 for kind in kinds if kind in chosen}
    whole = sum(PARTS[kind] for kind in kinds)
    ends = np.cumsum([PARTS[kind] for kind in kinds]) * (n - len(kinds)) // whole
    return {kind: 1 + int(count) for kind, count in zip(kinds, np.diff(ends, prepend=0), strict=True)}


def _within(wanted: float, lower: Array, upper: Array) -> Array:
    """In each range the wanted number, its opposite, or the one of few digits that is nearest."""
    return np.array([_nearest(wanted, *pair) for pair in zip(lower.tolist(), upper.tolist(), strict=True)])


def _nearest(wanted: float, lower: float, upper: float) -> float:
    for own in (wanted, -wanted):
        if lower <= own <= upper:
            return own + 0.0
    end = min(max(wanted, lower), upper)
    digits = 0 if end == 0.0 else -math.floor(math.log10(abs(end)))
    for decimals in range(digits, digits + 17):
        scale = 10.0**decimals
        rounded = (math.ceil if end == lower else math.floor)(end * scale) / scale
        if lower <= rounded <= upper:
            return rounded
    return end
