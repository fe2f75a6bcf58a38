"""Messages of JointTrajectory as rows: their points, until another trajectory begins."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, listed
from rttrr_pin.trajectories.bags import NANO, Message, Stamps, Topic, nanoseconds
from rttrr_pin.trajectories.findings import Findings
from rttrr_pin.trajectories.rows import Rows, Source, numbered

FIELDS = {"q": "positions", "v": "velocities", "a": "accelerations"}

NOTE = "rows are the points of the messages; what a controller does between two of them is not in the bag"


def trajectory_source(topic: Topic, model: Model) -> Source:
    """The rows of a topic.

    Raises:
        InputError: no message has all joints of the robot, or the bag is damaged.
    """
    stamps = Stamps.of(topic.first())
    keys = _keys(topic, model)

    def read(findings: Findings) -> Iterator[Rows]:
        held: Rows | None = None
        count = 0
        for message in topic.messages():
            rows = _points(message, model, keys, stamps, count + 1, findings)
            count += len(message.data.points)
            if rows is None:
                continue
            if held is not None:
                yield from _until(held, float(rows.time[0]), findings)
            held = rows
        if held is not None:
            yield held

    labels = {key: tuple(f"{topic.name} {FIELDS[key]} of {joint}" for joint in model.joint_names) for key in keys}
    return Source(topic.path.name, read, labels, place="point", unit=1.0, notes=(*stamps.notes(), NOTE))


def _keys(topic: Topic, model: Model) -> tuple[str, ...]:
    """What the first message with all joints has of q, v and a.

    Raises:
        InputError: there is none.
    """
    missing: list[str] = list(model.joint_names)
    for message in topic.messages():
        data = message.data
        missing = [name for name in model.joint_names if name not in data.joint_names]
        if not missing and len(data.points):
            count = len(data.joint_names)
            there = (key for key in FIELDS if all(len(getattr(own, FIELDS[key])) == count for own in data.points))
            keys = tuple(there)
            if "q" in keys:
                return keys
    what = f"lacks {listed(missing)}" if missing else "has points without positions"
    raise InputError(
        f"{topic.path.name}, {topic.name}: no message has positions of all joints of the robot, the last one {what}"
    )


def _points(
    message: Message, model: Model, keys: tuple[str, ...], stamps: Stamps, first: int, findings: Findings
) -> Rows | None:
    """The points of a message; None where it lacks joints, or numbers that others have."""
    data = message.data
    names, points = list(data.joint_names), data.points
    numbers = numbered(first, len(points))
    known = {joint.name for joint in model.joints}
    for name in names:
        if name not in known:
            findings.add("unknown joint", name, numbers, np.zeros(len(numbers)))
    whole = all(len(getattr(own, FIELDS[key])) == len(names) for own in points for key in keys)
    if not whole or not set(model.joint_names) <= set(names):
        findings.add("incomplete", "joints", numbers, np.zeros(len(numbers)))
        return None
    if not len(points):
        return None
    order = [names.index(name) for name in model.joint_names]
    begin = stamps.time(message)
    t = np.array([begin + nanoseconds(own.time_from_start) for own in points]) / NANO
    values = {
        key: np.array([getattr(own, FIELDS[key]) for own in points], np.float64).reshape(len(points), -1)[:, order]
        for key in keys
    }
    return Rows(numbers, t, values)


def _until(rows: Rows, end: float, findings: Findings) -> Iterator[Rows]:
    """The points before the next trajectory begins."""
    before = rows.time < end
    late = ~before
    findings.add("replaced", "time", rows.numbers[late], rows.time[late], np.zeros(late.sum()))
    if before.any():
        yield rows.part(before)
