"""Vectors: states of robots and proven true values of them, as files that any language reads (docs/vectors.md)."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from rttrr_pin.conformance.levels import LEVELS, Case, Level, ProvenCase, cases
from rttrr_pin.conformance.vectors.mjcf_file import as_mjcf
from rttrr_pin.conformance.vectors.vector_meta import (
    FORMAT,
    LICENCE,
    MANIFEST,
    META,
    MJCF,
    SCHEMA,
    STATES,
    TRUTH,
    URDF,
    described,
    meta_of,
    read_file,
    read_files,
    read_json,
    read_robot,
    robot_of,
    sha256,
)
from rttrr_pin.conformance.vectors.vector_tables import (
    LOWER,
    UPPER,
    WIDTHS,
    enclosures_of,
    loads_of,
    read_table,
    state_columns,
    states_table,
    truth_columns,
    truth_table,
)
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.exact.enclosures import enclose
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.reporting.files import as_json, write_whole
from rttrr_pin.reporting.results import Summarised, counted
from rttrr_pin.robot import Robot
from rttrr_pin.version import __version__

BUNDLED = Path(__file__).with_name("data")
"""A small part of the bundled set, which comes with the package."""

UNSAFE = re.compile(r"[^A-Za-z0-9_.-]|^\.")
"""What no folder is called."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Vectors(Summarised):
    """What was written.

    Attributes:
        folder: where.
        meta: by robot, what its meta.json says.
        bytes: of all files.
    """

    folder: Path
    meta: dict[str, dict[str, Any]]
    bytes: int

    @property
    def passed(self) -> bool:
        """Whether every enclosure is as narrow as it can be."""
        return all(level["tight"] for own in self.meta.values() for level in own["levels"])

    @property
    def states(self) -> int:
        """Of all robots and levels."""
        return sum(level["states"] for own in self.meta.values() for level in own["levels"])

    @property
    def widths(self) -> dict[str, int]:
        """How many enclosures are how wide."""
        levels = [level["widths"] for own in self.meta.values() for level in own["levels"]]
        return {name: sum(own[name] for own in levels) for name in WIDTHS}

    def summary(self) -> str:
        """One line for the whole, and one for each robot."""
        total = sum(self.widths.values())
        size = f"{self.bytes / 1e6:.1f} MB" if self.bytes >= 1e6 else f"{self.bytes / 1e3:.0f} kB"
        what = f"{counted(len(self.meta), 'robot')}, {counted(self.states, 'state')}, {total:,} proven numbers, {size}"
        lines = [f"{self.folder}: {what}"]
        for name, own in self.meta.items():
            levels = ", ".join(level["id"] for level in own["levels"])
            states = counted(sum(level["states"] for level in own["levels"]), "state")
            reason = "" if own["mjcf"]["file"] else f"; no MJCF: {own['mjcf']['reason']}"
            lines.append(f"  {name}: {states} of {levels}{reason}")
        return "\n".join(lines)

    def to_dict(self) -> dict[str, Any]:
        """The robots with their levels and the SHA-256 of each file, for JSON."""
        return {
            "schema": SCHEMA,
            "passed": self.passed,
            "bytes": self.bytes,
            "states": self.states,
            "widths": self.widths,
            "robots": {
                name: {"levels": own["levels"], "mjcf": own["mjcf"], "sha256": own["sha256"]}
                for name, own in self.meta.items()
            },
        }


def write_vectors(
    folder: str | Path,
    robots: Sequence[Robot] | None = None,
    levels: Sequence[str] | None = None,
    n_states: int = 32,
    seed: int = 0,
    force: bool = False,
    progress: Callable[[int], None] = lambda done: None,
) -> Vectors:
    """Write states and proven true values: one folder for each robot, and manifest.json beside them.

    True values are those of the robot that robot.urdf is, with the base, gravity and joint effects of meta.json: its
    numbers are the doubles nearest to the file's decimals, and all that follows from them is enclosed in intervals. The
    same robots, levels and seed give the same bytes.

    Args:
        folder: where the folders go; it is made where there is none.
        robots: own robots, each asked with the levels that apply to it; None for the robots of the levels.
        levels: ids of those that are wanted; None for all.
        n_states: of each level and robot.
        seed: of the states.
        force: whether files that are there are overwritten.
        progress: is called with the number of cases that are done.

    Raises:
        UnknownNameError: there is no such level.
        InputError: an argument cannot be used, a robot has no URDF or is not what its URDF is, two robots have one
            name, or the folder has files or cannot be written.
    """
    target = Path(folder)
    asked = _by_robot(cases(robots, levels, n_states, seed), robots)
    if target.exists() and (not target.is_dir() or any(target.iterdir())) and not force:
        raise InputError(
            f"{target} exists and is left as it was: choose another folder, or pass force=True to overwrite files",
            options={"pass force=True": "add --force"},
        )
    metas: dict[str, dict[str, Any]] = {}
    size = done = 0
    for name, own in asked.items():
        folder_name = UNSAFE.sub("_", name)
        if folder_name in metas:
            raise InputError(f"two robots would be written to {target / folder_name}: name the robots differently")
        urdf, description = described(own[0].robot, name)
        robot = robot_of(urdf, description)
        proven = []
        for case in own:
            proven.append(_proven(case, robot))
            done += 1
            progress(done)
        payload = list(dict.fromkeys(robot.link_names[x.link] for case in proven for x in case.batch.loads))
        mjcf = as_mjcf(robot.model)
        files = {URDF: urdf, MJCF: mjcf.text, STATES: states_table(proven, payload), TRUTH: truth_table(proven)}
        files = {key: text for key, text in files.items() if text}
        meta = meta_of(name, proven, payload, mjcf, seed, own=robots is not None)
        meta["sha256"] = {key: sha256(text) for key, text in files.items()}
        size += _write(target / folder_name, files | {META: as_json(meta)})
        metas[folder_name] = meta
    manifest = {
        "format": FORMAT,
        "schema": SCHEMA,
        "made_by": f"rttrr-pin {__version__}",
        "licence": LICENCE if robots is None else "that of the robots",
        "robots": {name: sha256(as_json(meta)) for name, meta in metas.items()},
    }
    size += _write(target, {MANIFEST: as_json(manifest)})
    return Vectors(target, metas, size)


