"""One trajectory in each kind of file gives the same numbers; what cannot be read is named with row and column."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.errors import RttrrError
from rttrr_pin.trajectories import Block, read_trajectory
from support.logs import excitation

T = np.arange(300) / 250.0


@pytest.fixture(scope="module")
def arm() -> Robot:
    return rttrr_pin.load("rttrr")


def table(arm: Robot, **more: Any) -> dict[str, np.ndarray]:
    arrays = excitation(arm.model, T, 3)
    own = {
        f"{key}_{name}": x
        for key, y in zip("qva", arrays, strict=True)
        for name, x in zip(arm.joint_names, y.T, strict=True)
    }
    return {"time": T} | own | more


def write_csv(path: Path, columns: dict[str, np.ndarray]) -> Path:
    path = path.with_suffix(".csv")
    rows = zip(*(x.tolist() for x in columns.values()), strict=True)
    path.write_text("\n".join([",".join(columns), *(",".join(map(repr, row)) for row in rows)]) + "\n")
    return path


def write_parquet(path: Path, columns: dict[str, np.ndarray]) -> Path:
    parquet.write_table(pa.table(columns), path.with_suffix(".parquet"), row_group_size=77)
    return path.with_suffix(".parquet")


def write_npz(path: Path, columns: dict[str, np.ndarray]) -> Path:
    np.savez_compressed(path.with_suffix(".npz"), **columns)
    return path.with_suffix(".npz")


def write_arrays(path: Path, columns: dict[str, np.ndarray]) -> Path:
    names = [name[2:] for name in columns if name.startswith("q_")][::-1]
    arrays = {key: np.stack([columns[f"{key}_{name}"] for name in names], axis=1) for key in "qva"}
    rest = {name: x for name, x in columns.items() if name[:2] not in ("q_", "v_", "a_")}
    np.savez(path.with_suffix(".npz"), joint_names=names, **arrays, **rest)
    return path.with_suffix(".npz")


def write_json(path: Path, columns: dict[str, np.ndarray]) -> Path:
    path = path.with_suffix(".jsonl")
    names = [name[2:] for name in columns if name.startswith("q_")]
    lines = []
    for k, t in enumerate(columns["time"].tolist()):
        states = {key: {name: float(columns[f"{key}_{name}"][k]) for name in names} for key in "qva"}
        lines.append(json.dumps({"time": t} | states))
    path.write_text("\n".join(lines))
    return path


WRITERS: dict[str, Callable[[Path, dict[str, np.ndarray]], Path]] = {
    "csv": write_csv,
    "parquet": write_parquet,
    "npz": write_npz,
    "npz of arrays": write_arrays,
    "json": write_json,
}


def arrays_of(blocks: list[Block]) -> dict[str, np.ndarray]:
    return {key: np.concatenate([getattr(own, key) for own in blocks]) for key in ("time", "q", "v", "a")}


@pytest.mark.parametrize("kind", WRITERS)
def test_each_kind_of_file_gives_what_was_written(arm: Robot, tmp_path: Path, kind: str) -> None:
    read = read_trajectory(WRITERS[kind](tmp_path / "x", table(arm)), arm)
    got = arrays_of(list(read.blocks(100)))
    for key, x in zip(("time", "q", "v", "a"), (T, *excitation(arm.model, T, 3)), strict=True):
        assert np.array_equal(got[key], x), key
    assert not read.findings and not read.notes and read.n_rows in (None, len(T))


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz", "npz of arrays"])
def test_payloads_are_columns(arm: Robot, tmp_path: Path, kind: str) -> None:
    wrench = {
        f"payload_{key}_tool_{axis}": np.arange(300.0) + k
        for k, (key, axis) in enumerate(zip("fffnnn", "xyzxyz", strict=True))
    }
    read = read_trajectory(WRITERS[kind](tmp_path / "x", table(arm, **wrench)), arm)
    (load,) = next(read.blocks()).payload
    assert np.array_equal(np.hstack([load.f, load.n]), np.stack([*wrench.values()], axis=1))
    assert arm.link_names[load.link] == "tool" and not load.in_base


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
@pytest.mark.parametrize(
    ("spelled", "rate"),
    [
        ("{}", "{}.velocity"),
        ("position.{}", "velocity.{}"),
        ("{}_pos", "{}_vel"),
        ("/js/{}/position", "/js/{}/velocity"),
    ],
)
def test_columns_are_known_by_other_names_too(arm: Robot, tmp_path: Path, kind: str, spelled: str, rate: str) -> None:
    styles = {"q": spelled, "v": rate, "a": "a_{}"}
    if kind == "npz" and "/" in spelled:
        return
    own = {styles[name[0]].format(name[2:]) if name != "time" else "t": x for name, x in table(arm).items()}
    read = read_trajectory(WRITERS[kind](tmp_path / "x", own), arm)
    assert np.array_equal(arrays_of(list(read.blocks()))["q"], excitation(arm.model, T, 3)[0])
    assert any(note.startswith("q is read from ") for note in read.notes)


@pytest.mark.parametrize("kind", ["csv", "parquet", "npz"])
def test_stamps_since_1970_keep_their_digits(arm: Robot, tmp_path: Path, kind: str) -> None:
    stamps = 1_764_345_600_000_000_000 + np.arange(300) * 4_000_001
    read = read_trajectory(WRITERS[kind](tmp_path / "x", table(arm, time=stamps)), arm)
    np.testing.assert_allclose(arrays_of(list(read.blocks()))["time"], np.arange(300) * 4.000001e-3, rtol=1e-12)
    assert "time counts from 1764345600000000000" in read.notes[0]
    assert read.notes[1].startswith("time is taken as nanoseconds")


def test_types_of_time_say_their_unit(arm: Robot, tmp_path: Path) -> None:
    stamps = np.datetime64("2026-01-01T00:00:00", "us") + np.arange(300) * np.timedelta64(4000, "us")
    for kind in ("parquet", "npz"):
        read = read_trajectory(WRITERS[kind](tmp_path / "x", table(arm, time=stamps)), arm)
        np.testing.assert_allclose(arrays_of(list(read.blocks()))["time"], T, rtol=1e-12, atol=1e-12)


def test_decimals_of_large_times_are_kept(arm: Robot, tmp_path: Path) -> None:
    path = write_csv(tmp_path / "x", table(arm))
    header, *lines = path.read_text().splitlines()
    cells = (line.partition(",") for line in lines)
    path.write_text(
        "\n".join(
            [header, *(f"{1764345600 + k // 250}.{k % 250 * 4000:06d},{rest}" for k, (_, _, rest) in enumerate(cells))]
        )
    )
    read = read_trajectory(path, arm)
    np.testing.assert_allclose(arrays_of(list(read.blocks()))["time"], T, rtol=1e-15, atol=1e-15)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"q_joint_2": None}, "x.csv lacks the columns q_joint_2"),
        ({"v_joint_2": None}, "x.csv lacks the columns v_joint_2"),
        ({"time": None}, "x.csv has no column time or t"),
        ({"t": T}, "x.csv has several columns of time, time, t"),
        ({"q_joint_9": T}, "no column is called 'q_joint_9'"),
        ({"payload_f_tool_x": T}, "lacks the columns payload_f_tool_y"),
        ({"time": T[::-1]}, "x.csv, line 3, column time: it goes back by 0.004"),
        (
            {"a_joint_3": np.full(300, np.nan)},
            "no row that can be used: a_joint_3 is nan in 300 rows, the first in line 2",
        ),
    ],
)
def test_what_cannot_be_used_is_named(arm: Robot, tmp_path: Path, change: dict[str, Any], message: str) -> None:
    columns = {name: x for name, x in (table(arm) | change).items() if x is not None}
    with pytest.raises(RttrrError) as error:
        list(read_trajectory(write_csv(tmp_path / "x", columns), arm).blocks())
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        ("time,q_joint_1\n", "lacks the columns q_joint_2"),
        ("HEADER\n", "has a header and no row"),
        ("HEADER\n0,1,2,3,4\n", "line 2: 5 cells, and the header has 16"),
        ("HEADER\n0,1,2,3,4,x,0,0,0,0,0,0,0,0,0,0\n", "line 2, column q_joint_5: 'x' is no number"),
        ("HEADER\nx,1,2,3,4,5,0,0,0,0,0,0,0,0,0,0\n", "line 2, column time: 'x' is no number"),
        ("HEADER\n0,1,2,3,4,5,0,0,0,0,0,0,0,0,0,1_0\n", "'1_0' is no number"),
        ("\x00\xff\xfe", "is no UTF-8 text"),
    ],
)
def test_text_that_is_no_table_is_refused_with_its_line(arm: Robot, tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "x.csv"
    path.write_bytes(text.replace("HEADER", ",".join(table(arm))).encode("latin-1"))
    with pytest.raises(RttrrError) as error:
        list(read_trajectory(path, arm).blocks())
    assert message in str(error.value)


@pytest.mark.parametrize("kind", [".csv", ".jsonl", ".npz", ".parquet", ".txt"])
def test_junk_is_an_error_of_ours(arm: Robot, tmp_path: Path, kind: str) -> None:
    path = tmp_path / f"x{kind}"
    for data in (b"", b"PK\x03\x04", np.random.default_rng(0).bytes(3000), b'{"time": 1}\n'):
        path.write_bytes(data)
        with pytest.raises(RttrrError):
            list(read_trajectory(path, arm).blocks())
    with pytest.raises(RttrrError):
        read_trajectory(tmp_path, arm)
    with pytest.raises(RttrrError):
        read_trajectory(tmp_path / f"none{kind}", arm)
