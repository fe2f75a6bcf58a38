"""From a file, or a name, to a trajectory."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from rttrr_pin.core.arguments import path_of, text
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, UnknownNameError, shortened
from rttrr_pin.robot import Robot
from rttrr_pin.robot.robot import model_of
from rttrr_pin.trajectories.bags import SUFFIXES, bag_source, is_bag
from rttrr_pin.trajectories.built_in import PICK_AND_PLACE, pick_and_place
from rttrr_pin.trajectories.clock import known_unit
from rttrr_pin.trajectories.npz import npz_source
from rttrr_pin.trajectories.parquet import parquet_source
from rttrr_pin.trajectories.rows import Source
from rttrr_pin.trajectories.stream import Trajectory
from rttrr_pin.trajectories.text import csv_source, json_source
from rttrr_pin.urdf.files import note_read

Opener = Callable[[Path, Model, Sequence[str]], Source]

READERS: Mapping[str, Opener] = {
    ".csv": csv_source,
    ".jsonl": json_source,
    ".npz": npz_source,
    ".parquet": parquet_source,
}
"""By the end of the file's name."""


def read_trajectory(
    path: str | os.PathLike[str],
    robot: Robot,
    *,
    topic: str | None = None,
    cutoff: float | None = None,
    time_unit: str | None = None,
) -> Trajectory:
    """A trajectory from a file, which is read in blocks.

    Args:
        path: a table (`.csv`, `.jsonl`, `.parquet`, `.npz`) with `time` or `t`, `q_<joint>`, with or without `v_` and
            `a_`, with or without columns of a payload; or a bag (`.mcap`, `.db3`, `.bag`, or a folder of rosbag2) with
            JointState or JointTrajectory.
        robot: whose trajectory it is.
        topic: of a bag, where there are several of joints.
        cutoff: frequency up to which derived rates and accelerations follow the rows [Hz]; None: chosen by the noise.
        time_unit: "s", "ms", "us" or "ns"; None: by the distance of rows, and a note says so where it is not "s".

    Raises:
        InputError: the file cannot be read, or its first rows cannot be used.
        UnknownNameError: a column is of a joint that the robot has not, or the file is of no kind that is known.
        ImplementationError: a package that the kind of file needs is not installed.
    """
    model, unit = model_of(robot), known_unit(time_unit)
    source = open_source(path_of("path", path), model, topic=None if topic is None else text("topic", topic))
    return Trajectory(source if unit is None else replace(source, unit=unit), model, cutoff)


def open_source(path: Path, model: Model, more: Sequence[str] = (), topic: str | None = None) -> Source:
    """The rows of a file, and those of other quantities, such as tau; of a bag those of a topic.

    Raises:
        InputError, UnknownNameError, ImplementationError: as `read_trajectory`.
    """
    bag = _is_bag(path)
    opener = READERS.get(path.suffix.lower())
    if opener is None and not bag:
        kinds = (*READERS, *SUFFIXES)
        raise UnknownNameError("kind of trajectory", path.suffix or shortened(path.name), kinds)
    if not bag and not path.is_file():
        what = "is no file that can be read twice" if path.exists() else "does not exist"
        raise InputError(f"{shortened(str(path))} {what}: give a file")
    note_read(path)
    if bag:
        return bag_source(path, model, topic)
    if topic is not None:
        raise InputError(f"topic is for bags, and {path.name} is none: leave it out", {"topic": "--topic"})
    assert opener is not None
    return opener(path, model, more)


def _is_bag(path: Path) -> bool:
    """Whether it is one; it may not be there."""
    try:
        there = path.exists()
        bag = is_bag(path)
    except (OSError, ValueError) as error:  # a name too long, or with a zero byte
        raise InputError(f"{shortened(str(path))} cannot be read: {getattr(error, 'strerror', error)}") from None
    if bag and not there:
        raise InputError(f"{shortened(str(path))} does not exist: give a bag")
    return bag


def named(
    trajectory: str,
    robot: Robot,
    *,
    topic: str | None = None,
    cutoff: float | None = None,
    time_unit: str | None = None,
) -> Trajectory:
    """What a user calls a trajectory: a file, or `pick-and-place`.

    Args:
        trajectory: a path, or the name.
        robot: whose trajectory it is.
        topic: as in `read_trajectory`.
        cutoff: as in `read_trajectory`.
        time_unit: as in `read_trajectory`.

    Raises:
        InputError, UnknownNameError, ImplementationError: as `read_trajectory`.
    """
    if trajectory != PICK_AND_PLACE:
        return read_trajectory(trajectory, robot, topic=topic, cutoff=cutoff, time_unit=time_unit)
    for name, value in (("topic", topic), ("cutoff", cutoff), ("time_unit", time_unit)):
        if value is not None:
            option = f"--{name.replace('_', '-')}"
            raise InputError(f"{name} is for files, and {PICK_AND_PLACE} is none: leave it out", {name: option})
    return pick_and_place(robot)
