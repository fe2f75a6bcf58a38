"""Vectors: what is written is read back, the same each time, and what was altered is refused."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import InputError, Robot
from rttrr_pin.conformance import ProvenCase, Vectors, cases, level_robot, level_robots, read_vectors, write_vectors
from rttrr_pin.conformance.vectors.mjcf_file import as_mjcf
from rttrr_pin.conformance.vectors.vector_meta import sha256
from rttrr_pin.conformance.vectors.vectors import BUNDLED
from rttrr_pin.errors import UnknownNameError
from rttrr_pin.exact import Enclosures, enclose
from support.trees import random_tree

RESULTS = Path(__file__).parents[3] / "benchmarks" / "results"

OTHER_SCHEMA = '{"format": "rttrr-pin vectors", "schema": 2}'

LEVELS = ("payload", "mimic", "floating", "effects", "cancelling")


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Vectors:
    return write_vectors(tmp_path_factory.mktemp("vectors") / "set", levels=LEVELS, n_states=3)


@pytest.fixture
def copy(written: Vectors, tmp_path: Path) -> Path:
    return Path(shutil.copytree(written.folder, tmp_path / "copy"))


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def same(one: Enclosures, other: Enclosures) -> bool:
    pairs = zip(one.items(), other.items(), strict=True)
    return all(np.array_equal(x.lower, y.lower) and np.array_equal(x.upper, y.upper) for (_, x), (_, y) in pairs)


def altered(folder: Path, file: str, change: Callable[[str], str]) -> None:
    """A file with another content, whose sums are made anew as by someone who knows them."""
    path = folder / file
    path.write_text(change(path.read_text()))
    robot = path.parent
    meta = json.loads((robot / "meta.json").read_text())
    meta["sha256"][path.name] = sha256(path.read_bytes())
    (robot / "meta.json").write_text(json.dumps(meta))
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["robots"][robot.name] = sha256((robot / "meta.json").read_bytes())
    (folder / "manifest.json").write_text(json.dumps(manifest))


def test_what_is_written_is_read_back(written: Vectors) -> None:
    read = {case.id: case for case in read_vectors(written.folder)}
    drawn = {case.id: case for case in cases(levels=LEVELS, n_states=3)}
    assert read.keys() == drawn.keys()
    for name, case in read.items():
        batch, other = case.batch, drawn[name].batch
        assert all(np.array_equal(getattr(batch, key), getattr(other, key)) for key in "qva")
        assert [(x.link, x.in_base) for x in batch.loads] == [(x.link, x.in_base) for x in other.loads]
        for x, y in zip(batch.loads, other.loads, strict=True):
            assert np.array_equal(x.f, y.f)
            assert np.array_equal(x.n, y.n)
        assert same(case.enclosures, enclose(drawn[name].robot.model, batch.q, batch.v, batch.a, batch.loads, "read"))
        assert case.robot.link_names == drawn[name].robot.link_names


def test_the_same_seed_gives_the_same_bytes(written: Vectors, tmp_path: Path) -> None:
    write_vectors(tmp_path / "again", levels=LEVELS, n_states=3)
    assert contents(tmp_path / "again") == contents(written.folder)
    other = write_vectors(tmp_path / "other", levels=["mimic"], n_states=3, seed=1)
    assert other.meta["mimic"]["sha256"]["states.csv"] != written.meta["mimic"]["sha256"]["states.csv"]


def test_more_states_begin_with_the_same(written: Vectors, tmp_path: Path) -> None:
    write_vectors(tmp_path, levels=["mimic"], n_states=5)
    for table in ("states.csv", "truth.csv"):
        fewer, more = ((folder / "mimic" / table).read_text() for folder in (written.folder, tmp_path))
        assert more.startswith(fewer)


def test_enclosures_are_two_neighbours_at_most(written: Vectors) -> None:
    assert written.passed
    assert written.widths["three"] == written.widths["more, near zero"] == 0
    assert sum(written.widths.values()) == sum(
        x.lower.size for case in read_vectors(written.folder) for _, x in case.enclosures.items()
    )


def test_true_values_have_base_gravity_and_effects_of_the_robot(tmp_path: Path) -> None:
    robot = rttrr_pin.load("trr", base="floating", gravity=(1.0, 0.5, -1.62))
    robot = robot.with_joint_effects({"joint_1": rttrr_pin.JointEffects(0.25, 0.5, 0.125)})
    write_vectors(tmp_path, [robot], levels=["accelerations"], n_states=2)
    [case] = read_vectors(tmp_path)
    batch = case.batch
    assert same(case.enclosures, enclose(robot.model, batch.q, batch.v, batch.a, batch.loads, "read"))
    without = rttrr_pin.load("trr").model
    assert case.robot.model.nv == without.nv + 6


def test_any_tree_is_written_and_read(tmp_path: Path) -> None:
    robots = [rttrr_pin.load(random_tree(seed, 5)) for seed in range(3)]
    for seed, robot in enumerate(robots):
        folder = tmp_path / str(seed)
        write_vectors(folder, [robot], n_states=1)
        assert [case.level.id for case in read_vectors(folder)]


@pytest.mark.parametrize(
    "file", ["arm6/robot.urdf", "arm6/robot.xml", "arm6/states.csv", "arm6/truth.csv", "arm6/meta.json"]
)
def test_an_altered_file_is_refused(copy: Path, file: str) -> None:
    (copy / file).write_text((copy / file).read_text().replace("1", "2", 1))
    with pytest.raises(InputError, match="was altered"):
        read_vectors(copy)


def words_of(line: int, column: int, word: str) -> Callable[[str], str]:
    def change(text: str) -> str:
        rows = [row.split(",") for row in text.splitlines()]
        rows[line][column] = word
        return "\n".join(map(",".join, rows)) + "\n"

    return change


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (words_of(1, 5, "0.5"), "expected one finite number"),
        (words_of(1, 5, "x"), "could not convert"),
        (words_of(0, 5, "lower_tau_other"), "column 6"),
        (words_of(1, 1, "7"), "other rows"),
        (lambda text: text.rsplit("\n", 2)[0] + "\n", "other rows"),
        (lambda text: text[:-5] + "\n", "expected one finite number"),
    ],
    ids=["decimal", "word", "header", "state", "short", "cut"],
)
def test_a_table_that_is_not_of_the_format_is_refused(copy: Path, change: Callable[[str], str], sentence: str) -> None:
    altered(copy, "mimic/truth.csv", change)
    with pytest.raises(InputError, match=sentence):
        read_vectors(copy)


def test_a_lower_end_above_the_upper_is_refused(copy: Path) -> None:
    def exchanged(text: str) -> str:
        rows = [row.split(",") for row in text.splitlines()]
        n = (len(rows[0]) - 2) // 4
        for row in rows[1:]:
            own = row[2:]
            row[2:] = [*own[n : 2 * n], *own[:n], *own[3 * n :], *own[2 * n : 3 * n]]
        return "\n".join(map(",".join, rows)) + "\n"

    altered(copy, "mimic/truth.csv", exchanged)
    with pytest.raises(InputError, match=r"between -?\d[^ (]* and -?\d[^ (]*: expected lower <= upper"):
        read_vectors(copy)


def test_a_folder_of_one_robot_is_read(written: Vectors) -> None:
    assert {case.name for case in read_vectors(written.folder / "mimic")} == {"mimic"}
    assert {case.level.id for case in read_vectors(written.folder, levels=["effects"])} == {"effects"}


def test_what_cannot_be_written_or_read_is_said(written: Vectors, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="force=True"):
        write_vectors(written.folder)
    with pytest.raises(UnknownNameError):
        write_vectors(tmp_path, levels=["gravty"])
    with pytest.raises(InputError, match="no URDF"):
        write_vectors(tmp_path, [Robot(rttrr_pin.Model("m", rttrr_pin.Link("base"), *chain()))])
    twice = [rttrr_pin.load("trr"), rttrr_pin.load("trr")]
    with pytest.raises(InputError, match="two robots are called"):
        write_vectors(tmp_path, twice)
    with pytest.raises(InputError, match="cannot be read"):
        read_vectors(tmp_path)
    for text, sentence in (("{}", "rttrr-pin vectors"), ("{", "no JSON"), (OTHER_SCHEMA, "schema 2, expected 1")):
        (tmp_path / "manifest.json").write_text(text)
        with pytest.raises(InputError, match=sentence):
            read_vectors(tmp_path)


@pytest.mark.parametrize("key", ["joints", "levels", "order", "sha256", "gravity"])
def test_a_meta_file_that_lacks_something_is_refused(written: Vectors, tmp_path: Path, key: str) -> None:
    folder = Path(shutil.copytree(written.folder / "mimic", tmp_path / "mimic"))
    meta = json.loads((folder / "meta.json").read_text())
    del meta[key]
    (folder / "meta.json").write_text(json.dumps(meta))
    with pytest.raises(InputError, match=f"lacks '{key}'"):
        read_vectors(folder)


def chain() -> tuple[tuple[rttrr_pin.Link, ...], tuple[rttrr_pin.Joint, ...]]:
    from rttrr_pin.core.joints import REVOLUTE

    return (rttrr_pin.Link("link", 1.0),), (rttrr_pin.Joint("joint", REVOLUTE),)


def test_without_words_for_a_robot_there_is_no_mjcf(written: Vectors, copy: Path) -> None:
    assert not (written.folder / "mimic/robot.xml").exists()
    assert written.meta["mimic"]["mjcf"]["file"] is None
    assert "follows" in written.meta["mimic"]["mjcf"]["reason"]
    (copy / "mimic/robot.xml").write_text("of another robot")
    write_vectors(copy, levels=LEVELS, n_states=3, force=True)
    assert contents(copy) == contents(written.folder)


# The part of the bundled set that comes with the package: written by
# rttrr-pin vectors -n 1 -o src/rttrr_pin/conformance/vectors/data, with --levels for each of those below.


@pytest.fixture(scope="module")
def bundled() -> list[ProvenCase]:
    return read_vectors()


def test_the_bundled_part_is_small_and_has_most_levels(bundled: list[ProvenCase]) -> None:
    assert sum(map(len, contents(BUNDLED).values())) < 300_000
    assert len({case.level.id for case in bundled}) == 11


def test_the_bundled_part_is_of_the_robots_of_the_levels(bundled: list[ProvenCase]) -> None:
    for case in bundled:
        assert (BUNDLED / case.name / "robot.urdf").read_text() == level_robot(case.name).model.urdf


def test_the_bundled_part_is_proven_anew(bundled: list[ProvenCase]) -> None:
    for case in bundled:
        batch = case.batch
        assert same(case.enclosures, enclose(case.robot.model, batch.q, batch.v, batch.a, batch.loads, "read"))


def saved(name: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((RESULTS / f"{name}.json").read_text())
    return data


def test_the_saved_sums_are_of_the_robots_of_the_levels() -> None:
    """States may differ in a last bit on another machine, files of robots may not."""
    robots = saved("vectors")["robots"]
    assert robots.keys() == level_robots().keys()
    for name, own in robots.items():
        model = level_robot(name).model
        assert own["sha256"]["robot.urdf"] == sha256(model.urdf)
        assert own["sha256"].get("robot.xml") == (sha256(mjcf) if (mjcf := as_mjcf(model).text) else None)


def test_the_saved_check_found_nothing_outside() -> None:
    result = saved("vectors_check")
    assert result["outside"] == 0
    assert result["digits"] == 60
    assert result["robots"].keys() == level_robots().keys()
    for own in result["robots"].values():
        assert own["states"] >= 1000
        assert own["widths"]["more, near zero"] == own["widths"]["three"] == 0


def meta_with(change: Callable[[dict[str, Any]], Any]) -> Callable[[str], str]:
    def changed(text: str) -> str:
        meta = json.loads(text)
        change(meta)
        return json.dumps(meta)

    return changed


def resealed(folder: Path, file: str, change: Callable[[str], str]) -> None:
    """Like `altered`, of meta.json itself."""
    path = folder / file
    path.write_text(change(path.read_text()))
    manifest = json.loads((folder / "manifest.json").read_text())
    manifest["robots"][path.parent.name] = sha256(path.read_bytes())
    (folder / "manifest.json").write_text(json.dumps(manifest))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda meta: meta["sha256"].pop("truth.csv"), r"has no SHA-256 of truth\.csv"),
        (lambda meta: meta.update(sha256=[]), "meta.json is of another form"),
        (lambda meta: meta["levels"][1].update(first_row=0), "begins at row 0, expected 3"),
        (lambda meta: meta.update(levels=None), "meta.json is of another form"),
        (lambda meta: meta.pop("links"), "meta.json lacks 'links'"),
        (lambda meta: meta.update(base=5), r"arm6.robot\.urdf: .*is 5"),
    ],
    ids=["no sum", "sums", "row", "levels", "links", "base"],
)
def test_a_description_that_says_too_little_is_refused(
    copy: Path, change: Callable[[dict[str, Any]], Any], sentence: str
) -> None:
    """A file without a sum would not be checked, and rows that are passed over not be seen."""
    resealed(copy, "arm6/meta.json", meta_with(change))
    with pytest.raises(InputError, match=sentence):
        read_vectors(copy)


def test_a_table_that_is_no_text_is_refused(copy: Path) -> None:
    (copy / "arm6" / "truth.csv").write_bytes(b"\xff\xfe\x00")
    resealed(
        copy, "arm6/meta.json", meta_with(lambda meta: meta["sha256"].update({"truth.csv": sha256(b"\xff\xfe\x00")}))
    )
    with pytest.raises(InputError, match=r"truth\.csv is no table of UTF-8 text"):
        read_vectors(copy)


def test_a_name_in_place_of_a_urdf_loads_no_other_robot(copy: Path) -> None:
    altered(copy, "arm6/robot.urdf", lambda text: "rttrr")
    with pytest.raises(InputError, match=r"robot\.urdf: is no URDF"):
        read_vectors(copy)
