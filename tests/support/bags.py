"""Bags of ROS with messages of joints, as rosbag2 and ROS 1 write them."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from rosbags import rosbag1, rosbag2
from rosbags.rosbag2 import StoragePlugin
from rosbags.typesys import Stores, get_typestore

NANO = 1_000_000_000

STORE, OLD_STORE = get_typestore(Stores.ROS2_JAZZY), get_typestore(Stores.ROS1_NOETIC)

STATE, TRAJECTORY = "sensor_msgs/msg/JointState", "trajectory_msgs/msg/JointTrajectory"

Sent = tuple[str, str, int, dict[str, Any]]
"""Topic, type, when it is written [ns], and what its fields are; `stamp` is the header's [ns]."""


def state(topic: str, t: int, names: Sequence[str], q: Any, v: Any = (), stamp: int | None = None) -> Sent:
    fields = {"name": list(names), "position": _array(q), "velocity": _array(v), "effort": _array(())}
    return topic, STATE, t, {"stamp": t if stamp is None else stamp, **fields}


def path(topic: str, t: int, names: Sequence[str], points: Iterable[tuple[int, Any, Any, Any]]) -> Sent:
    return topic, TRAJECTORY, t, {"stamp": t, "joint_names": list(names), "points": list(points)}


def _array(x: Any) -> np.ndarray:
    return np.asarray(x, np.float64)


def _message(types: Any, kind: str, fields: dict[str, Any], old: bool) -> Any:
    time_of, duration_of = (types[f"builtin_interfaces/msg/{x}"] for x in ("Time", "Duration"))
    header_of = types["std_msgs/msg/Header"]
    own = dict(fields)
    sec, nanosec = divmod(own.pop("stamp"), NANO)
    seq = {"seq": 0} if old else {}
    own["header"] = header_of(**seq, stamp=time_of(sec=sec, nanosec=nanosec), frame_id="")
    if kind == TRAJECTORY:
        point_of = types["trajectory_msgs/msg/JointTrajectoryPoint"]
        own["points"] = [
            point_of(_array(q), _array(v), _array(a), _array(()), duration_of(*divmod(t, NANO)))
            for t, q, v, a in own["points"]
        ]
    return types[kind](**own)


def write_bag(target: Path, messages: Iterable[Sent]) -> Path:
    """A bag of the kind that the name's end says: `.mcap`, `.bag`, or a folder with a database."""
    if target.suffix == ".bag":
        with rosbag1.Writer(target) as writer:
            return _written(target, writer, messages, OLD_STORE)
    plugin = StoragePlugin.MCAP if target.suffix == ".mcap" else StoragePlugin.SQLITE3
    folder = target.with_suffix("")
    with rosbag2.Writer(folder, version=9, storage_plugin=plugin) as writer:
        _written(target, writer, messages, STORE)
    if target.suffix != ".mcap":
        return folder
    (file,) = folder.glob("*.mcap")
    shutil.move(file, target)
    shutil.rmtree(folder)
    return target


def _written(target: Path, writer: Any, messages: Iterable[Sent], store: Any) -> Path:
    connections: dict[str, Any] = {}
    for topic, kind, t, fields in messages:
        if topic not in connections:
            connections[topic] = writer.add_connection(topic, kind, typestore=store)
        message = _message(store.types, kind, fields, store is OLD_STORE)
        serialized = store.serialize_ros1 if store is OLD_STORE else store.serialize_cdr
        writer.write(connections[topic], t, serialized(message, kind))
    return target
