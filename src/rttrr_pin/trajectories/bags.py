"""Trajectories in bags of ROS: MCAP, rosbag2 and ROS 1, of one topic of JointState or JointTrajectory."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rttrr_pin.core.model import Model
from rttrr_pin.errors import ImplementationError, InputError, RttrrError, UnknownNameError, listed, shortened, told
from rttrr_pin.trajectories.rows import Source

STATE, TRAJECTORY = "sensor_msgs/msg/JointState", "trajectory_msgs/msg/JointTrajectory"

SUFFIXES = (".mcap", ".db3", ".bag")
"""How files of bags end; the folders of rosbag2 have a `metadata.yaml` in them."""

NANO = 1_000_000_000


@dataclass(frozen=True, slots=True)
class Message:
    """A message, as much of it as is needed.

    Attributes:
        number: among those of its topic, from 1 on.
        log_time: when it was written [ns].
        data: the message itself.
    """

    number: int
    log_time: int
    data: Any

    @property
    def stamp(self) -> int:
        """Of its header [ns]; 0 where nobody filled it in."""
        return nanoseconds(self.data.header.stamp)


def nanoseconds(time: Any) -> int:
    """A time or a duration of ROS."""
    return int(time.sec) * NANO + int(time.nanosec)


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic of a bag.

    Attributes:
        path: of the bag.
        name: of the topic.
        kind: type of its messages.
    """

    path: Path
    name: str
    kind: str

    def messages(self) -> Iterator[Message]:
        """From the first on, in the order of the bag.

        Raises:
            InputError: the bag is damaged.
        """
        with _opened(self.path) as reader:
            own = [connection for connection in reader.connections if connection.topic == self.name]
            for number, (connection, time, data) in enumerate(reader.messages(own), 1):
                yield Message(number, time, reader.deserialize(data, connection.msgtype))

    def first(self) -> Message:
        """The first message.

        Raises:
            InputError: there is none, or the bag is damaged.
        """
        message = next(self.messages(), None)
        if message is None:
            raise InputError(f"{self.path.name} has no message of topic {self.name}")
        return message


def is_bag(path: Path) -> bool:
    """Whether a path is one of a bag."""
    return path.suffix.lower() in SUFFIXES or (path / "metadata.yaml").is_file()


def bag_source(path: Path, model: Model, topic: str | None = None) -> Source:
    """The topic that is named, or the only one of states or trajectories of joints.

    Raises:
        InputError: the bag cannot be read, has no such topic, or several.
        UnknownNameError: it has no topic of that name.
        ImplementationError: rosbags is not installed.
    """
    from rttrr_pin.trajectories.joint_states import state_source
    from rttrr_pin.trajectories.joint_trajectories import trajectory_source

    several = [joint.name for joint in model.moving if joint.nq > 1]
    if several:
        raise InputError(
            f"{path.name}: messages of ROS have one number for each joint, and {several[0]!r} has several coordinates: "
            "write a table with columns for all of them"
        )
    chosen = _chosen(path, topic)
    return state_source(chosen, model) if chosen.kind == STATE else trajectory_source(chosen, model)


def _chosen(path: Path, topic: str | None) -> Topic:
    with _opened(path) as reader:
        kinds = {connection.topic: connection.msgtype for connection in reader.connections}
        counts = Counter[str]()
        for connection in reader.connections:
            counts[connection.topic] += connection.msgcount
    usable = {name: kind for name, kind in kinds.items() if kind in (STATE, TRAJECTORY) and counts[name]}
    if topic is not None:
        if topic not in kinds:
            raise UnknownNameError("topic", topic, kinds, f"in {path.name}")
        if topic not in usable:
            raise InputError(
                f"{path.name}: topic {topic} has {counts[topic]} messages of {kinds[topic]}: expected some of {STATE} "
                f"or {TRAJECTORY}"
            )
        return Topic(path, topic, kinds[topic])
    if len(usable) == 1:
        ((name, kind),) = usable.items()
        return Topic(path, name, kind)
    if usable:
        shown = listed((f"{name} ({counts[name]} of {kind.rpartition('/')[2]})" for name, kind in usable.items()), 12)
        raise InputError(
            f"{path.name} has several topics of joints, {shown}: pass topic={next(iter(usable))!r}, or another",
            {f"pass topic={next(iter(usable))!r}": f"pass --topic {next(iter(usable))}"},
        )
    shown = listed((f"{shortened(name)} ({kind})" for name, kind in kinds.items()), 12) or "none"
    raise InputError(f"{path.name} has no message of {STATE} or {TRAJECTORY}; its topics are {shown}")


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """A reader of rosbags; all that it and its libraries raise is an error of the file."""
    try:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise ImplementationError("bags need rosbags, which is not installed: pip install 'rttrr-pin[logs]'") from error
    try:
        with AnyReader([path], default_typestore=get_typestore(Stores.ROS2_JAZZY)) as reader:
            yield reader
    except RttrrError:
        raise
    except Exception as error:  # damaged files raise what compression, databases and parsers raise
        raise InputError(f"{path.name} cannot be read as a bag: {told(error)}") from error


@dataclass(frozen=True, slots=True)
class Stamps:
    """The time of messages: of their headers, or when they were written where headers have none.

    Attributes:
        logged: whether it is when they were written.
        origin: what time counts from [ns].
    """

    logged: bool
    origin: int

    @staticmethod
    def of(first: Message) -> Stamps:
        """As the first message has it; since 1970 it counts from there."""
        logged = first.stamp == 0
        own = first.log_time if logged else first.stamp
        return Stamps(logged, own if own >= 10**6 * NANO else 0)

    def time(self, message: Message) -> int:
        """From the origin on [ns]."""
        return (message.log_time if self.logged else message.stamp) - self.origin

    def notes(self) -> tuple[str, ...]:
        """What a reader must know."""
        logged = ("headers have no stamp: time is when messages were written",) if self.logged else ()
        whole, rest = divmod(self.origin, NANO)
        return (*logged, *((f"time counts from {whole}.{rest:09d} s",) if self.origin else ()))
