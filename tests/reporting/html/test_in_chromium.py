"""The page of each feature as its reader has it: light, dark, on a phone, on paper, by keyboard, without scripts."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from rttrr_pin.reporting.html.scales import label
from support.browser import Tabs, grave_findings, overflow
from support.reports import COMMANDS, ODD, ROWS

pytestmark = pytest.mark.browser

Pages = Mapping[str, Path]


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("name", COMMANDS)
def test_everybody_can_read_it(name: str, dark: bool, pages: Pages, tabs: Tabs) -> None:
    """Contrast too; at the width of a phone and of a desk, where nothing has to be scrolled sideways."""
    page = tabs.open(pages[name], dark=dark, width=390 if dark else 1280)
    assert grave_findings(page) == []
    for width in (390, 1280):
        page.set_viewport_size({"width": width, "height": 900})
        assert overflow(page) == 0
    paper = page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert (sum(map(int, re.findall(r"\d+", paper)[:3])) < 150) == dark


@pytest.mark.parametrize("name", COMMANDS)
def test_it_prints(name: str, pages: Pages, tabs: Tabs) -> None:
    page = tabs.open(pages[name], dark=True)
    page.emulate_media(media="print")
    assert page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    assert not page.locator("nav, .tools").first.is_visible()
    pdf = page.pdf(format="A4", margin={"top": "15mm", "bottom": "15mm", "left": "15mm", "right": "15mm"})
    assert pdf.startswith(b"%PDF") and len(pdf) > 10_000


@pytest.mark.parametrize("name", ["validate", "loads"])
def test_a_page_says_the_same_without_scripts(name: str, pages: Pages, tabs: Tabs) -> None:
    with_scripts, without = (tabs.open(pages[name], javascript=on) for on in (True, False))
    assert without.locator("svg.chart").count() == with_scripts.locator("svg.chart").count() > 1
    for part in ("h1", ".verdict", "table"):
        assert without.locator(part).all_inner_texts() == with_scripts.locator(part).all_inner_texts()


@pytest.mark.parametrize("name", ["validate-odd", "inspect-odd"])
def test_names_of_files_are_only_names(name: str, pages: Pages, tabs: Tabs) -> None:
    page = tabs.open(pages[name])
    assert ODD in page.locator("body").text_content() and page.locator("img").count() == 0


def data(pages: Pages, name: str) -> Any:
    return json.loads(pages[name].with_suffix(".json").read_text())


def test_the_numbers_of_validate_are_those_of_the_api(pages: Pages, tabs: Tabs) -> None:
    page, [reference] = tabs.open(pages["validate"]), data(pages, "validate")["references"]
    table = page.locator("table").last
    shown = {
        tuple(row.locator("td").nth(k).inner_text() for k in (0, 1)): row.locator("td").nth(5).inner_text()
        for row in table.locator("tbody tr").all()
    }
    for quantity, places in reference["quantities"].items():
        for at, row in places.items():
            told = shown[quantity, at]
            assert told == (f"{row['of_tolerance']['value']:.3f}" if row["absolute"]["value"] else "")
    counts = [int(x.replace(",", "")) for x in re.findall(r"([\d,]+) states from", page.content())]
    zero = sum(own["zero"] for own in reference["histograms"].values())
    assert sum(counts) + zero == 300 * len(reference["quantities"])


def test_the_numbers_of_loads_are_those_of_the_api(pages: Pages, tabs: Tabs) -> None:
    page, loads = tabs.open(pages["loads"]), data(pages, "loads")
    rows = page.get_by_role("region", name="Torques of joints").locator("tbody tr").all()
    assert len(rows) == len(loads["joints"]) == 5
    for row, joint in zip(rows, loads["joints"], strict=True):
        cells = [cell.inner_text() for cell in row.locator("td").all()]
        peak = joint["tau"]["peak"]
        assert cells[0] == joint["name"] and cells[2].startswith(f"{peak['value']:.5g} \u00b1 {peak['error']:.2g}")
        assert cells[3:5] == [f"{peak['time']:.6g}", str(peak["row"])]
        assert cells[5:7] == [f"{joint['tau']['rms']:.4g}", f"{joint['tau']['cubic_mean']:.4g}"]
    assert f"{ROWS:,}" in page.locator("dl.facts").inner_text()


def test_a_pointer_reads_what_the_api_has(pages: Pages, tabs: Tabs) -> None:
    page, history = tabs.open(pages["loads"]), data(pages, "loads")["history"]
    chart = page.locator("figure[data-kind=time] svg.chart").first
    chart.scroll_into_view_if_needed()
    box = chart.bounding_box()
    page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"])
    said = page.locator(".read:visible").inner_text().splitlines()
    times = [label(t) for t in history["time"]]
    k = times.index(re.fullmatch(r"time (\S+) s", said[0])[1])
    low, high = (label(float(f"{history[key][k][0]:.5g}")) for key in ("low", "high"))
    assert said[1] == f"tau: {low} to {high} N m" if low != high else said[1].startswith(f"tau: {low}")
    assert said[2].startswith("band of 95 percent: ")
    page.mouse.move(box["x"], box["y"] - 20)
    assert page.locator(".read:visible").count() == 0


def test_time_is_zoomed_in_all_pictures_together(pages: Pages, tabs: Tabs) -> None:
    page = tabs.open(pages["loads"])
    shown = page.locator(".tools output")
    assert shown.inner_text() == "0 to 12 s"

    def boxes() -> set[str]:
        return set(
            page.locator("figure[data-kind=time] svg.plot").evaluate_all(
                "all => all.map(x => x.getAttribute('viewBox'))"
            )
        )

    [whole] = boxes()
    page.get_by_role("button", name="Zoom in").click()
    assert shown.inner_text() == "2.999 to 8.998 s" and len(boxes()) == 1 and boxes() != {whole}
    page.get_by_role("button", name="Later").click()
    assert shown.inner_text() == "5.998 to 12 s"
    page.get_by_role("button", name="All").click()
    assert boxes() == {whole}
    box = page.locator("figure[data-kind=time] svg.chart").first.bounding_box()
    y = box["y"] + 0.5 * box["height"]
    page.mouse.move(box["x"] + 0.3 * box["width"], y)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], y, steps=3)
    page.mouse.up()
    low, high = (float(x) for x in re.findall(r"[\d.]+", shown.inner_text()))
    assert 0.0 < low < high < 12.0 and high - low == pytest.approx(12.0 * 0.2 * 480 / 408, rel=0.02)
    page.mouse.dblclick(box["x"] + 0.5 * box["width"], y)
    assert boxes() == {whole}


def test_a_series_can_be_hidden(pages: Pages, tabs: Tabs) -> None:
    page = tabs.open(pages["loads"])
    figure = page.locator("figure[data-kind=time]").first
    line, button = figure.locator("[data-series='0']"), figure.get_by_role("button", name="tau", exact=True)
    for hidden in (True, False):
        button.click()
        assert (button.get_attribute("aria-pressed") == "false") == hidden
        assert (line.evaluate("x => x.style.display") == "none") == hidden


def test_the_keyboard_reaches_every_control(pages: Pages, tabs: Tabs) -> None:
    page = tabs.open(pages["loads"])
    wanted = page.locator("a, button, svg[tabindex], [role=region]").count()
    reached = set()
    for _ in range(wanted):
        page.keyboard.press("Tab")
        reached.add(page.evaluate("[...document.querySelectorAll('*')].indexOf(document.activeElement)"))
    assert len(reached) == wanted
    page.locator("figure[data-kind=time] svg.chart").first.focus()
    page.keyboard.press("ArrowRight")
    first = page.locator(".read:visible").inner_text()
    page.keyboard.press("ArrowRight")
    assert page.locator(".read:visible").inner_text() != first
    page.keyboard.press("Escape")
    assert page.locator(".read:visible").count() == 0
    page.get_by_role("button", name="Zoom in").focus()
    page.keyboard.press("Enter")
    assert page.locator(".tools output").inner_text() != "0 to 12 s"
