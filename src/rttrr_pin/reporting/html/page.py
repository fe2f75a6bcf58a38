"""What a page says, from top to bottom, and the page as HTML.

A page is one file that loads nothing. The verdict comes first, then where to look. Every text is escaped once, by the
template; the policy in its head lets a browser run nothing but the script of this package.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from markupsafe import Markup

from rttrr_pin.reporting.html.chart import STYLE, Chart
from rttrr_pin.reporting.html.theme import variables
from rttrr_pin.reporting.output import shown

Facts = tuple[tuple[str, str], ...]
"""Names and texts."""


@dataclass(frozen=True, slots=True)
class Said:
    """A cause, or a finding, in words.

    Attributes:
        sentence: what it is.
        facts: names and texts, such as its repair.
        alternatives: what would do as well.
        tone: good, warn or bad, for the colour; a word says it too.
        word: that word.
    """

    sentence: str
    facts: Facts = ()
    alternatives: tuple[str, ...] = ()
    tone: str = ""
    word: str = ""


@dataclass(frozen=True, slots=True)
class Causes:
    """Causes, or findings, in order.

    Attributes:
        items: the causes.
        alike: what the alternatives of a cause are.
        title: a heading, where they need one.
        numbered: whether each has its number.
    """

    items: tuple[Said, ...]
    alike: str = ""
    title: str = ""
    numbered: bool = True


@dataclass(frozen=True, slots=True)
class Bars:
    """A row of a table, with a bar for what is in it before, and one for after; in percent of the longest.

    Attributes:
        cells: texts.
        before: length of the first bar; None in a table without bars.
        after: of the second; None where there is none.
        said: what the bars show, for who does not see them.
        tone: good, warn or bad, for the colour of the row's first cell.
    """

    cells: tuple[str, ...]
    before: float | None = None
    after: float | None = None
    said: str = ""
    tone: str = ""


@dataclass(frozen=True, slots=True)
class Rows:
    """A table, with or without bars.

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

    @property
    def barred(self) -> bool:
        """Whether there are bars."""
        return any(row.before is not None for row in self.rows)


@dataclass(frozen=True, slots=True)
class Points:
    """A list of sentences with a heading."""

    title: str
    items: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Figures:
    """Pictures beside each other."""

    title: str
    charts: tuple[Chart, ...]
    legend: str = ""


@dataclass(frozen=True, slots=True)
class Code:
    """What is to be copied: commands, or a test."""

    title: str
    text: str


@dataclass(frozen=True, slots=True)
class Written:
    """What another template wrote, as markup that is safe."""

    title: str
    markup: Markup


Block = Causes | Rows | Points | Figures | Code | Written


@dataclass(frozen=True, slots=True)
class Page:
    """What a page says.

    Attributes:
        title: the robot, or the two.
        compared: what with what.
        verdict: a word.
        tone: agrees, explained, or unexplained; for the colour.
        sentence: what the word is about.
        blocks: from top to bottom.
        facts: the most important numbers.
        notes: what a reader must know.
        command: what wrote it, such as `validate`.
    """

    title: str
    compared: str
    verdict: str
    tone: str
    sentence: str
    blocks: tuple[Block, ...] = ()
    facts: Facts = ()
    notes: tuple[str, ...] = ()
    command: str = ""

    @property
    def charts(self) -> list[Chart]:
        """All pictures."""
        return [chart for block in self.blocks if isinstance(block, Figures) for chart in block.charts]


def html(page: Page) -> str:
    """The page as HTML; names are escaped, and control characters in them are question marks."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from rttrr_pin.version import __version__

    environment = Environment(
        loader=PackageLoader(__package__ or "", "templates"),
        autoescape=True,
        finalize=_only_shown,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"kind": lambda part: type(part).__name__, "data": _data}
    style, script = style_of(), _file("page.js") if any(chart.data for chart in page.charts) else ""
    policy = f"default-src 'none'; style-src {_hash(style)}" + (f"; script-src {_hash(script)}" if script else "")
    return environment.get_template("page.html").render(
        page=page,
        version=__version__,
        style=Markup(style),
        script=Markup(script),
        policy=policy,
    )


def style_of() -> str:
    """The style of a page."""
    light, dark = variables(False), variables(True)
    colours = (
        f":root {{ color-scheme: light dark; {light} }}\n@media (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n"
    )
    paper = f"@media print {{ :root {{ color-scheme: light; {light} }} }}\n"
    return f"\n{colours}{paper}{_file('page.css')}{STYLE.read_text(encoding='utf-8')}"


def _file(name: str) -> str:
    return (STYLE.parent / name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """How a policy names a text."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _only_shown(value: Any) -> Any:
    return shown(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def _data(chart: Chart) -> Markup:
    """The numbers of a picture as JSON, which no name in it can end."""
    words = json.dumps(_harmless({"kind": chart.kind, **(chart.data or {})}), separators=(",", ":"), allow_nan=False)
    safe = words.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")
    return Markup(safe)


def _harmless(data: Any) -> Any:
    """The same data, with control characters of its texts as question marks."""
    if isinstance(data, dict):
        return {shown(key): _harmless(value) for key, value in data.items()}
    if isinstance(data, list) and data and isinstance(data[0], str | dict):
        return [_harmless(value) for value in data]
    return shown(data) if isinstance(data, str) else data


def points(title: str, items: Iterable[str]) -> tuple[Points, ...]:
    """A list, where it has anything in it."""
    found = tuple(items)
    return (Points(title, found),) if found else ()


def code(title: str, text: str) -> tuple[Code, ...]:
    """What is to be copied, where there is anything."""
    return (Code(title, text),) if text else ()


def of_longest(values: Sequence[float]) -> list[float]:
    """Lengths of bars in percent of the longest."""
    most = max((x for x in values if math.isfinite(x)), default=0.0) or 1.0
    return [round(100.0 * min(max(x, 0.0) / most, 1.0), 2) if not math.isnan(x) else 0.0 for x in values]


def by_decades(values: Sequence[float], least: float = 1e-3) -> tuple[list[float], float]:
    """Lengths of bars by the decades above the least value, in percent of the longest; and where 1 is."""
    decades = [max(math.log10(max(min(x, 1e300), least) / least), 0.0) for x in values]
    most = max([*decades, math.log10(1.0 / least)])
    return [round(100.0 * x / most, 2) for x in decades], round(100.0 * math.log10(1.0 / least) / most, 2)
