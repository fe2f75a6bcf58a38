"""Files of symbols and equations as tables: TOML or YAML in, checked entries out; errors name the place."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import chain, islice
from pathlib import Path
from typing import Any, TypeVar

from rttrr_pin.errors import EquationError, InputError, shortened
from rttrr_pin.urdf.files import read_limited

Value = TypeVar("Value")

LARGEST_FILE = 2**19
"""Bytes: the longest paper so far has 70,000; YAML takes a second for this."""

MOST_ENTRIES, DEEPEST = 100_000, 20
"""Values in a file, each counted as often as it is referred to, and tables and lists within each other."""


@dataclass(frozen=True, slots=True)
class Table:
    """A table of a file, with its place for messages.

    Attributes:
        source: the file's name.
        place: which table.
        entries: what it holds.
    """

    source: str
    place: str
    entries: Mapping[str, Any]

    def error(self, message: str) -> EquationError:
        """What is wrong with this table, as an exception."""
        return EquationError(message, source=self.source, place=self.place)

    def only(self, known: Iterable[str]) -> Table:
        """The table itself, once all its keys are known.

        Raises:
            EquationError: there is another key.
        """
        names = list(known)
        for key in self.entries:
            if key not in names:
                close = get_close_matches(str(key)[:80], names, n=1)
                hint = f"did you mean {close[0]}?" if close else f"there are {', '.join(names)}"
                raise self.error(f"has the key {shown(key)}, which means nothing here: {hint}")
        return self

    def get(self, key: str, expected: type[Value], default: Value | None = None) -> Value:
        """An entry of a type.

        Raises:
            EquationError: it is missing and has no default, or is of another type.
        """
        if key not in self.entries:
            if default is None:
                raise self.error(f"lacks {key!r}: add it")
            return default
        value = self.entries[key]
        if expected is float and isinstance(value, int) and not isinstance(value, bool):
            value = float(value)
        if not isinstance(value, expected) or (isinstance(value, bool) and expected is not bool):
            raise self.error(f"{key} is {shown(value)}: expected {_WORDS[expected]}")
        return value

    def texts(self, key: str, count: int | None = None, default: Sequence[str] | None = None) -> list[str]:
        """A list of texts; numbers count as texts, and one text as a list of one.

        Raises:
            EquationError: it is missing and has no default, holds something else, or another number of entries.
        """
        if key not in self.entries and default is not None:
            return list(default)
        value = self.entries.get(key)
        entries = value if isinstance(value, list) else [value]
        if any(isinstance(x, bool) or not isinstance(x, str | int | float) for x in entries):
            raise self.error(
                f"{key} is {shown(value)}: expected a list of texts" if key in self.entries else f"lacks {key!r}"
            )
        if count is not None and len(entries) != count:
            raise self.error(f"{key} has {len(entries)} entries, expected {count}: {shown(value)}")
        return [x if isinstance(x, str) else repr(x) for x in entries]

    def table(self, key: str) -> Table:
        """A table within; an empty one where there is none."""
        return Table(self.source, f"[{key}]", self.get(key, dict, {}))

    def tables(self, key: str, place: str = "") -> list[Table]:
        """A list of tables within."""
        tables = []
        for k, entries in enumerate(self.get(key, list, []), start=1):
            if not isinstance(entries, dict):
                raise self.error(f"entry {k} of {key} is {shown(entries)}: expected a table, [[{key}]]")
            number = shortened(str(entries.get("number", k)))
            tables.append(Table(self.source, f"{place or key} {number}", entries))
        return tables


_WORDS: Mapping[type, str] = {
    str: "a text",
    int: "a whole number",
    float: "a number",
    list: "a list",
    dict: "a table",
    bool: "true or false",
}


PART = r"""(?:[\w-]++|"[^"\n]{0,40}"|'[^'\n]{0,40}')"""

LONG_KEY = re.compile(rf"(?<![\w\"'.-]){PART}(?:[ \t]*\.[ \t]*{PART}){{50}}")
"""A dotted key of TOML that no file of equations has."""


def shown(value: object) -> str:
    """A value as a message can show it."""
    return shortened(repr(value))


def read_table(path: Path) -> Table:
    """A file of equations, TOML or YAML by its ending.

    Raises:
        EquationError: there is no such file, or it is neither, or larger or deeper than any file of equations.
    """
    source = path.name
    try:
        text = read_limited(path, LARGEST_FILE).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise EquationError(f"is not UTF-8 text (byte {error.start}): save it as UTF-8", source=source) from error
    except InputError as error:
        raise EquationError(f"cannot be read: {error}", source=source) from error
    except (OSError, ValueError) as error:  # a path with a null byte has no strerror
        reason = getattr(error, "strerror", None) or error
        raise EquationError(f"cannot be read: {reason}", source=shortened(str(path))) from error
    try:
        entries = _yaml(text, source) if path.suffix in (".yaml", ".yml") else _toml(text, source)
    except RecursionError as error:
        raise EquationError("nests tables and lists too deeply: write it flat", source=source) from error
    if not isinstance(entries, dict):
        raise EquationError("holds no table: expected [robot], [[link]], [[symbol]], [[equation]]", source=source)
    _check_size(entries, source)
    return Table(source, "", entries)


def _check_size(entries: dict[Any, Any], source: str) -> None:
    """Level by level, without recursion: a YAML alias may hold its own table, or a billion others.

    Raises:
        EquationError: there are too many entries, too deep ones, or numbers that Python cannot print.
    """
    level: list[Any] = [entries]
    left = MOST_ENTRIES
    for _ in range(DEEPEST):
        level = list(islice(chain.from_iterable(map(_within, level)), left + 1))
        left -= len(level)
        if left < 0:
            raise EquationError(f"has more than {MOST_ENTRIES:,} entries: leave the equations", source=source)
        if any(isinstance(value, int) and value.bit_length() > 64 for value in level):
            raise EquationError("has a whole number of more than 64 bits: no quantity has", source=source)
        if not level:
            return
    raise EquationError(f"has tables and lists in each other, more than {DEEPEST} deep: write it flat", source=source)


def _within(value: Any) -> Iterator[Any]:
    """Keys and values of a table, or entries of a list."""
    if isinstance(value, dict):
        return chain(value.keys(), value.values())
    return iter(value if isinstance(value, list | tuple | set) else ())


def _toml(text: str, source: str) -> Any:
    if LONG_KEY.search(text):  # which takes tomllib time with the square of its length
        raise EquationError("has a key with more than 50 parts: write it flat", source=source)
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise EquationError(f"is no TOML: {error}; LaTeX goes between ''' and '''", source=source) from error
    except ValueError as error:  # a number of more digits than Python converts, a date that there is not
        raise EquationError(f"is no TOML that can be used: {error}", source=source) from error


def _yaml(text: str, source: str) -> Any:
    import yaml

    def no_merge(node: Any) -> None:  # merged tables can double at each step
        if any(key.tag == "tag:yaml.org,2002:merge" for key, _ in node.value):
            raise EquationError("has a merge key (<<): write the entries out", source=source)

    try:
        loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)(text)
        loader.flatten_mapping = no_merge
        try:
            return loader.get_single_data()
        finally:
            loader.dispose()
    except yaml.YAMLError as error:
        raise EquationError(f"is no YAML: {error}", source=source) from error
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # a number of too many digits, a date that there is not, `!!int x`: PyYAML raises what its converters raise
        raise EquationError(f"is no YAML that can be used: {error}", source=source) from error
