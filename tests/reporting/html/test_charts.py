"""Charts: what is drawn is where it belongs, all of it is said in words, and no name is markup."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np
import pytest
from lxml import etree

from rttrr_pin.reporting.html import Chart, bars, histogram, line_chart, scatter
from rttrr_pin.reporting.html.markup import element, slug
from rttrr_pin.reporting.html.scales import Scale, label, linear, ticks
from rttrr_pin.reporting.html.theme import COLOURS

ODD = "<b>&'\"]]>{{ 7 * 7 }}</svg><script>alert(1)</script>\x1b\u202e"

X = np.linspace(0.0, 4.0, 41)

SPECIAL = np.array([np.nan, np.inf, -np.inf, 1.0, 1e308, -1e308, 0.0, 1e-300] * 5 + [2.0])


def over_time(name: str, y: np.ndarray) -> Chart:
    return line_chart("a", name, X, {name: (y, y + 1.0)}, "time [s]", name, (name, (y - 1, y + 2)), {name: (3.0, -3.0)})


KINDS: dict[str, Callable[[str, np.ndarray], Chart]] = {
    "line": over_time,
    "lines": lambda name, y: line_chart("a", name, X, {name: y, "other": y}, "time [s]", name),
    "scatter": lambda name, y: scatter("a", name, X, y, name, name, {name: (2.0,)}, {name: (1.0,)}, {name: X}),
    "histogram": lambda name, y: histogram("a", name, [0.5, 1.0, 2.0], {name: [3, 0]}, name, {name: 1.0}),
    "bars": lambda name, y: bars(
        "a", name, {name: float(abs(y[3])), "inf": math.inf, "nan": math.nan}, name, (name, 1.0)
    ),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "y", [np.sin(X), np.zeros(41), np.full(41, np.nan), SPECIAL], ids=["sine", "zero", "nan", "special"]
)
@pytest.mark.filterwarnings("ignore:overflow", "ignore:invalid value")
def test_every_chart_is_well_formed_and_finite(kind: str, y: np.ndarray) -> None:
    chart = KINDS[kind]("tau of joint_1", y)
    for text in (chart.file(), str(chart.svg)):
        root = etree.fromstring(text)
        for node in root.iter():
            for name, value in node.attrib.items():
                if name not in ("aria-label",):
                    assert "nan" not in value and "inf" not in value, (node.tag, name, value)
    assert chart.text.startswith("tau of joint_1") and chart.title == "tau of joint_1"


@pytest.mark.parametrize("kind", KINDS)
def test_a_name_is_only_a_name(kind: str) -> None:
    chart = KINDS[kind](ODD, np.sin(X))
    for text in (chart.file(), str(chart.svg)):
        root = etree.fromstring(text)
        tags = {etree.QName(node).localname for node in root.iter()}
        assert tags <= {"svg", "g", "line", "text", "path", "rect", "circle", "title", "desc", "style"}
        assert not any(name.startswith("on") or name == "href" for node in root.iter() for name in node.attrib)
        assert "\x1b" not in text and "\u202e" not in text


@pytest.mark.parametrize("kind", KINDS)
def test_a_file_has_colours_and_no_variables(kind: str) -> None:
    text = KINDS[kind]("a", np.sin(X)).file()
    assert "var(" not in text and COLOURS["s1"][0] in text and "url(" not in text


def test_a_line_passes_through_its_points() -> None:
    chart = line_chart("a", "t", X, {"y": np.sin(X)}, "time [s]", "y")
    [path] = re.findall(r'class="line s1" d="([^"]*)"', str(chart.svg))
    drawn = np.array([[float(a), float(b)] for a, b in re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", path)])
    height = chart.data["plot"][3]
    low, high, bottom, up = chart.data["at"]
    np.testing.assert_allclose(low + drawn[:, 0] / 1000 * (high - low), X, atol=1e-3)
    np.testing.assert_allclose(up - drawn[:, 1] / height * (up - bottom), np.sin(X), atol=0.01)
    assert chart.data["series"][0]["low"] == pytest.approx(np.sin(X), rel=1e-4, abs=1e-9)


def test_a_limit_far_off_is_said_and_not_drawn() -> None:
    near, far = (line_chart("a", "t", X, {"y": np.sin(X)}, "s", "y", limits={"limit": (m, -m)}) for m in (1.5, 80.0))
    assert str(near.svg).count('class="limit"') == 2 and not near.note
    assert str(far.svg).count('class="limit"') == 0 and "±80" in far.note and "±80" in far.text


def test_a_histogram_counts_what_is_beyond() -> None:
    edges = [2.0**k for k in range(-4, 4)]
    chart = histogram("h", "errors", edges, {"tau": [0, 5, 3, 0, 1, 0, 0], "F": [0] * 7}, "x", {"tolerance": 1.0})
    said = re.findall(r"<title>(.*?)</title>", str(chart.svg))
    assert [int(re.search(r": (\d+) states", one)[1]) for one in said] == [5, 3, 1]
    assert str(chart.svg).count('"column beyond"') == 1
    assert "1 beyond 1" in chart.text and "F: none" in chart.text


@pytest.mark.parametrize(("low", "high"), [(0, 1), (-3.7, 12), (1e-9, 2e-9), (-1e300, 1e300), (5, 5)])
def test_ticks_are_few_and_inside(low: float, high: float) -> None:
    found = ticks(low, high)
    assert 1 <= len(found) <= 8
    assert all(low - abs(low) * 1e-6 <= x <= high + abs(high) * 1e-6 for x in found)


def test_scales_go_where_they_should() -> None:
    scale = Scale(1e-4, 1.0, 0.0, 400.0, log=True)
    np.testing.assert_allclose(scale([1e-4, 1e-2, 1.0]), [0, 200, 400])
    assert scale.ticks() == pytest.approx([1e-4, 1e-3, 1e-2, 0.1, 1.0])
    assert linear([[5.0, 5.0]], 0, 10).at(5.0) == pytest.approx(5.0)
    assert [label(x) for x in (0.0, -0.0, 1e5, 12345.0, 0.5)] == ["0", "0", "1e5", "1.234e4", "0.5"]


def test_elements_and_names_of_files() -> None:
    assert element("a", "<", class_="x", stroke_width=1.0, cx=None) == '<a class="x" stroke-width="1">&lt;</a>'
    assert slug("../../etc/passwd") == "etc-passwd" and slug("é") == "unnamed"
