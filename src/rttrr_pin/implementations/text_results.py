"""Results as text: numbers with the digits they were printed at, in lists or by name."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import LINK_QUANTITIES, QUANTITIES
from rttrr_pin.errors import ImplementationError, UnknownNameError, shortened

NOT_FINITE = re.compile(r"(-?)\b(nan|inf|infinity)\b", re.IGNORECASE)

FULL = 16
"""Significant digits from which a printed number stands for one float64."""

NUMBERS_AS_TEXT = json.JSONDecoder(parse_float=str, parse_int=str, parse_constant=str)

FARTHEST = 400
"""Exponents beyond which every decimal is 0 or infinite in float64."""

DEEPEST = 8
"""Lists in each other; a number for each coordinate of each joint has two."""

PAYLOAD = "payload"
"""How the columns of a payload begin, and its key in a request."""

BASE_AXES = " in base axes"
"""What stands behind the name of a payload's column where a request has it in base axes; no file need write it."""

TIMES = ("time", "t")
"""Columns of the time of a log."""

Columns: TypeAlias = Mapping[str, Sequence[str]]
"""By joint or link the names of its numbers in one array."""


@dataclass(frozen=True, slots=True)
class Digits:
    """How the numbers of one quantity were printed.

    Attributes:
        significant: the most significant digits of any of them.
        decimals: the most decimals of any of them.
    """

    significant: int = 0
    decimals: int = 0

    @classmethod
    def of(cls, texts: Iterable[str]) -> Digits:
        """The digits of decimal numbers; of what is not finite none."""
        most_significant = most_decimals = 0
        for text in set(texts):
            mantissa, _, exponent = text.lower().strip("+- ").partition("e")
            if "n" in mantissa:  # NaN, infinity
                continue
            whole, _, fraction = mantissa.partition(".")
            shift = float(exponent or 0)  # an exponent may have thousands of digits itself
            decimals = len(fraction) - int(min(max(shift, -FARTHEST), FARTHEST))
            most_significant = max(most_significant, len((whole + fraction).lstrip("0")))
            most_decimals = max(most_decimals, decimals)
        return cls(most_significant, most_decimals)

    def with_all(self, other: Digits) -> Digits:
        """The most of both."""
        return Digits(max(self.significant, other.significant), max(self.decimals, other.decimals))

    @property
    def full(self) -> bool:
        """Whether nothing of a float64 was cut off."""
        return self.significant >= FULL

    def half_units(self, x: Array) -> Array:
        """Half a unit of the last place that each number was printed to.

        Numbers are printed with a fixed count of decimals (%.6f) or of significant digits (%.6g), and zeros at the end
        may be cut off. Of the first kind it is the largest number that has the most digits, of the second the smallest
        that has the most decimals; so the larger of the two half units is right for both.
        """
        if not self.significant:
            return np.zeros_like(x)
        with np.errstate(divide="ignore", over="ignore"):
            leading = np.floor(np.log10(np.abs(np.where(np.isfinite(x), x, 0.0))))
            of_significant = 10.0 ** (leading - self.significant + 1)
        halves: Array = 0.5 * np.maximum(of_significant, 10.0 ** float(-self.decimals))
        return halves


def judged_at(name: str, digits: Iterable[Digits], how: str) -> tuple[int | None, tuple[str, ...]]:
    """The significant digits that results are judged at, also as a note; None and none where nothing was cut off."""
    fewest = min((own.significant for own in digits if not own.full), default=None)
    return fewest, () if fewest is None else (f"{name} is judged at {fewest} digits, as {how}",)


def columns_of(model: Model) -> dict[str, Columns]:
    """By name of a state's or a result's array, the columns of a table: `q_joint_1`, ..., `n_tool_z`."""
    q, v = ({joint.name: labels(joint) for joint in model.moving} for labels in (Joint.q_labels, Joint.v_labels))
    links = {link: [f"{link}_{axis}" for axis in "xyz"] for link in model.link_names}
    arrays = {"q": q, "v": v, "a": v, "tau": v} | dict.fromkeys(LINK_QUANTITIES, links)
    return {
        key: {name: [f"{key}_{label}" for label in labels] for name, labels in columns.items()}
        for key, columns in arrays.items()
    }


def column_names(model: Model) -> dict[str, list[str]]:
    """The same in order, without joints and links."""
    return {key: [name for names in columns.values() for name in names] for key, columns in columns_of(model).items()}


def payload_columns(model: Model) -> dict[tuple[str, bool], list[str]]:
    """By link, and whether in base axes, the columns of a payload: `payload_f_tool_x`, ..., `payload_n_tool_z`."""
    return {
        (link, in_base): [f"{PAYLOAD}_{key}_{link}_{axis}{BASE_AXES * in_base}" for key in "fn" for axis in "xyz"]
        for link in model.link_names
        for in_base in (False, True)
    }


