"""Trajectories that are made: from rest to rest between poses, and what RTTRR does when it picks and places."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rttrr_pin.core.arguments import not_negative, positive, text, whole_number
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import blocks
from rttrr_pin.core.inputs import Coordinates, coordinates, finite, real
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError
from rttrr_pin.implementations.text_results import PAYLOAD
from rttrr_pin.robot import Robot
from rttrr_pin.robot.robot import model_of
from rttrr_pin.trajectories.findings import Findings
from rttrr_pin.trajectories.rows import AT_ONCE, Rows, Source, documented, numbered
from rttrr_pin.trajectories.stream import Trajectory

PICK_AND_PLACE = "pick-and-place"
"""What the command line calls it."""

HOME = (0.0, 0.0, 0.0, 0.0, 0.0)
ABOVE, PICK = (-0.8, 0.05, 0.15, 0.3, 0.4), (-0.8, -0.12, 0.15, 0.3, 0.4)
BEYOND, PLACE = (1.1, 0.1, 0.28, -0.5, -0.3), (1.1, -0.05, 0.28, -0.5, -0.3)
"""Poses of RTTRR [rad, m, m, rad, rad]."""

CYCLE: tuple[tuple[tuple[float, ...], float, bool], ...] = (
    (ABOVE, 1.0, False),
    (PICK, 0.7, False),
    (PICK, 0.3, False),
    (PICK, 0.2, True),
    (ABOVE, 0.7, True),
    (BEYOND, 1.6, True),
    (PLACE, 0.6, True),
    (PLACE, 0.3, True),
    (PLACE, 0.2, False),
    (BEYOND, 0.6, False),
    (HOME, 1.2, False),
)
"""Where it goes, in which time [s], and whether it carries the body; at each pose it is at rest."""

CARRIED, SIDE = (0.0, 0.0, 0.05), 0.1
"""Of a cube between the fingers: its centre in the frame of the tool, and its side [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class _Moves:
    """Poses one after the other, and when each is reached: the first at 0."""

    poses: Array
    reached: Array

    def at(self, t: Array) -> tuple[Array, Array, Array, NDArray[np.intp]]:
        """q, v, a of quintics between the poses, and which move each time is in."""
        k = np.clip(np.searchsorted(self.reached, t, side="right") - 1, 0, len(self.reached) - 2)
        T = (self.reached[k + 1] - self.reached[k])[:, None]
        s = (t[:, None] - self.reached[k, None]) / T
        way = self.poses[k + 1] - self.poses[k]
        q = self.poses[k] + way * (s**3 * (10.0 - 15.0 * s + 6.0 * s**2))
        v = way * (30.0 * s**2 * (1.0 - s) ** 2) / T
        a = way * (60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)) / T**2
        return q, v, a, k


def rest_to_rest(
    robot: Robot,
    poses: ArrayLike | Sequence[Coordinates],
    durations: ArrayLike,
    rate: float = 1000.0,
    name: str = "rest-to-rest",
) -> Trajectory:
    """A trajectory that is at rest at each pose, without a jump of acceleration: q is a quintic of time in between.

    Args:
        robot: whose trajectory it is; of its joints that move each has one coordinate.
        poses: coordinates (K, nq), or K dicts by joint name.
        durations: of each move, (K - 1,), or one for all [s].
        rate: rows a second [Hz]; the last pose has a row, too, where it is reached between two.
        name: as messages call it.

    Raises:
        ShapeError, NumberError, UnknownNameError, MissingJointError: a pose cannot be used.
        InputError: there are fewer than two, a duration or the rate is not positive, or a joint floats.
    """
    model = model_of(robot)
    if several := [joint.name for joint in model.moving if joint.nq > 1]:
        raise InputError(f"joint {several[0]!r} has several coordinates: pass q, v and a to trajectory(...)")
    if isinstance(poses, Sequence) and any(isinstance(pose, Mapping) for pose in poses):
        q = np.stack(np.broadcast_arrays(*(coordinates("q", pose, model.moving) for pose in poses)))
    else:
        q = coordinates("q", cast(ArrayLike, poses), model.moving)
    if q.ndim != 2 or len(q) < 2:
        raise InputError(f"poses have shape {q.shape}, expected (K, {model.nq}) with two or more: pass where it goes")
    times = finite("durations", real("durations", durations))
    if times.ndim > 1 or (times.ndim and len(times) != len(q) - 1) or not (times > 0.0).all():
        raise InputError(f"durations are {times.tolist()}: expected {len(q) - 1} positive times, one for each move")
    moves = _Moves(q, np.concatenate([[0.0], np.cumsum(np.broadcast_to(times, len(q) - 1))]))
    return Trajectory(_source(name, model, moves, rate), model)


