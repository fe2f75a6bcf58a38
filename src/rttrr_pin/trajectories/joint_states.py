"""Messages of JointState as rows: in any order of joints, of one publisher or of several with some joints each."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, listed
from rttrr_pin.trajectories.bags import NANO, Message, Stamps, Topic
from rttrr_pin.trajectories.clock import GAP
from rttrr_pin.trajectories.findings import Findings
from rttrr_pin.trajectories.rows import LINES_AT_ONCE, Rows, Source

HEAD = 2000
"""Messages that tell which joints come together."""

LONGEST = 100_000
"""Messages that wait for joints of another publisher, at most."""

Joints = tuple[int, ...]
"""Indices among those of the robot that move, in increasing order."""


@dataclass(frozen=True, slots=True, eq=False)
class _Sample:
    """Some joints at a time: q, and v where it is there; (joints,) each."""

    time: int
    number: int
    q: Array
    v: Array | None


@dataclass(slots=True, eq=False)
class _Reading:
    """From messages to samples: where in a message each joint stands, by the names that it has."""

    topic: Topic
    model: Model
    stamps: Stamps
    findings: Findings
    _places: dict[tuple[str, ...], tuple[Joints, list[int], list[str]]] = field(default_factory=dict)

    def sample(self, message: Message) -> tuple[Joints, _Sample]:
        """The joints of a message, and their numbers.

        Raises:
            InputError: it has more or less positions or rates than names.
        """
        data = message.data
        names = tuple(data.name)
        joints, places, unknown = self._places.get(names) or self._placed(names)
        for name in unknown:
            self.findings.add("unknown joint", name, np.array([message.number]), np.zeros(1))
        count = len(names)
        for kind, x in (("positions", data.position), ("velocities", data.velocity)):
            if len(x) not in (0, count):
                raise InputError(
                    f"{self.topic.path.name}, {self.topic.name}, message {message.number}: {len(x)} {kind} of {count} "
                    "joints: write one for each, or none"
                )
        time = self.stamps.time(message)
        if not len(data.position):
            return (), _Sample(time, message.number, np.zeros(0), None)
        v = np.asarray(data.velocity, np.float64)[places] if len(data.velocity) else None
        return joints, _Sample(time, message.number, np.asarray(data.position, np.float64)[places], v)

    def _placed(self, names: tuple[str, ...]) -> tuple[Joints, list[int], list[str]]:
        twice = [name for name in names if names.count(name) > 1]
        if twice:
            raise InputError(f"{self.topic.path.name}, {self.topic.name}: a message names joint {twice[0]!r} twice")
        moving, every = list(self.model.joint_names), {joint.name for joint in self.model.joints}
        own = sorted((moving.index(name), place) for place, name in enumerate(names) if name in moving)
        unknown = [name for name in names if name not in every]
        result = tuple(joint for joint, _ in own), [place for _, place in own], unknown
        self._places[names] = result
        return result


@dataclass(frozen=True, slots=True)
class _Groups:
    """Which messages make rows: those of `clock`, with joints of `others` at the same times.

    Attributes:
        clock: joints of the messages whose stamps rows have.
        others: joints of other messages, by how far apart these are usually [ns].
        rates: whether all have rates.
    """

    clock: Joints
    others: dict[Joints, float]
    rates: bool


def state_source(topic: Topic, model: Model) -> Source:
    """The rows of a topic.

    Raises:
        InputError: joints of the robot are in no message, or the bag is damaged.
    """
    stamps = Stamps.of(topic.first())
    groups, notes = _groups(_Reading(topic, model, stamps, Findings("message")), model)

    def read(findings: Findings) -> Iterator[Rows]:
        reading = _Reading(topic, model, stamps, findings)
        samples = map(reading.sample, topic.messages())
        rows = _alone(samples, groups, findings) if not groups.others else _together(samples, groups, model, findings)
        while chunk := list(islice(rows, LINES_AT_ONCE)):
            yield _rows(chunk, groups.rates)

    name = topic.name
    labels = {
        key: tuple(f"{name} {word} of {joint}" for joint in model.joint_names)
        for key, word in (("q", "position"), ("v", "velocity"))
        if key == "q" or groups.rates
    }
    return Source(topic.path.name, read, labels, place="message", unit=1.0, notes=(*stamps.notes(), *notes))


def _groups(reading: _Reading, model: Model) -> tuple[_Groups, list[str]]:
    """Which joints come together in the first messages."""
    times: dict[Joints, list[int]] = {}
    rates: dict[Joints, bool] = {}
    for joints, sample in map(reading.sample, islice(reading.topic.messages(), HEAD)):
        if joints:
            times.setdefault(joints, []).append(sample.time)
            rates[joints] = rates.get(joints, True) and sample.v is not None
    whole = tuple(range(len(model.moving)))
    if whole in times or not whole:
        return _Groups(whole, {}, rates.get(whole, False)), []
    found = {joint for joints in times for joint in joints}
    missing = [model.joint_names[joint] for joint in whole if joint not in found]
    if missing:
        raise InputError(
            f"{reading.topic.path.name}, {reading.topic.name}: no message has a position of {listed(missing)}"
        )
    counts = Counter({joints: len(own) for joints, own in times.items()})
    clock = max(times, key=lambda joints: (counts[joints], len(joints)))
    others: dict[Joints, float] = {}
    left = set(whole) - set(clock)
    for joints, _ in counts.most_common():
        if joints != clock and left & set(joints):
            others[joints] = float(np.median(np.diff(times[joints]))) if len(times[joints]) > 1 else np.inf
            left -= set(joints)
    names = [model.joint_names[joint] for joint in sorted(set(whole) - set(clock))]
    note = f"{listed(names)} come in messages of their own: taken between two of them at the times of the other joints"
    return _Groups(clock, others, all(rates[own] for own in (clock, *others))), [note]


def _alone(
    samples: Iterator[tuple[Joints, _Sample]], groups: _Groups, findings: Findings
) -> Iterator[tuple[_Sample, Array, Array | None]]:
    """Messages that have all joints."""
    for joints, sample in samples:
        if joints != groups.clock or (groups.rates and sample.v is None):
            _left_out(sample, findings)
        else:
            yield sample, sample.q, sample.v


def _left_out(sample: _Sample, findings: Findings) -> None:
    findings.add("incomplete", "joints", np.array([sample.number]), np.zeros(1))


def _together(
    samples: Iterator[tuple[Joints, _Sample]], groups: _Groups, model: Model, findings: Findings
) -> Iterator[tuple[_Sample, Array, Array | None]]:
    """Rows at the times of one publisher, with joints of others between two of their messages."""
    waiting: deque[_Sample] = deque()
    seen: dict[Joints, deque[_Sample]] = {joints: deque() for joints in groups.others}
    turns = np.array([joint.type.rotates for joint in model.moving])
    for joints, sample in samples:
        if groups.rates and sample.v is None:
            _left_out(sample, findings)
        elif joints == groups.clock:
            waiting.append(sample)
            if len(waiting) > LONGEST:
                raise InputError(f"joints are missing from message {waiting[0].number} on: cut the bag there")
        elif joints in seen:
            seen[joints].append(sample)
        else:
            _left_out(sample, findings)
        while waiting and all(own and own[-1].time >= waiting[0].time for own in seen.values()):
            own = waiting.popleft()
            row = _between(own, seen, groups, turns)
            if row is None:
                _left_out(own, findings)
            else:
                yield own, *row
    for own in waiting:
        _left_out(own, findings)


def _between(
    sample: _Sample, seen: dict[Joints, deque[_Sample]], groups: _Groups, turns: NDArray[np.bool_]
) -> tuple[Array, Array | None] | None:
    """All joints at the time of a sample; None where another publisher says nothing around it."""
    q, v = np.zeros(len(turns)), np.zeros(len(turns))
    for joints, queue in seen.items():
        while len(queue) > 1 and queue[1].time <= sample.time:
            queue.popleft()
        after = queue[min(1, len(queue) - 1)] if queue[0].time < sample.time else queue[0]
        before = queue[0]
        apart = after.time - before.time
        if before.time > sample.time or apart > GAP * groups.others[joints]:
            return None
        share = (sample.time - before.time) / apart if apart else 0.0
        step = after.q - before.q
        turn = turns[list(joints)] & (np.abs(step) > np.pi)
        step = np.where(turn, step - 2 * np.pi * np.round(step / (2 * np.pi)), step)
        q[list(joints)] = before.q + share * step
        if before.v is not None and after.v is not None:
            v[list(joints)] = before.v + share * (after.v - before.v)
    q[list(groups.clock)] = sample.q
    if sample.v is not None:
        v[list(groups.clock)] = sample.v
    return q, v if groups.rates else None


def _rows(chunk: Sequence[tuple[_Sample, Array, Array | None]], rates: bool) -> Rows:
    values = {"q": np.array([q for _, q, _ in chunk])}
    if rates:
        values["v"] = np.array([v for _, _, v in chunk])
    numbers = np.array([sample.number for sample, _, _ in chunk], np.int64)
    return Rows(numbers, np.array([sample.time for sample, _, _ in chunk]) / NANO, values)
