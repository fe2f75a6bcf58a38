"""Files hold what inverse dynamics gives, with its units; whole or not at all."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rttrr_pin import InputError, Robot, load
from rttrr_pin.errors import UnknownNameError
from rttrr_pin.loads import compute_loads
from support.trajectories import OfBlock, random_rows

ALL = ("tau", "F", "N", "f", "n", "power", "energy")


def read(path: Path) -> tuple[dict[str, NDArray[Any]], dict[str, str]]:
    """By column its numbers, and its unit."""
    if path.suffix == ".csv":
        with path.open(newline="") as file:
            header, *rows = csv.reader(file)
        heads = [name.removesuffix("]").partition(" [") for name in header]
        columns = zip(*rows, strict=True)
        text = {name: np.array(own) for (name, _, _), own in zip(heads, columns, strict=True)}
        numbers = {name: x.astype(float) if "frame" not in name else x for name, x in text.items()}
        return numbers, {name: unit for name, _, unit in heads}
    if path.suffix == ".parquet":
        from pyarrow import parquet

        table = parquet.read_table(path)
        assert table.schema.metadata[b"robot"] and table.schema.metadata[b"wrenches"]
        units = {own.name: (own.metadata or {}).get(b"unit", b"").decode() for own in table.schema}
        return {name: table.column(name).to_numpy() for name in table.column_names}, units
    with np.load(path) as archive:
        about = json.loads(str(archive["about"]))
        named = {
            name: (column, unit, archive[key].reshape(len(archive["time"]), -1)[:, k])
            for key, columns in about["columns"].items()
            for k, (name, unit) in enumerate(columns)
            for column in [name]
        }
    return {name: x for name, (_, _, x) in named.items()}, {name: unit for name, (_, unit, _) in named.items()}


@pytest.mark.parametrize("end", [".csv", ".parquet", ".npz"])
def test_rows_are_what_inverse_dynamics_gives(end: str, tree: Robot, tmp_path: Path) -> None:
    block = random_rows(tree, 25, payload=True)
    file = tmp_path / f"loads{end}"
    compute_loads(tree, OfBlock(tree, block), quantities=ALL, output=file)
    columns, units = read(file)
    result = tree.inverse_dynamics(block.q, block.v, block.a, block.payload)
    np.testing.assert_array_equal(columns["time"], block.time)
    for j, name in enumerate(tree.model.v_names):
        np.testing.assert_array_equal(columns[f"tau_{name}"], result.tau[:, j])
        power = result.tau[:, j] * block.v[:, j]
        np.testing.assert_array_equal(columns[f"power_{name}"], power)
        steps = np.diff(block.time) * (power[1:] + power[:-1]) / 2
        np.testing.assert_allclose(columns[f"energy_{name}"], np.cumsum([0.0, *steps]), rtol=1e-9, atol=1e-9)
        rotation = tree.model.rotations[j]
        wanted = ("N m" if rotation else "N", "W", "J")
        assert tuple(units[f"{key}_{name}"] for key in ("tau", "power", "energy")) == wanted
    for i, link in enumerate(tree.link_names):
        for key, unit in (("F", "N"), ("N", "N m"), ("f", "N"), ("n", "N m")):
            for k, axis in enumerate("xyz"):
                np.testing.assert_array_equal(columns[f"{key}_{link}_{axis}"], getattr(result, key)[:, i, k])
                assert units[f"{key}_{link}_{axis}"] == unit


@pytest.mark.parametrize("name", ["mujoco", "gazebo", "newton"])
def test_wrenches_are_written_as_another_program_says_them(name: str, tree: Robot, tmp_path: Path) -> None:
    block = random_rows(tree, 10, errors=True)
    file = tmp_path / "loads.csv"
    compute_loads(tree, OfBlock(tree, block), quantities=("f", "n"), convention=name, output=file)
    columns, _ = read(file)
    said = tree.inverse_dynamics(block.q, block.v, block.a).in_convention(name)
    for i, link in enumerate(tree.link_names):
        for k, axis in enumerate("xyz"):
            np.testing.assert_array_equal(columns[f"force_{link}_{axis}"], said.force[:, i, k])
            np.testing.assert_array_equal(columns[f"moment_{link}_{axis}"], said.moment[:, i, k])
            assert (columns[f"force_{link}_{axis}_error"] >= 0.0).all()
    assert not any(own.startswith(("f_", "n_")) for own in columns)


@pytest.mark.parametrize("end", [".csv", ".parquet"])
def test_messages_have_the_names_of_ros(end: str, tree: Robot, tmp_path: Path) -> None:
    block = random_rows(tree, 12)
    file = tmp_path / f"wrenches{end}"
    compute_loads(tree, OfBlock(tree, block), wrench_stamped=file)
    columns, units = read(file)
    assert list(columns)[:3] == ["header.stamp.sec", "header.stamp.nanosec", "header.frame_id"]
    result = tree.inverse_dynamics(block.q, block.v, block.a)
    assert list(columns["header.frame_id"]) == list(tree.link_names) * len(block)
    stamp = columns["header.stamp.sec"] + 1e-9 * columns["header.stamp.nanosec"]
    np.testing.assert_allclose(stamp, np.repeat(block.time, len(tree.link_names)), atol=1e-9)
    for k, axis in enumerate("xyz"):
        np.testing.assert_array_equal(columns[f"wrench.force.{axis}"], result.f[..., k].ravel())
        np.testing.assert_array_equal(columns[f"wrench.torque.{axis}"], result.n[..., k].ravel())
    assert units["wrench.torque.x"] == "N m"


def test_a_bag_is_read_by_rosbags(tree: Robot, tmp_path: Path) -> None:
    from rosbags import highlevel as rosbags

    block = random_rows(tree, 6)
    file = tmp_path / "wrenches.mcap"
    compute_loads(tree, OfBlock(tree, block), wrench_stamped=file, convention="gazebo")
    said = tree.inverse_dynamics(block.q, block.v, block.a).in_convention("gazebo")
    seen: dict[str, list[tuple[float, ...]]] = {}
    with rosbags.AnyReader([file]) as bag:
        for connection, stamp, raw in bag.messages():
            message = bag.deserialize(raw, connection.msgtype)
            assert connection.msgtype == "geometry_msgs/msg/WrenchStamped"
            assert stamp == message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
            parts = (message.wrench.force, message.wrench.torque)
            seen.setdefault(message.header.frame_id, []).append(tuple(getattr(x, k) for x in parts for k in "xyz"))
    for i, link in enumerate(tree.link_names):
        np.testing.assert_array_equal(seen[link], np.hstack([said.force[:, i], said.moment[:, i]]))
    assert [path.name for path in tmp_path.iterdir()] == ["wrenches.mcap"]


def test_what_acts_on_a_link_adds_up_to_zero(tree: Robot, tmp_path: Path) -> None:
    block = random_rows(tree, 20, payload=True)
    file = tmp_path / "cases.csv"
    report = compute_loads(tree, OfBlock(tree, block), load_cases=file)
    with file.open(newline="") as text:
        rows = list(csv.DictReader(text))
    assert len({row["state"] for row in rows}) == len(report.states)
    sums: dict[tuple[str, str], NDArray[np.float64]] = {}
    sizes: dict[tuple[str, str], float] = {}
    for row in rows:
        x = {key.partition(" ")[0]: float(value) for key, value in row.items() if key.endswith("]") and "_" in key}
        at, force, moment = (np.array([x[f"{key}_{k}"] for k in "xyz"]) for key in ("at", "force", "moment"))
        acting = np.concatenate([force, moment + np.cross(at, force)])
        key = (row["state"], row["link"])
        sums[key] = sums.get(key, np.zeros(6)) + acting
        sizes[key] = sizes.get(key, 0.0) + np.abs(acting).sum()
    assert {link for _, link in sums} == {tree.model.root.name, *tree.link_names}
    for (state, link), total in sums.items():
        if link != tree.model.root.name:
            assert np.abs(total).max() <= 1e-12 * (1.0 + sizes[state, link])


class Stopped(KeyboardInterrupt):
    """Ctrl-C."""


@pytest.mark.parametrize(("end", "messages"), [(".csv", ".mcap"), (".parquet", ".csv"), (".npz", ".csv")])
def test_nothing_is_left_of_a_run_that_is_stopped(end: str, messages: str, tree: Robot, tmp_path: Path) -> None:
    file, other = tmp_path / f"loads{end}", tmp_path / f"wrenches{messages}"
    file.write_text("as it was")

    def stop(done: int) -> None:
        raise Stopped

    motion = OfBlock(tree, random_rows(tree, 30))
    with pytest.raises(Stopped):
        compute_loads(tree, motion, output=file, wrench_stamped=other, progress=stop)
    assert [path.name for path in tmp_path.iterdir()] == [file.name] and file.read_text() == "as it was"


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"output": "x.xlsx"}, UnknownNameError, r"no kind of output is called '.xlsx': .*\.csv, \.parquet, \.npz"),
        ({"wrench_stamped": "x.npz"}, UnknownNameError, "no kind of wrench_stamped is called '.npz'"),
        ({"quantities": "torque"}, UnknownNameError, "no quantity is called 'torque'"),
        ({"quantities": ()}, InputError, "quantities is empty"),
        ({"convention": "mujoco", "output": "x.csv"}, InputError, "neither is asked for: add f or n"),
        ({"convention": "mujoco", "wrench_stamped": "x.csv"}, InputError, "take 'gazebo'"),
        ({"output": "no/such/folder/x.csv"}, InputError, "cannot be written: No such file or directory"),
    ],
)
def test_what_cannot_be_written_is_said_first(
    arguments: dict[str, Any],
    error: type[Exception],
    message: str,
    tree: Robot,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=message):
        compute_loads(tree, OfBlock(tree, random_rows(tree, 3)), **arguments)
    assert list(tmp_path.iterdir()) == []


def test_time_that_a_stamp_cannot_hold_is_an_error(tree: Robot, tmp_path: Path) -> None:
    block = random_rows(tree, 3)
    block.time[:] += 2.0**31
    with pytest.raises(InputError, match=r"in row 2, and a stamp of ROS holds less than 2\^31 s"):
        compute_loads(tree, OfBlock(tree, block), wrench_stamped=tmp_path / "x.csv")
    block.time[:] -= 2.0**31 + 100.0
    with pytest.raises(InputError, match="time begins before 0"):
        compute_loads(tree, OfBlock(tree, block), wrench_stamped=tmp_path / "x.mcap")
    compute_loads(tree, OfBlock(tree, block), wrench_stamped=tmp_path / "x.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["x.csv"]


def test_nanoseconds_that_round_to_a_second_are_one(tree: Robot, tmp_path: Path) -> None:
    block = random_rows(tree, 2)
    block.time[:] = 1.9999999999, 2.5
    compute_loads(tree, OfBlock(tree, block), wrench_stamped=tmp_path / "x.csv")
    columns, _ = read(tmp_path / "x.csv")
    stamps = zip(columns["header.stamp.sec"], columns["header.stamp.nanosec"], strict=True)
    assert set(stamps) == {(2.0, 0.0), (2.0, 500_000_000.0)}


def test_names_of_links_are_cells_and_topics_of_their_own(tmp_path: Path) -> None:
    """Whatever is in them."""
    links = "".join(
        f'<link name="{name}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        f'</inertial></link><joint name="j{k}" type="fixed"><parent link="b"/><child link="{name}"/></joint>'
        for k, name in enumerate(["a,b", "a;b", "&lt;script&gt;", "&quot;x&quot;", "ä"])
    )
    robot = load(f'<robot name="r"><link name="b"/>{links}</robot>')
    block = random_rows(robot, 3)
    compute_loads(robot, OfBlock(robot, block), quantities=("f",), output=tmp_path / "x.csv")
    compute_loads(robot, OfBlock(robot, block), wrench_stamped=tmp_path / "y.csv")
    assert {own.split(" ")[0] for own in read(tmp_path / "x.csv")[0]} >= {f"f_{name}_x" for name in robot.link_names}
    assert set(read(tmp_path / "y.csv")[0]["header.frame_id"]) == set(robot.link_names)
    from rosbags import highlevel as rosbags

    compute_loads(robot, OfBlock(robot, block), wrench_stamped=tmp_path / "y.mcap")
    with rosbags.AnyReader([tmp_path / "y.mcap"]) as bag:
        assert len({own.topic for own in bag.connections}) == 5
