"""Wrenches as ROS has them: geometry_msgs/WrenchStamped, one message for each time and joint.

The frame is the child link's, the point its origin: f and n, what the link before exerts on it. Conventions that have
another frame or point cannot be said so.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.conventions import Convention
from rttrr_pin.core.model import Model
from rttrr_pin.errors import ImplementationError, InputError
from rttrr_pin.loads.output.tables import Arrays
from rttrr_pin.loads.quantities import Field
from rttrr_pin.reporting.files import writing
from rttrr_pin.trajectories import Block

NANO = 1_000_000_000

MOST_SECONDS = 2**31
"""What builtin_interfaces/Time has no number for."""

MESSAGE = "geometry_msgs/msg/WrenchStamped"

XYZ = ("x", "y", "z")

FIELDS = (
    Field("sec", (), ("header.stamp.sec",), ("s",), "int32"),
    Field("nanosec", (), ("header.stamp.nanosec",), ("ns",), "uint32"),
    Field("frame_id", (), ("header.frame_id",), ("",), "string"),
    Field("force", (3,), tuple(f"wrench.force.{k}" for k in XYZ), ("N",) * 3),
    Field("torque", (3,), tuple(f"wrench.torque.{k}" for k in XYZ), ("N m",) * 3),
)
"""The message's own names."""


def check_frame(row: Convention | None) -> None:
    """A convention that the message can say.

    Raises:
        InputError: its wrenches are in no frame of a link, or about another point.
    """
    if row is not None and (row.axes, row.point) != ("link", "origin"):
        raise InputError(
            f"convention {row.name!r} has {row.words}, and a WrenchStamped is about the origin of its frame: take "
            "'gazebo', which is what a force-torque sensor says, or none",
            options={"convention": "--convention"},
        )


def messages(model: Model, rows: Block, force: Array, torque: Array) -> dict[str, NDArray[Any]]:
    """The fields of the messages, time by time, joint by joint.

    Raises:
        InputError: a time is beyond what the message holds.
    """
    links = len(model.links)
    beyond = np.flatnonzero(~(np.abs(rows.time) < MOST_SECONDS - 1))
    if len(beyond):
        at = int(beyond[0])
        raise InputError(
            f"time is {rows.time[at]:.9g} s in row {rows.rows[at]}, and a stamp of ROS holds less than 2^31 s: "
            "let time begin later"
        )
    whole = np.floor(rows.time)
    nanos = np.rint((rows.time - whole) * NANO).astype(np.int64)
    seconds = whole.astype(np.int64) + nanos // NANO
    return {
        "sec": np.repeat(seconds, links),
        "nanosec": np.repeat(nanos % NANO, links),
        "frame_id": np.tile(np.array(model.link_names, dtype=object), len(rows)),
        "force": force.reshape(-1, 3),
        "torque": torque.reshape(-1, 3),
    }


class BagWriter:
    """An MCAP bag with a topic for each link, /loads/<link>."""

    def __init__(self, path: Path, shown: Path, fields: Sequence[Field], about: Mapping[str, str]) -> None:
        """Open it.

        Raises:
            ImplementationError: rosbags is not installed.
        """
        try:
            from rosbags.rosbag2 import StoragePlugin
            from rosbags.rosbag2 import Writer as RosbagWriter
            from rosbags.typesys import Stores, get_typestore
        except ImportError as error:
            raise ImplementationError(
                "an MCAP bag needs rosbags, which is not installed: pip install 'rttrr-pin[logs]'"
            ) from error
        self._path, self._shown = path, shown
        self._store = get_typestore(Stores.ROS2_JAZZY)
        self._topics: dict[str, Any] = {}
        with writing(shown):  # rosbags writes a folder, of which the bag is a file
            self._folder = tempfile.TemporaryDirectory(dir=path.parent, prefix=path.name)
            self._bag = RosbagWriter(Path(self._folder.name) / "bag", version=9, storage_plugin=StoragePlugin.MCAP)
            for key, value in about.items():
                self._bag.set_custom_data(key, value)
            self._bag.open()

    def write(self, arrays: Arrays) -> None:
        """Messages more."""
        types = self._store.types
        stamp_of, header_of = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
        vector, wrench_of = types["geometry_msgs/msg/Vector3"], types["geometry_msgs/msg/Wrench"]
        columns = (arrays[own.name].tolist() for own in FIELDS)
        if arrays["sec"].min(initial=0) < 0:
            raise InputError("time begins before 0, and the stamps of a bag do not: let it begin there, or take .csv")
        with writing(self._shown):
            for sec, nanosec, frame, force, torque in zip(*columns, strict=True):
                header = header_of(stamp=stamp_of(sec=sec, nanosec=nanosec), frame_id=frame)
                wrench = wrench_of(force=vector(*force), torque=vector(*torque))
                data = self._store.serialize_cdr(types[MESSAGE](header=header, wrench=wrench), MESSAGE)
                self._bag.write(self._topic(frame), sec * NANO + nanosec, data)

    def _topic(self, link: str) -> Any:
        if link not in self._topics:
            taken = {own.topic for own in self._topics.values()}
            name = "/loads/" + (re.sub(r"\W", "_", link, flags=re.ASCII) or "_")
            topic = next(own for own in [name, *(f"{name}_{k}" for k in range(2, 10**6))] if own not in taken)
            self._topics[link] = self._bag.add_connection(topic, MESSAGE, typestore=self._store)
        return self._topics[link]

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        try:
            with writing(self._shown):
                if kind is None:
                    self._bag.close()
                    (Path(self._folder.name) / "bag" / "bag.mcap").replace(self._path)
                else:
                    self._bag.abort()
        finally:
            self._folder.cleanup()
