"""How arrows are drawn: a length for each newton, and places, axes and sizes of shafts and heads."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.viewing.scene import Arrows

SHAFT, HEAD, WIDTH = 0.008, 0.055, 0.022
"""Radius of a shaft, length and radius of a head, of the size of the robot."""

LONGEST = 50.0
"""Of the size of the robot: longer arrows end there; their numbers do not."""

FIRST = 0.4
"""Of the size of the robot: about how long the longest arrow is at first."""

NOTHING = 1e-9
"""The size of what is not drawn: of zero, a renderer makes NaN."""


def rung(index: int) -> float:
    """The ladder ..., 0.5, 1, 2, 5, 10, ... of scales; 1 at 0."""
    power, step = divmod(index, 3)
    return float(f"{(1, 2, 5)[step]}e{power}")


def rung_of(value: float) -> int:
    """The lowest rung that is at least a value; 0 where that is no positive number."""
    if not 0.0 < value < math.inf:
        return 0
    index = 3 * math.floor(math.log10(value))
    while rung(index) < value * (1.0 - 1e-12):
        index += 1
    return index


def fitting(arrows: Iterable[Arrows], reach: float) -> int:
    """The rung of N (or N m) for each metre at which the longest of some arrows is about `FIRST` of the robot."""
    largest = max((float(own.size.max(initial=0.0)) for own in arrows), default=0.0)
    return rung_of(largest / (FIRST * reach))


@dataclass(frozen=True, slots=True, eq=False)
class Instances:
    """Copies of a solid that stands along z: of radius 1, from z = 0 to z = 1.

    Attributes:
        wxyz: the rotation of each, a unit quaternion, (N, 4).
        position: (N, 3) [m].
        scale: (N, 3) [m].
    """

    wxyz: Array
    position: Array
    scale: Array


def shafts(arrows: Arrows, per_metre: float, reach: float) -> Instances:
    """From the beginning of each arrow to its head."""
    length, direction = _lengths(arrows, per_metre, reach)
    head = _head(length, reach)
    radius = SHAFT * reach * head / (HEAD * reach)
    size = np.stack([radius, radius, length - head], axis=-1)
    return Instances(_turns(direction), arrows.at, np.maximum(size, NOTHING))


def heads(arrows: Arrows, per_metre: float, reach: float, double: bool) -> Instances:
    """The heads, which end where the arrows do; moments have two, one behind the other."""
    length, direction = _lengths(arrows, per_metre, reach)
    head = _head(length, reach)
    radius = WIDTH / HEAD * head
    size = np.maximum(np.stack([radius, radius, head], axis=-1), NOTHING)
    turns = _turns(direction)
    behind = [arrows.at + direction * (length - head * k)[:, None] for k in ((1.0, 1.7) if double else (1.0,))]
    n = len(behind)
    return Instances(np.tile(turns, (n, 1)), np.concatenate(behind), np.tile(size, (n, 1)))


def sticks(lines: Arrows, radius: float) -> Instances:
    """Cylinders from where lines begin to where they end."""
    length = lines.size
    direction = np.divide(lines.vector, length[:, None], out=np.zeros_like(lines.vector), where=length[:, None] > 0.0)
    size = np.stack([np.where(length > 0.0, radius, NOTHING)] * 2 + [np.maximum(length, NOTHING)], axis=-1)
    return Instances(_turns(direction), lines.at, size)


def tips(arrows: Arrows, per_metre: float, reach: float) -> Array:
    """Where the arrows end, (N, 3) [m]."""
    length, direction = _lengths(arrows, per_metre, reach)
    return np.asarray(arrows.at + direction * length[:, None])


def _lengths(arrows: Arrows, per_metre: float, reach: float) -> tuple[Array, Array]:
    """Lengths [m] and unit vectors."""
    size = arrows.size
    direction = np.divide(arrows.vector, size[:, None], out=np.zeros_like(arrows.vector), where=size[:, None] > 0.0)
    return np.minimum(size / per_metre, LONGEST * reach), direction


def _head(length: Array, reach: float) -> Array:
    """Lengths of heads: of a short arrow a part of it."""
    return np.minimum(HEAD * reach, 0.4 * length)


def _turns(direction: Array) -> Array:
    """Quaternions (w, x, y, z) that turn z to unit vectors, by the shortest way."""
    x, y, z = direction.T
    down = z < -1.0 + 1e-12
    quaternion = np.stack([1.0 + z, -y, x, np.zeros_like(x)], axis=-1)
    quaternion[down] = (0.0, 1.0, 0.0, 0.0)
    return np.asarray(quaternion / np.linalg.norm(quaternion, axis=-1, keepdims=True))


AROUND = 32
"""Sides of the solids that stand for round ones."""


def cylinder() -> tuple[Array, np.ndarray]:
    """Corners and triangles of a cylinder of radius 1 from z = 0 to z = 1."""
    return _turned(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 1.0], [0.0, 1.0]]))


def cone() -> tuple[Array, np.ndarray]:
    """Corners and triangles of a cone of radius 1 from z = 0 to its tip at z = 1."""
    return _turned(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 1.0]]))


def ball() -> tuple[Array, np.ndarray]:
    """Corners and triangles of a ball of radius 1 about the origin."""
    angles = np.linspace(-math.pi / 2, math.pi / 2, AROUND // 2 + 1)
    return _turned(np.stack([np.cos(angles), np.sin(angles)], axis=-1))


def _turned(profile: Array) -> tuple[Array, np.ndarray]:
    """The surface that a line of (radius, height) makes about z; a corner that stands twice is an edge."""
    angles = np.arange(AROUND) * (2.0 * math.pi / AROUND)
    r, z = profile[:, :1], profile[:, 1:]
    ring = np.stack([r * np.cos(angles), r * np.sin(angles), np.broadcast_to(z, (len(r), AROUND))], axis=-1)
    k, j = np.meshgrid(np.arange(len(profile) - 1), np.arange(AROUND), indexing="ij")
    a, b = k * AROUND + j, k * AROUND + (j + 1) % AROUND
    quads = np.stack([np.stack([a, b, b + AROUND], -1), np.stack([a, b + AROUND, a + AROUND], -1)], -2)
    return ring.reshape(-1, 3), quads.reshape(-1, 3)
