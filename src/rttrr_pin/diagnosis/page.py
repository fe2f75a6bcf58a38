"""Diagnoses and comparisons as one HTML page: no scripts, nothing that is loaded, readable in the dark and on paper."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from rttrr_pin.reporting.output import shown


@dataclass(frozen=True, slots=True)
class Said:
    """A cause in words.

    Attributes:
        sentence: what it is.
        facts: names and texts, such as its repair.
        alternatives: what would do as well.
    """

    sentence: str
    facts: tuple[tuple[str, str], ...] = ()
    alternatives: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Bars:
    """A row of a table, with a bar for what is in it before, and one for after; in percent of the longest.

    Attributes:
        cells: texts.
        before: length of the first bar.
        after: of the second; None where there is none.
        said: what the bars show, for who does not see them.
    """

    cells: tuple[str, ...]
    before: float
    after: float | None
    said: str


@dataclass(frozen=True, slots=True)
class Rows:
    """A table with bars.

    Attributes:
        title: its heading.
        head: names of the columns but for the bars.
        rows: the rows.
        legend: what is to be known of them.
        texts: how many columns, from the first, are words; the others are numbers.
        one: where on the bars 1 is, in percent; None where no line is drawn.
    """

    title: str
    head: tuple[str, ...]
    rows: tuple[Bars, ...]
    legend: str = ""
    texts: int = 2
    one: float | None = None


@dataclass(frozen=True, slots=True)
class Points:
    """A list of sentences with a heading."""

    title: str
    items: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Page:
    """What a page says, from top to bottom.

    Attributes:
        title: the robot, or the two.
        compared: what with what.
        verdict: a word.
        tone: agrees, explained, or unexplained; for the colour.
        sentence: what the word is about.
        causes: in order.
        alike: what the alternatives of a cause are.
        lists: of sentences.
        tables: with bars.
        code: a test to paste.
        notes: what a reader must know.
    """

    title: str
    compared: str
    verdict: str
    tone: str
    sentence: str
    causes: tuple[Said, ...] = ()
    alike: str = ""
    lists: tuple[Points, ...] = ()
    tables: tuple[Rows, ...] = ()
    code: str = ""
    notes: tuple[str, ...] = ()


def html(page: Page) -> str:
    """The page as HTML; names are escaped, and control characters in them are question marks."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from rttrr_pin.version import __version__

    environment = Environment(
        loader=PackageLoader(__package__ or "", "templates"),
        autoescape=True,
        finalize=lambda value: shown(value) if isinstance(value, str) else value,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.get_template("page.html").render(page=page, version=__version__)


def points(title: str, items: Iterable[str]) -> tuple[Points, ...]:
    """A list, where it has anything in it."""
    found = tuple(items)
    return (Points(title, found),) if found else ()


def of_longest(values: Sequence[float]) -> list[float]:
    """Lengths of bars in percent of the longest."""
    most = max((x for x in values if math.isfinite(x)), default=0.0) or 1.0
    return [round(100.0 * min(max(x, 0.0) / most, 1.0), 2) if not math.isnan(x) else 0.0 for x in values]


def by_decades(values: Sequence[float], least: float = 1e-3) -> tuple[list[float], float]:
    """Lengths of bars by the decades above the least value, in percent of the longest; and where 1 is."""
    decades = [max(math.log10(max(min(x, 1e300), least) / least), 0.0) for x in values]
    most = max([*decades, math.log10(1.0 / least)])
    return [round(100.0 * x / most, 2) for x in decades], round(100.0 * math.log10(1.0 / least) / most, 2)
