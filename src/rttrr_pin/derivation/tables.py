"""Files of symbols and equations as tables: TOML or YAML in, checked entries out; errors name the place."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from rttrr_pin.errors import EquationError

Value = TypeVar("Value")


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
                close = get_close_matches(str(key), names, n=1)
                hint = f"did you mean {close[0]}?" if close else f"there are {', '.join(names)}"
                raise self.error(f"has the key {key!r}, which means nothing here: {hint}")
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
            raise self.error(f"{key} is {value!r}: expected {_WORDS[expected]}")
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
                f"{key} is {value!r}: expected a list of texts" if key in self.entries else f"lacks {key!r}"
            )
        if count is not None and len(entries) != count:
            raise self.error(f"{key} has {len(entries)} entries, expected {count}: {value!r}")
        return [x if isinstance(x, str) else repr(x) for x in entries]

    def table(self, key: str) -> Table:
        """A table within; an empty one where there is none."""
        return Table(self.source, f"[{key}]", self.get(key, dict, {}))

    def tables(self, key: str, place: str = "") -> list[Table]:
        """A list of tables within."""
        tables = []
        for k, entries in enumerate(self.get(key, list, []), start=1):
            if not isinstance(entries, dict):
                raise self.error(f"entry {k} of {key} is {entries!r}: expected a table, [[{key}]]")
            number = entries.get("number", k)
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


def read_table(path: Path) -> Table:
    """A file of equations, TOML or YAML by its ending.

    Raises:
        EquationError: there is no such file, or it is neither.
    """
    source = path.name
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise EquationError(f"is not UTF-8 text (byte {error.start}): save it as UTF-8", source=source) from error
    except OSError as error:
        raise EquationError(f"cannot be read: {error.strerror}", source=str(path)) from error
    entries = _yaml(text, source) if path.suffix in (".yaml", ".yml") else _toml(text, source)
    if not isinstance(entries, dict):
        raise EquationError("holds no table: expected [robot], [[link]], [[symbol]], [[equation]]", source=source)
    return Table(source, "", entries)


def _toml(text: str, source: str) -> Any:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise EquationError(f"is no TOML: {error}; LaTeX goes between ''' and '''", source=source) from error


def _yaml(text: str, source: str) -> Any:
    import yaml

    try:
        return yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise EquationError(f"is no YAML: {error}", source=source) from error
