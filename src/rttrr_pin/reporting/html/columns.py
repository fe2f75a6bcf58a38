"""How many are how large, and bars with names."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray

from rttrr_pin.reporting.html.chart import BOTTOM, RIGHT, TOP, WIDTH, Chart, Key, axes, cut
from rttrr_pin.reporting.html.markup import element, joined
from rttrr_pin.reporting.html.scales import Scale, label, linear

ROW = 44.0
"""Height of a histogram; several stand above each other."""

BAR = 22.0

ROOM = 150.0
"""For the names beside bars."""


def histogram(
    name: str,
    title: str,
    edges: Sequence[float],
    counts: Mapping[str, ArrayLike],
    x_label: str,
    marks: Mapping[str, float],
    what: str = "states",
    note: str = "",
) -> Chart:
    """How many are of which size, a row for each name, on a logarithmic scale of sizes.

    Heights are logarithms of counts too, so that one among a million is seen.

    Args:
        name: of the picture, in letters for a file's name.
        title: what it is of.
        edges: of the bins, positive and rising, one more than counts.
        counts: by name, how many are in each bin.
        x_label: what is counted, and its unit.
        marks: by name, sizes to mark with a line; what is beyond the first is drawn in the colour of what is wrong.
        what: is counted.
        note: what is to be known of it.
    """
    edges, counts = _cropped(edges, counts, [*marks.values()])
    x = Scale(edges[0], edges[-1], 64.0, WIDTH - RIGHT, log=True)
    places = x(edges)
    bound = next(iter(marks.values()), math.inf)
    parts: list[Markup] = []
    for k, (row, values) in enumerate(counts.items()):
        bottom = TOP + (k + 1) * ROW
        parts.append(element("line", class_="grid", x1=x.start, x2=x.end, y1=bottom, y2=bottom))
        parts.append(element("text", cut(row, 8), x=x.start - 8, y=bottom - 10, class_="label end"))
        own = np.asarray(values, dtype=np.int64)
        tall = math.log1p(max(int(own.max(initial=0)), 1))
        for i in np.flatnonzero(own).tolist():
            height = (ROW - 8.0) * (0.12 + 0.88 * math.log1p(own[i]) / tall)
            said = f"{row}: {own[i]:,} {what} from {edges[i]:.2g} to {edges[i + 1]:.2g}"
            look = "column beyond" if edges[i] >= bound else "column"
            place = {"x": places[i] + 0.3, "width": max(places[i + 1] - places[i] - 0.6, 0.5)}
            parts.append(
                element("rect", element("title", said), class_=look, y=bottom - height, height=height, **place)
            )
    end = TOP + len(counts) * ROW
    for mark, value in marks.items():
        at = x.at(value)
        parts.append(element("line", class_="limit", x1=at, x2=at, y1=TOP - 6, y2=end))
        side = "end" if at > WIDTH / 2 else ""
        parts.append(element("text", mark, x=at + (-5 if side else 5), y=TOP - 8, class_=f"tick {side}"))
    body = joined((axes(x, Scale(0, 1, end, TOP), x_label, "", ()), *parts))
    return Chart(
        name, title, _histogram_text(title, edges, counts, bound, what), body, end + BOTTOM, _keys(bound), note
    )


def _cropped(
    edges: Sequence[float], counts: Mapping[str, ArrayLike], marks: Sequence[float]
) -> tuple[list[float], dict[str, NDArray[np.int64]]]:
    """Without the bins at both ends that nothing is in, as long as the marks stay inside."""
    rows = {row: np.asarray(values, dtype=np.int64) for row, values in counts.items()}
    used = np.flatnonzero(np.sum([*rows.values()], axis=0)) if rows else np.zeros(0, dtype=np.int64)
    at = [int(np.searchsorted(edges, mark)) for mark in marks]
    first = max(min([*used.tolist(), *(k - 1 for k in at)], default=0) - 1, 0)
    last = min(max([*used.tolist(), *at], default=len(edges) - 2) + 1, len(edges) - 2)
    return [*edges[first : last + 2]], {row: own[first : last + 1] for row, own in rows.items()}


def _keys(bound: float) -> tuple[Key, ...]:
    return (Key("column", "within"), Key("column beyond", "beyond")) if math.isfinite(bound) else ()


def _histogram_text(
    title: str, edges: Sequence[float], counts: Mapping[str, ArrayLike], bound: float, what: str
) -> str:
    """Of each row how many, the usual size, the largest, and how many are beyond the first mark."""
    said = []
    for row, values in counts.items():
        own = np.asarray(values, dtype=np.int64)
        if not own.sum():
            said.append(f"{row}: none")
            continue
        middle = int(np.searchsorted(np.cumsum(own), (own.sum() + 1) // 2))
        last = int(np.flatnonzero(own)[-1])
        beyond = int(own[np.asarray(edges[:-1]) >= bound].sum())
        usual = f"half of {own.sum():,} {what} below {edges[middle + 1]:.2g}, all below {edges[last + 1]:.2g}"
        said.append(f"{row}: {usual}{f', {beyond:,} beyond {label(bound)}' if beyond else ''}")
    return f"{title}. {'; '.join(said)}"


def bars(
    name: str,
    title: str,
    values: Mapping[str, float],
    x_label: str,
    mark: tuple[str, float] | None = None,
    beyond: bool = True,
    note: str = "",
) -> Chart:
    """A bar for each name.

    Args:
        name: of the picture, in letters for a file's name.
        title: what it is of.
        values: by name, not negative; one that is not finite is as long as the picture.
        x_label: what is shown, and its unit.
        mark: name and value of a line across all bars.
        beyond: whether bars beyond the mark are wrong.
        note: what is to be known of it.
    """
    lengths = [0.0, *values.values(), *([] if mark is None else [mark[1]])]
    scale = linear([[x for x in lengths if math.isfinite(x)]], ROOM, WIDTH - RIGHT - 44.0, margin=0.0)
    x = Scale(0.0, scale.high, scale.start, scale.end)
    parts: list[Markup] = []
    for k, (row, value) in enumerate(values.items()):
        top = TOP + k * BAR
        end = x.at(min(value, x.high)) if not math.isnan(value) else x.start
        wrong = mark is not None and beyond and value > mark[1]
        bar = element(
            "rect",
            element("title", f"{row}: {value:.3g}"),
            class_=f"column{' beyond' * wrong}",
            x=x.start,
            y=top + 3,
            width=max(end - x.start, 0.5),
            height=BAR - 6,
        )
        parts += (
            bar,
            element("text", cut(row, 20), x=x.start - 8, y=top + 15, class_="label end"),
            element("text", f"{value:.3g}", x=end + 5, y=top + 15, class_="tick halo"),
        )
    bottom = TOP + len(values) * BAR + 4
    if mark is not None:
        at = x.at(mark[1])
        parts.insert(0, element("line", class_="limit", x1=at, x2=at, y1=TOP - 6, y2=bottom))
        parts.append(element("text", mark[0], x=at, y=TOP - 10, class_="tick middle"))
    body = joined((axes(x, Scale(0, 1, bottom, TOP), x_label, "", ()), *parts))
    text = f"{title}. {'; '.join(f'{row}: {value:.3g}' for row, value in values.items())}"
    return Chart(name, title, text, body, bottom + BOTTOM, note=note)