def number(text: str) -> float:
    """A decimal number, NaN or infinity.

    Raises:
        ValueError: it is none; what only Python reads, `1_000` and digits of other scripts, is none either.
    """
    if "_" in text or not text.isascii():
        raise ValueError(text)
    return float(text)


def json_of(line: str) -> Any:
    """A JSON text whose numbers stay text; the nan, -nan and inf of C are numbers too.

    Raises:
        ValueError: it is none.
    """
    try:
        return NUMBERS_AS_TEXT.decode(line)
    except (ValueError, RecursionError) as error:
        words = NOT_FINITE.sub(lambda match: "NaN" if match[2].lower() == "nan" else f"{match[1]}Infinity", line)
        if words != line:
            return json_of(words)
        raise ValueError(f"{shortened(line.strip())!r} is no JSON: {error}") from None


def flattened(value: object, columns: Columns, where: str) -> list[str]:
    """The texts of numbers of a JSON value: a list, nested or not, or an object by joint or link.

    Raises:
        ImplementationError: there are too few or too many, or one is no number.
        UnknownNameError: a joint or link that the robot has not.
    """
    if not isinstance(value, Mapping):
        return _counted(value, sum(map(len, columns.values())), where)
    for name in value:
        if name not in columns:
            raise UnknownNameError("joint or link", name, columns, f"{where} has one entry for each")
    missing = [name for name in columns if name not in value]
    if missing:
        raise ImplementationError(f"{where} lacks {', '.join(missing)}: write one entry for each")
    return [text for name, own in columns.items() for text in _counted(value[name], len(own), f"{where} of {name}")]


def flattened_payload(value: object, model: Model, where: str) -> dict[str, str]:
    """By column the texts of the payload of a request: a list of objects with link, f, n, and axes ("link" or "base").

    Raises:
        ImplementationError: an entry is no such object, has too few or too many numbers, or a link has two.
        UnknownNameError: a link that the robot has not.
    """
    row: dict[str, str] = {}
    columns = payload_columns(model)
    for entry in value if isinstance(value, list) else [] if value is None else [value]:
        if not isinstance(entry, Mapping) or not {"link", "f", "n"} <= entry.keys() <= {"link", "f", "n", "axes"}:
            shown = shortened(repr(entry))
            raise ImplementationError(f"{where} has {shown}: expected an object with link, f, n and, if it likes, axes")
        link, axes = entry["link"], entry.get("axes", "link")
        if link not in model.link_names:
            raise UnknownNameError("link", link, model.link_names, f"in {where}")
        if axes not in ("link", "base"):
            raise ImplementationError(f"{where} has axes {shortened(repr(axes))}: expected 'link' or 'base'")
        names = columns[link, axes == "base"]
        if names[0] in row:
            raise ImplementationError(f"{where} has {link} twice: add both up")
        for key, own in (("f", names[:3]), ("n", names[3:])):
            row |= zip(own, _counted(entry[key], 3, f"{where}, {key} at {link}"), strict=True)
    return row


def quantities_of(reply: object, who: str) -> dict[str, object]:
    """tau, or an object of some of tau, F, N, f, n, as an object.

    Raises:
        ImplementationError: it has none of them, or something else.
    """
    parts = dict(reply) if isinstance(reply, Mapping) else {"tau": reply}
    unknown = [key for key in parts if key not in QUANTITIES]
    if unknown or not parts:
        raise ImplementationError(
            f"{who} returned {shortened(', '.join(map(repr, unknown))) or 'nothing'}: "
            f"expected tau, or an object of some of {', '.join(QUANTITIES)}"
        )
    return parts


def trial_states(model: Model, count: int = 3) -> tuple[Array, Array, Array]:
    """States that differ in every coordinate, to find out what a program of the user's gives."""
    fractions = np.linspace(0.1, 0.3, count)[:, None]
    steps = [step for joint in model.moving for step in range(1, joint.nv + 1)]
    return (
        model.coordinates_at(fractions * steps),
        (fractions - 0.1) * np.ones(model.nv),
        (0.4 - fractions) * np.ones(model.nv),
    )


def _counted(value: object, count: int, where: str) -> list[str]:
    """So many numbers."""
    texts = list(_texts(value, where))
    if len(texts) != count:
        raise ImplementationError(f"{where} has {len(texts)} number{'s' * (len(texts) != 1)}, expected {count}")
    return texts


def _texts(value: object, where: str, depth: int = 1) -> Iterator[str]:
    """Numbers that were read as text; null stands for NaN, as some writers of JSON have it."""
    if isinstance(value, list):
        if depth > DEEPEST:
            raise ImplementationError(f"{where} has lists in each other, more than {DEEPEST} deep: write a flat one")
        for item in value:
            yield from _texts(item, where, depth + 1)
    elif value is None:
        yield "nan"
    else:
        try:
            number(str(value))
        except ValueError:
            shown = shortened(repr(value))
            raise ImplementationError(f"{where} has {shown} where a number is expected") from None
        yield str(value)
