"""Which column of a file is which coordinate: by the names of docs/notation.md, or by others that say it as plainly."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, UnknownNameError, listed, shortened
from rttrr_pin.implementations.text_results import PAYLOAD, TIMES, payload_columns
from rttrr_pin.trajectories.clock import UNITS

WORDS: Mapping[str, tuple[str, ...]] = {
    "q": ("position", "pos"),
    "v": ("velocity", "vel"),
    "a": ("acceleration", "acc"),
}
"""What stands before or behind the name of a joint, with a point, a slash or a low line between."""

TIME = (*TIMES, "timestamp", "stamp", "__time")
"""Names of the column of time; with `_ms` or ` [ms]` behind, and the like, its unit is said too."""

DOCUMENTED = "{key}_{label}"


@dataclass(frozen=True, slots=True)
class Columns:
    """The columns of a file that are read.

    Attributes:
        time: the column of time.
        unit: of time, where its name says it [s].
        labels: by q, v, a and payload their columns, in the robot's order.
        loads: link, and whether in base axes, of each six columns of payload.
        notes: what was read otherwise than docs/notation.md has it, and what was not read.
    """

    time: str
    unit: float | None
    labels: Mapping[str, tuple[str, ...]]
    loads: tuple[tuple[int, bool], ...]
    notes: tuple[str, ...]

    @property
    def wanted(self) -> tuple[str, ...]:
        """All of them, time first."""
        return (self.time, *(name for names in self.labels.values() for name in names))


def columns_of_file(names: Sequence[str], model: Model, file: str, more: Sequence[str] = ()) -> Columns:
    """What the columns of a file are.

    Args:
        names: of the columns.
        model: of the robot.
        file: its name, for messages.
        more: other quantities of degrees of freedom that are read, such as tau; they must be there.

    Raises:
        InputError: time or coordinates are not there, some joints lack a column, or two columns are one coordinate.
        UnknownNameError: a column is of a joint that the robot has not.
    """
    there, joints = set(names), {joint.name for joint in model.joints}
    time, unit = time_column(names, file)
    notes: list[str] = []
    labels: dict[str, tuple[str, ...]] = {}
    for key in ("q", "v", "a", *more):
        own = model.q_names if key == "q" else model.v_names
        style = _style(key, own, there, joints, file)
        if style is None:
            continue
        labels[key] = _spelled(style, key, own)
        if style != DOCUMENTED and own:
            notes.append(f"{key} is read from {listed(labels[key], 3)}")
    loads = payloads_of_file(names, model, file, labels)
    read = {time, *(name for own in labels.values() for name in own)}
    if rest := [shortened(name) for name in names if name not in read]:
        notes.append(f"{'column' if len(rest) == 1 else 'columns'} not read: {listed(rest)}")
    return Columns(time, unit, labels, loads, tuple(notes))


def payloads_of_file(
    names: Sequence[str], model: Model, file: str, labels: dict[str, tuple[str, ...]]
) -> tuple[tuple[int, bool], ...]:
    """The link of each payload, and whether it is in base axes; their columns are added to `labels`.

    Raises:
        InputError: some of the six columns of one are missing.
    """
    loads: list[tuple[int, bool]] = []
    there = set(names)
    for (link, in_base), columns in payload_columns(model).items():
        if there & set(columns):
            _complete(columns, there, file)
            labels[PAYLOAD] = (*labels.get(PAYLOAD, ()), *columns)
            loads.append((model.link_index(link), in_base))
    return tuple(loads)


def time_column(names: Sequence[str], file: str) -> tuple[str, float | None]:
    """The column of time, and its unit where its name says it.

    Raises:
        InputError: there is none, or there are several.
    """
    pattern = re.compile(rf"({'|'.join(TIME)})(?:_(s|ms|us|ns)| ?\[(s|ms|us|ns)\])?")
    found = [(name, match[2] or match[3]) for name in names if (match := pattern.fullmatch(name))]
    if len(found) > 1:
        raise InputError(f"{file} has several columns of time, {listed(name for name, _ in found)}: leave one of them")
    if not found:
        columns = f"; it has {listed(map(shortened, names), 8)}" if names else ""
        raise InputError(f"{file} has no column time or t: each row needs its time{columns}")
    name, unit = found[0]
    return name, UNITS[unit] if unit else None


def _style(key: str, labels: Sequence[str], there: set[str], joints: set[str], file: str) -> str | None:
    """How the columns of q, v, a or tau are spelled; None where v or a are not there."""
    if not labels:
        return DOCUMENTED
    styles = dict.fromkeys([DOCUMENTED, *_plain(key), *_of_topics(key, labels[0], there)])
    counts = {style: sum(name in there for name in _spelled(style, key, labels)) for style in styles}
    whole = [style for style, count in counts.items() if count == len(labels)]
    if DOCUMENTED in whole:
        _check_unknown(key, labels, there, joints, file)
        return DOCUMENTED
    if len(whole) > 1:
        several = listed(_spelled(style, key, labels)[0] for style in whole)
        raise InputError(f"{file} has several columns for one {key}, {several}: leave one of them")
    if whole:
        return whole[0]
    most = max(counts, key=counts.__getitem__)
    if most == DOCUMENTED:
        _check_unknown(key, labels, there, joints, file)
    if counts[most] or key not in ("v", "a"):
        _complete(_spelled(most, key, labels), there, file)
    return None


def _plain(key: str) -> list[str]:
    """Other spellings that say as plainly what a column is."""
    words = [f"{word}{mark}{{label}}" for word in WORDS.get(key, ()) for mark in "./_"]
    words += [f"{{label}}{mark}{word}" for word in WORDS.get(key, ()) for mark in "./_"]
    return [*(["{label}"] if key == "q" else []), *words]


def _of_topics(key: str, label: str, there: set[str]) -> list[str]:
    """PlotJuggler writes /topic/joint/position."""
    ends = [f"/{label}/{word}" for word in WORDS.get(key, ())]
    found = [(name.removesuffix(end), end) for name in sorted(there) for end in ends if name.endswith(end)]
    return [f"{_escaped(topic)}/{{label}}/{end.rpartition('/')[2]}" for topic, end in found if topic.startswith("/")]


def _escaped(text: str) -> str:
    return text.replace("{", "{{").replace("}", "}}")


def _spelled(style: str, key: str, labels: Sequence[str]) -> tuple[str, ...]:
    return tuple(style.format(key=key, label=label) for label in labels)


def _complete(columns: Sequence[str], there: set[str], file: str) -> None:
    missing = [column for column in columns if column not in there]
    if missing:
        raise InputError(f"{file} lacks the columns {listed(map(shortened, missing), 8)}: see docs/notation.md")


def _check_unknown(key: str, labels: Sequence[str], there: set[str], joints: set[str], file: str) -> None:
    """Columns that are spelled as documented are of a joint of the robot, if one that follows another, or is fixed."""
    known = _spelled(DOCUMENTED, key, labels)
    for name in sorted(there):
        if name.startswith(f"{key}_") and name not in known and name[len(key) + 1 :] not in joints:
            raise UnknownNameError("column", shortened(name), known, f"in {file}")