def _by_robot(asked: Sequence[Case], robots: Sequence[Robot] | None) -> dict[str, list[Case]]:
    """The cases of each robot, in the order of the levels.

    Raises:
        InputError: two robots have the same name, or no level applies to one.
    """
    out: dict[str, list[Case]] = {}
    for case in asked:
        out.setdefault(case.name, []).append(case)
    for name, own in out.items():
        if any(case.robot is not own[0].robot for case in own):
            raise InputError(f"two robots are called {name!r}: give each a name of its own")
    for robot in robots or ():
        if robot.name not in out:
            raise InputError(f"no level applies to {robot.name!r}: leave it out, or ask for other levels")
    return out


def _proven(case: Case, robot: Robot) -> ProvenCase:
    """A case of the robot that its URDF is, with its true values."""
    batch = replace(case.batch, model=robot.model)
    enclosures = enclose(robot.model, batch.q, batch.v, batch.a, batch.loads, "read")
    return ProvenCase(case.level, case.name, robot, batch, enclosures)


def _write(folder: Path, files: dict[str, str]) -> int:
    """Each file whole or not at all; how many bytes they have."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if MANIFEST not in files and MJCF not in files:
            (folder / MJCF).unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be written: {error.strerror}; choose another folder") from error
    for name, text in files.items():
        write_whole(folder / name, text)
    return sum(len(text.encode()) for text in files.values())


def read_vectors(folder: str | Path | None = None, levels: Sequence[str] | None = None) -> list[ProvenCase]:
    """Read what `write_vectors` wrote, and check it: every SHA-256, every number, every lower <= upper.

    Args:
        folder: of all robots, or of one; None for the small part of the bundled set that comes with the package.
        levels: ids of those that are wanted; None for all.

    Returns:
        The cases with their true values, robot by robot in the order of the levels.

    Raises:
        InputError: there are no vectors, or they are not what was written.
        UnknownNameError: a level is not known.
    """
    place = BUNDLED if folder is None else Path(folder)
    if (place / MANIFEST).is_file():
        sums = read_json(place / MANIFEST)["robots"]
        found = [_read_robot(place / name, own) for name, own in sums.items()]
    else:
        found = [_read_robot(place)]
    for own in levels or ():
        _level(own)
    return [case for part in found for case in part if levels is None or case.level.id in levels]


def _read_robot(folder: Path, sum: str | None = None) -> list[ProvenCase]:
    """The cases of one robot."""
    read_file(folder / META, sum)
    try:
        return _cases_of(folder, read_json(folder / META))
    except (KeyError, TypeError, AttributeError) as error:
        why = f"lacks {error}" if isinstance(error, KeyError) else f"is of another form than it must ({error})"
        raise InputError(f"{folder / META} {why}: fetch or write it again") from None


def _cases_of(folder: Path, meta: dict[str, Any]) -> list[ProvenCase]:
    content = read_files(folder, meta)
    robot = read_robot(folder / URDF, content[URDF], meta)
    model = robot.model
    payload = [own["link"] for own in meta["payload"]]
    names = truth_columns(model)
    rows, states = read_table(folder / STATES, state_columns(model, payload))
    of_truth, ends = read_table(folder / TRUTH, [start + name for start in (LOWER, UPPER) for name in names])
    wanted = [(level["id"], k) for level in meta["levels"] for k in range(level["states"])]
    for path, got in ((STATES, rows), (TRUTH, of_truth)):
        if got != wanted:
            raise InputError(f"{folder / path} has other rows than {META} says: write it anew")
    lower, upper = np.hsplit(ends, 2)
    if (lower > upper).any():
        row, column = np.argwhere(lower > upper)[0]
        raise InputError(
            f"{folder / TRUTH}: {names[column]} of state {rows[row][1]} of level {rows[row][0]} lies between "
            f"{lower[row, column]} and {upper[row, column]}: expected lower <= upper; write it anew"
        )
    found = []
    for level in meta["levels"]:
        part = slice(level["first_row"], level["first_row"] + level["states"])
        q, v, a, loads = np.split(states[part], np.cumsum([model.nq, model.nv, model.nv]), axis=1)
        batch = Batch(model, q, v, a, loads_of(model, payload, loads))
        enclosures = enclosures_of(model, lower[part], upper[part], level["bits"], level["tight"])
        found.append(ProvenCase(_level(level["id"]), meta["robot"], robot, batch, enclosures))
    return found


def _level(id: str) -> Level:
    """The level of that id.

    Raises:
        UnknownNameError: there is none.
    """
    known = {level.id: level for level in LEVELS}
    if id not in known:
        raise UnknownNameError("level", id, known)
    return known[id]
