"""Pages: whole, alone, safe from names, and their pictures as files."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from pathlib import Path

import numpy as np
import pytest
from lxml import html as parser

from rttrr_pin import InputError, load
from rttrr_pin.reporting.html import (
    Bars,
    Causes,
    Code,
    Figures,
    Page,
    Points,
    Rows,
    Said,
    bars,
    html,
    line_chart,
    robot_drawing,
    write_figures,
    write_page,
)
from rttrr_pin.urdf.files import note_read

ODD = "</title></script><!--<b onclick=x>&'\"{{ 7 * 7 }}<script>alert(1)</script>\x1b"

X = np.linspace(0.0, 1.0, 5)


def page_of(name: str) -> Page:
    time = line_chart("time", name, X, {name: X}, "time [s]", name)
    blocks = (
        Causes((Said(name, ((name, name),), (name,), "bad", name), Said(name)), name, name),
        Figures(name, (time, bars("b", name, {name: 1.0}, name), robot_drawing(load("trr").model, title=name)), name),
        Rows(name, (name, ""), (Bars((name, name), 10.0, None, name, "bad"), Bars((name, ""))), name, one=50.0),
        Points(name, (name,)),
        Code(name, name),
    )
    return Page(name, name, name, "agrees", name, blocks, ((name, name),), (name,), "validate")


def test_names_are_only_names() -> None:
    text = html(page_of(ODD))
    page = parser.fromstring(text)
    assert page.xpath("//b | //@onclick | //iframe | //img | //link | //comment()") == []
    scripts = page.xpath("//script")
    assert [one.get("type") for one in scripts] == ["application/json", None] and "alert" not in scripts[1].text
    assert not set("<>&") & set(scripts[0].text)
    assert json.loads(scripts[0].text)["series"][0]["name"] == ODD.replace("\x1b", "?")
    assert "\x1b" not in text and "49" not in page.xpath("string(//h1)")


def test_only_its_own_style_and_script_may_run() -> None:
    page = parser.fromstring(html(page_of("a")))
    [policy] = page.xpath("//meta[@http-equiv]/@content")
    [style], [script] = page.xpath("//style/text()"), page.xpath("//script[not(@type)]/text()")
    digests = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in (style, script)]
    assert policy == f"default-src 'none'; style-src 'sha256-{digests[0]}'; script-src 'sha256-{digests[1]}'"
    assert page.xpath("//@style") == []


def test_a_page_without_numbers_to_read_has_no_script() -> None:
    page = Page("a", "b", "PASS", "agrees", "c", (Figures("f", (bars("b", "b", {"a": 1.0}, "x"),)),))
    assert "<script" not in html(page) and "script-src" not in html(page)


def test_the_parts_of_a_long_page_can_be_gone_to() -> None:
    page = parser.fromstring(html(page_of("a")))
    targets = [href.removeprefix("#") for href in page.xpath("//nav//@href")]
    assert targets and targets == page.xpath("//h2/@id") and len(set(page.xpath("//@id"))) == len(page.xpath("//@id"))
    assert all(len(svg.get("aria-label", "")) > 0 for svg in page.xpath("//svg[@role='img']"))


def test_the_script_is_short() -> None:
    source = Path(__file__).parents[3] / "src/rttrr_pin/reporting/html/templates/page.js"
    assert len(source.read_text().splitlines()) < 200


def test_pictures_are_written_to_a_folder(tmp_path: Path) -> None:
    charts = page_of("a").charts
    files = write_figures(tmp_path / "new" / "folder", charts)
    assert [path.name for path in files] == ["time.svg", "b.svg", "robot.svg"]
    assert all(path.read_text() == chart.file() for path, chart in zip(files, charts, strict=True))


def test_pictures_overwrite_no_input_and_need_a_folder(tmp_path: Path) -> None:
    own = tmp_path / "robot.svg"
    own.write_text("mine")
    note_read(own)
    with pytest.raises(InputError, match="would overwrite the input"):
        write_figures(tmp_path, page_of("a").charts)
    assert own.read_text() == "mine" and sorted(tmp_path.iterdir()) == [own]
    with pytest.raises(InputError, match="choose another folder"):
        write_figures(own, page_of("a").charts)


def test_a_page_is_made_where_one_is_wanted(tmp_path: Path) -> None:
    def never() -> Page:
        raise AssertionError

    write_page(never, None)
    write_page(lambda: page_of("a"), str(tmp_path / "a.html"), tmp_path)
    assert (tmp_path / "a.html").read_text() == html(page_of("a")) and (tmp_path / "b.svg").exists()
    assert not re.search(r"https?://(?!www\.w3\.org)", (tmp_path / "a.html").read_text())
