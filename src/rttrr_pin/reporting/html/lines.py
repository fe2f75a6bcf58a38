"""Numbers over time, and points in a plane, with their limits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from markupsafe import Markup

from rttrr_pin.core.arrays import Array
from rttrr_pin.reporting.html.chart import ACROSS, BOTTOM, LEFT, RIGHT, TOP, WIDTH, Chart, Key, axes, plot
from rttrr_pin.reporting.html.markup import element, joined, path
from rttrr_pin.reporting.html.scales import Scale, label, linear, span

HEIGHT = 250.0

FAR = 2.5
"""A limit that is so many times as large as the largest number is said, not drawn: it would flatten the rest."""

COLOURS = 6
"""Of series; then they begin again."""

Range = tuple[Array, Array]
"""The least and the largest number of each place."""

Series = Array | Range

Limits = Mapping[str, tuple[float, ...]]
"""By name, the values that are not to be exceeded."""


def line_chart(
    name: str,
    title: str,
    x: Array,
    series: Mapping[str, Series],
    x_label: str,
    y_label: str,
    band: tuple[str, Range] | None = None,
    limits: Limits | None = None,
    ends: tuple[float, float] | None = None,
) -> Chart:
    """Numbers over time.

    Args:
        name: of the picture, in letters for a file's name.
        title: what it is of.
        x: the times, in order.
        series: by name, a line, or what its numbers are between at each time.
        x_label: what x is, and its unit.
        y_label: likewise.
        band: name, and what the truth is between at each time.
        limits: by name, what is not to be exceeded; drawn where they are not far off.
        ends: of the axis, where it is longer than the times.
    """
    pairs = {key: value if isinstance(value, tuple) else (value, value) for key, value in series.items()}
    every = [*pairs.values(), *([] if band is None else [band[1]])]
    drawn, far = _near(limits or {}, every)
    across = Scale(*_wide(*span([x, ends or ()])), LEFT, WIDTH - RIGHT)
    up = linear([*(side for pair in every for side in pair), _values(drawn)], HEIGHT - BOTTOM, TOP)
    inner = Scale(across.low, across.high, 0.0, ACROSS)
    inner_up = Scale(up.low, up.high, HEIGHT - BOTTOM - TOP, 0.0)
    parts, keys = [], []
    if band is not None:
        parts.append(element("path", class_="band", d=_area(inner(x), *map(inner_up, band[1])), data_series="-1"))
        keys.append(Key("band", band[0], -1))
    for k, (key, (low, high)) in enumerate(pairs.items()):
        look = f"s{k % COLOURS + 1}"
        d = path(inner(x), inner_up(low)) if low is high else _area(inner(x), inner_up(low), inner_up(high))
        parts.append(element("path", class_=f"{'line' if low is high else 'area'} {look}", d=d, data_series=str(k)))
        keys.append(Key(f"{look} area", key, k))
    keys += [Key("limit", f"{key} {_both(values)}") for key, values in drawn.items()]
    rules = joined(_across(inner_up.at(value)) for value in _values(drawn))
    body = joined((axes(across, up, x_label, y_label), plot(across, up, *parts, rules)))
    data = {
        **_frame(across, up),
        "x": _numbers(x),
        "unit": [x_label, y_label],
        "series": [
            {"name": key, "low": _numbers(low), **({} if low is high else {"high": _numbers(high)})}
            for key, (low, high) in [*pairs.items(), *([] if band is None else [band])]
        ],
    }
    said = "; ".join(_said(key, x, *pair, x_label) for key, pair in pairs.items())
    said_limits = "".join(f"; {key} {_both(values)}" for key, values in (limits or {}).items())
    return Chart(
        name=name,
        title=title,
        text=f"{title}, {y_label} over {x_label} from {label(across.low)} to {label(across.high)}: {said}{said_limits}",
        body=body,
        height=HEIGHT,
        legend=tuple(keys),
        note=_beyond(far),
        kind="time",
        data=data,
    )


def scatter(
    name: str,
    title: str,
    x: Array,
    y: Array,
    x_label: str,
    y_label: str,
    limits_x: Limits | None = None,
    limits_y: Limits | None = None,
    extra: Mapping[str, Array] | None = None,
) -> Chart:
    """Points in a plane, such as torque against speed.

    Args:
        name: of the picture, in letters for a file's name.
        title: what it is of.
        x: of each point.
        y: likewise.
        x_label: what x is, and its unit.
        y_label: likewise.
        limits_x: by name, what x is not to exceed; drawn where it is not far off.
        limits_y: likewise.
        extra: by name, more numbers of each point, for who points at it.
    """
    (near_x, far_x), (near_y, far_y) = _near(limits_x or {}, [(x, x)]), _near(limits_y or {}, [(y, y)])
    across = linear([x, _values(near_x)], LEFT, WIDTH - RIGHT)
    up = linear([y, _values(near_y)], HEIGHT - BOTTOM, TOP)
    px, py = across(x), up(y)
    good = np.isfinite(px) & np.isfinite(py)
    dots = "".join(f"M{a:.1f} {b:.1f}h0" for a, b in zip(px[good].tolist(), py[good].tolist(), strict=True))
    lines = [
        *(_rule(across.at(value), across.at(value), up.start, up.end) for value in _values(near_x)),
        *(_rule(across.start, across.end, up.at(value), up.at(value)) for value in _values(near_y)),
    ]
    zero = [_zero(across, up)] if across.low < 0.0 < across.high else []
    body = joined((axes(across, up, x_label, y_label), *zero, element("path", class_="dots s1", d=dots), *lines))
    keys = [Key("dots", "rows of the trajectory")] if extra else []
    keys += [Key("limit", f"{key} {_both(values)}") for key, values in (near_x | near_y).items()]
    data = {
        **_frame(across, up),
        "x": _numbers(x),
        "y": _numbers(y),
        "unit": [x_label, y_label],
        "extra": {key: _numbers(values) for key, values in (extra or {}).items()},
    }
    limits = {**(limits_x or {}), **(limits_y or {})}
    said = "".join(f"; {key} {_both(values)}" for key, values in limits.items())
    ranges = " and ".join(
        f"{axis} from {label(span([own])[0])} to {label(span([own])[1])}" for axis, own in ((x_label, x), (y_label, y))
    )
    return Chart(
        name=name,
        title=title,
        text=f"{title}, {len(x)} points: {ranges}{said}",
        body=body,
        height=HEIGHT,
        legend=tuple(keys),
        note=_beyond({**far_x, **far_y}),
        kind="points",
        data=data,
    )


def _near(limits: Limits, ranges: Iterable[Range]) -> tuple[dict[str, tuple[float, ...]], dict[str, tuple[float, ...]]]:
    """The limits that are drawn, and those that are far beyond all numbers."""
    low, high = span([side for pair in ranges for side in pair])
    size = max(abs(low), abs(high))
    finite = {key: kept for key, own in limits.items() if (kept := tuple(x for x in own if math.isfinite(x)))}
    drawn = {key: own for key, own in finite.items() if max(map(abs, own)) <= FAR * size}
    return drawn, {key: own for key, own in finite.items() if key not in drawn}


def _values(limits: Limits) -> list[float]:
    return [value for own in limits.values() for value in own]


def _both(values: tuple[float, ...]) -> str:
    """A limit in both directions, or each."""
    if len(values) == 2 and values[0] == -values[1]:
        return f"\u00b1{label(max(values))}"
    return ", ".join(map(label, values))


def _beyond(far: Limits) -> str:
    """What is not drawn."""
    return f"beyond the picture: {', '.join(f'{key} {_both(own)}' for key, own in far.items())}" if far else ""


def _wide(low: float, high: float) -> tuple[float, float]:
    return (low, high) if low < high else (low - 0.5, high + 0.5)


def _area(x: Array, low: Array, high: Array) -> str:
    """What is between two lines, where both are finite."""
    good = np.isfinite(low) & np.isfinite(high)
    x, low, high = x[good], low[good], high[good]
    return path(np.concatenate([x, x[::-1]]), np.concatenate([high, low[::-1]]), closed=True)


def _across(y: float) -> Markup:
    return element("line", class_="limit", x1=-ACROSS, x2=2 * ACROSS, y1=y, y2=y)


def _rule(x1: float, x2: float, y1: float, y2: float) -> Markup:
    return element("line", class_="limit", x1=x1, x2=x2, y1=y1, y2=y2)


def _zero(across: Scale, up: Scale) -> Markup:
    return element("line", class_="axis", x1=across.at(0.0), x2=across.at(0.0), y1=up.start, y2=up.end)


def _frame(x: Scale, y: Scale) -> dict[str, Any]:
    """Where the plot is, and what its edges are."""
    return {"plot": [x.start, y.end, x.end - x.start, y.start - y.end], "at": [x.low, x.high, y.low, y.high]}


def _numbers(x: Array) -> list[float | None]:
    """To five digits, which is more than can be read off; null for what is no number."""
    return [float(f"{value:.5g}") if math.isfinite(value) else None for value in x.tolist()]


def _said(name: str, x: Array, low: Array, high: Array, x_label: str) -> str:
    """Where a line is lowest and highest."""
    if not (np.isfinite(low).any() and np.isfinite(high).any()):
        return f"{name} has no finite number"
    least, most = int(np.nanargmin(low)), int(np.nanargmax(high))
    unit = x_label.partition("[")[2].rstrip("]")
    ends = f"{label(low[least])} at {label(x[least])} {unit}", f"{label(high[most])} at {label(x[most])} {unit}"
    return f"{name} from {ends[0].rstrip()} to {ends[1].rstrip()}"
