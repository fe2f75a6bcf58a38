"""Pictures of a page: an SVG, what it shows in words, and the numbers that a pointer over it reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from markupsafe import Markup

from rttrr_pin.reporting.html.markup import element, joined
from rttrr_pin.reporting.html.scales import Scale, label, power
from rttrr_pin.reporting.html.theme import inlined

WIDTH = 480
"""Of every picture, in its own units: about a pixel each where two stand side by side, and enough on a phone."""

LEFT, RIGHT, TOP, BOTTOM = 58.0, 14.0, 26.0, 42.0
"""Margins, with room for ticks and the names of the axes."""

ACROSS = 1000.0
"""How many units wide the inner picture is, which is stretched to its place, and moved to zoom."""

STYLE = Path(__file__).with_name("templates") / "chart.css"

MOST_LETTERS = 26
"""Of a name in a picture; the whole name is in the words beside it."""


def _stroke(look: str, d: str = "M1 6h20") -> Markup:
    return element("path", class_=look, d=d)


SIGNS = {
    **{look: _stroke(look) for look in ("x", "y", "z", "limit")},
    "force": _stroke("force", "M1 6h19M15 2l5 4l-5 4"),
    "turn": element("circle", cx=11, cy=6, r=4, class_="turn"),
    "rigid": element("circle", cx=11, cy=6, r=2.5, class_="rigid"),
    "slide": element("rect", x=7, y=2, width=8, height=8, class_="slide"),
    "free": element("path", d="M11 0l6 6l-6 6l-6 -6z", class_="free"),
    "mass": joined(
        (
            element("circle", cx=11, cy=6, r=3.5, class_="mass"),
            element(
                "path", d="M11 6v-3.5a3.5 3.5 0 0 1 3.5 3.5zM11 6v3.5a3.5 3.5 0 0 1 -3.5 -3.5z", class_="mass-half"
            ),
        )
    ),
    "dots": _stroke("dots s1", "M5 6h0M11 4h0M17 8h0"),
}
"""What stands beside the words of a legend, by look; other looks are fields of colour."""


@dataclass(frozen=True, slots=True)
class Key:
    """An entry of a legend.

    Attributes:
        look: classes of the style, such as `s1 area`.
        label: what it stands for.
        series: the number of the series that it shows or hides; None where there is nothing to hide.
    """

    look: str
    label: str
    series: int | None = None

    @property
    def sign(self) -> Markup:
        """The look as a sign of 22 by 12."""
        if self.look in SIGNS:
            return SIGNS[self.look]
        tall = 12.0 if self.look.startswith("column") else 9.0
        return element("rect", x=1, y=(12.0 - tall) / 2, width=20, height=tall, class_=self.look)

    @property
    def picture(self) -> Markup:
        """The sign as part of a page."""
        return element("svg", self.sign, class_="sign", viewBox="0 0 22 12", aria_hidden="true")


@dataclass(frozen=True, slots=True)
class Chart:
    """A picture.

    Attributes:
        name: in letters that a file's name can have.
        title: what it is of.
        text: what it shows, for who does not see it.
        body: what is in the SVG.
        height: of it; the width is `WIDTH`.
        legend: what the colours are.
        note: what is to be known of it, in small print.
        kind: `time` can be zoomed with others of that kind, `points` has marks to read, `still` neither.
        data: what a pointer reads; none for a still picture.
    """

    name: str
    title: str
    text: str
    body: Markup
    height: float
    legend: tuple[Key, ...] = ()
    note: str = ""
    kind: str = "still"
    data: dict[str, Any] | None = field(default=None, repr=False)

    @property
    def svg(self) -> Markup:
        """The picture as part of a page, whose colours it takes."""
        return element("svg", self.body, class_="chart", viewBox=self._box(), role="img", aria_label=self.text)

    def file(self) -> str:
        """The picture as a file of its own, in light colours, with its title and legend."""
        head = 26.0
        style = Markup(inlined(STYLE.read_text(encoding="utf-8")))
        legend, rows = _legend(self.legend, self.height + 8.0)
        height = head + self.height + ROW * rows + 10.0 * bool(rows)
        inside = (
            element("title", self.title),
            element("desc", self.text),
            element("style", style),
            element("rect", width=WIDTH, height=height, class_="paper"),
            element("text", self.title, x=14, y=19, class_="title"),
            element("g", self.body, legend, transform=f"translate(0 {head:g})"),
        )
        box = f"0 0 {WIDTH} {height:g}"
        return (
            f"{element('svg', *inside, xmlns='http://www.w3.org/2000/svg', viewBox=box, width=WIDTH, height=height)}\n"
        )

    def _box(self) -> str:
        return f"0 0 {WIDTH} {self.height:g}"


ROW, LETTER = 18.0, 6.4
"""Of a legend in a file: height of a row, mean width of a letter."""


def _legend(keys: Sequence[Key], top: float) -> tuple[Markup, int]:
    """The entries in rows, and how many rows."""
    parts, x, row = [], 14.0, 0
    for key in keys:
        width = 46.0 + LETTER * len(key.label)
        if x > 14.0 and x + width > WIDTH:
            x, row = 14.0, row + 1
        y = top + ROW * row
        parts.append(element("g", key.sign, transform=f"translate({x:g} {y:g})"))
        parts.append(element("text", key.label, x=x + 28, y=y + 10, class_="tick"))
        x += width
    return joined(parts), row + 1 if keys else 0


def cut(name: str, most: int = MOST_LETTERS) -> str:
    """A name that fits: the middle of a long one is left out."""
    half = (most - 1) // 2
    return name if len(name) <= most else f"{name[: most - 1 - half]}\u2026{name[-half:]}"


def axes(x: Scale, y: Scale, x_label: str, y_label: str, y_ticks: Sequence[float] | None = None) -> Markup:
    """Rules, numbers and names of both axes of a plot."""
    bottom = max(y.start, y.end)
    parts = []
    for value in y.ticks(5) if y_ticks is None else y_ticks:
        place = y.at(value)
        parts.append(element("line", x1=x.start, x2=x.end, y1=place, y2=place, class_="grid"))
        parts.append(element("text", label(value), x=x.start - 6, y=place + 4, class_="tick end"))
    parts.append(_x_axis(x, bottom))
    parts.append(element("text", x_label, x=x.end, y=bottom + 34, class_="name end"))
    parts.append(element("text", y_label, x=8, y=14, class_="name"))
    return joined(parts)


def _x_axis(x: Scale, bottom: float) -> Markup:
    """In a group of its own, which is drawn again when the picture is zoomed."""
    ticks = []
    for value in x.ticks(6):
        place = x.at(value)
        ticks.append(element("line", x1=place, x2=place, y1=bottom, y2=bottom + 4, class_="axis"))
        ticks.append(
            element("text", power(value) if x.log else label(value), x=place, y=bottom + 17, class_="tick middle")
        )
    rule = element("line", x1=x.start, x2=x.end, y1=bottom, y2=bottom, class_="axis")
    return joined((rule, element("g", *ticks, class_="ticks")))


def plot(x: Scale, y: Scale, *children: Markup) -> Markup:
    """The inside of a plot, `ACROSS` units wide; what leaves it is cut off."""
    top, bottom = sorted((y.start, y.end))
    return element(
        "svg",
        *children,
        class_="plot",
        x=x.start,
        y=top,
        width=x.end - x.start,
        height=bottom - top,
        viewBox=f"0 0 {ACROSS:g} {bottom - top:g}",
        preserveAspectRatio="none",
    )