def pick_and_place(
    robot: Robot | None = None, *, mass: float = 2.0, cycles: int = 1, rate: float = 1000.0
) -> Trajectory:
    """What RTTRR does when it picks a cube up, turns, and puts it down; with the wrench of the cube in its hand.

    Args:
        robot: RTTRR, or an arm with its joints; None: the one that comes with the package.
        mass: of the cube [kg].
        cycles: how often.
        rate: rows a second [Hz].

    Raises:
        InputError: the robot has other joints, or a number cannot be used.
    """
    own = _rttrr()
    arm = own if robot is None else robot
    kinds = [[(joint.name, joint.type.name) for joint in model.moving] for model in (model_of(arm), own.model)]
    if kinds[0] != kinds[1] or "tool" not in arm.link_names:
        raise InputError(
            f"{PICK_AND_PLACE} is a trajectory of RTTRR, and {arm.name!r} has other joints: use rest_to_rest(...)"
        )
    count = whole_number("cycles", cycles, 1, 10**6)
    steps = CYCLE * count
    reached = np.concatenate([[0.0], np.cumsum([own for _, own, _ in steps])])
    moves = _Moves(np.array([HOME, *(pose for pose, _, _ in steps)]), reached)
    kilograms = not_negative("mass", mass)
    inertia = np.eye(3) * kilograms * SIDE**2 / 6.0
    carrying = arm.with_payload_body(kilograms, CARRIED, inertia, link="tool")
    carried = np.array([own for _, _, own in steps])
    return Trajectory(_source(PICK_AND_PLACE, arm.model, moves, rate, carrying, carried), arm.model)


def _rttrr() -> Robot:
    from rttrr_pin.urdf.reader import read_urdf  # loads lxml
    from rttrr_pin.urdf.sources import Reading

    return Robot(read_urdf("rttrr", Reading(False, {}, False, True, {})))


def _source(
    name: str,
    model: Model,
    moves: _Moves,
    rate: float,
    carrying: Robot | None = None,
    carried: NDArray[np.bool_] | None = None,
) -> Source:
    """Rows of moves, with the wrench of what is carried in some of them."""
    rate, name = positive("rate", rate, "rows a second"), text("name", name)
    end = float(moves.reached[-1])
    whole = math.floor(end * rate * (1.0 + 1e-12))
    last = whole / rate < end - 1e-9 / rate  # the end is between two rows, and has one of its own
    count = whole + 1 + int(last)

    def read(findings: Findings) -> Iterator[Rows]:
        for part in blocks(count, AT_ONCE):
            numbers = numbered(part.start, part.stop - part.start)
            t = np.minimum(numbers / rate, end)
            q, v, a, k = moves.at(t)
            values = {"q": q, "v": v, "a": a}
            if carrying is not None and carried is not None:
                values[PAYLOAD] = _wrench(carrying, values) * carried[k, None]
            yield Rows(numbers, t, values)

    labels: dict[str, tuple[str, ...]] = documented(model)
    loads: tuple[tuple[int, bool], ...] = ()
    if carrying is not None:
        labels[PAYLOAD] = tuple(f"{PAYLOAD}_{key}_tool_{axis}" for key in "fn" for axis in "xyz")
        loads = ((model.link_index("tool"), False),)
    return Source(name, read, labels, loads, unit=1.0, n_rows=count)


def _wrench(carrying: Robot, values: dict[str, Array]) -> Array:
    """What the hand exerts on the body in it, about the origin of the tool and in its axes, (N, 6)."""
    result = carrying.inverse_dynamics(values["q"], values["v"], values["a"])
    return np.hstack([result.f[:, -1], result.n[:, -1]])
