"""What is written of a program's way through the levels: text, JUnit, a page, a badge."""

from __future__ import annotations

import io
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from lxml import html
from rich.console import Console

from rttrr_pin import InputError
from rttrr_pin.conformance import LEVELS, Conformance, LevelResult, conform
from rttrr_pin.conformance.badge import GREEN, RED, YELLOW, badge, colour
from rttrr_pin.conformance.junit import junit
from rttrr_pin.conformance.page import conformance_page
from rttrr_pin.conformance.report import show_conformance
from rttrr_pin.reporting.html import html as html_of
from support.planted_levels import PLANTED

ODD = 'my <lib> & "co" {{ 7 * 7 }}\x1b[31m'
"""A name of a program."""


@pytest.fixture(scope="module")
def failing() -> Conformance:
    """All outcomes there are."""
    result = conform(PLANTED["no rates"][0], levels=["gravity", "rates", "payload"], n_states=4, diagnose=False)
    gravity, rates, payload = result.results
    refused = replace(payload, outcome="not offered", quantities=(), message="no <payloads>")
    crashed = LevelResult("tree", "tree", "error", 4, message="boom")
    odd = replace(rates, cause="rates are not <counted>")
    return replace(result, subject=ODD, results=(gravity, odd, refused, crashed))


def perfect(result: Conformance) -> Conformance:
    own = result.results[0]
    every = tuple(replace(own, level=level.id) for level in LEVELS)
    return replace(result, results=every)


def text(result: Conformance, width: int = 80, **how: Any) -> str:
    console = Console(file=io.StringIO(), width=width)
    show_conformance(result, console, **how)
    return console.file.getvalue()  # type: ignore[attr-defined]


def test_the_levels_stand_in_the_docs() -> None:
    page = (Path(__file__).parents[2] / "docs/conform.md").read_text()
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in page.splitlines() if re.match(r"\| \d", line)]
    assert rows == [[str(x.number), f"`{x.id}`", x.sentence, ", ".join(x.robots)] for x in LEVELS]


def test_text_has_a_line_for_each_case_and_why(failing: Conformance) -> None:
    shown = text(failing)
    rows = [line for line in shown.splitlines() if line[:2].strip().isdigit()]
    assert [row.split()[1].strip(",") for row in rows] == ["gravity", "rates", "payload", "tree"]
    assert "PASS" in rows[0] and "FAIL" in rows[1] and "not offered" in rows[2] and "ERROR" in rows[3]
    assert "fails: rates are not <counted> (rates-arm6)" in shown
    assert "not offered: no <payloads> (payload-arm6)" in shown and "error: boom (tree-tree)" in shown
    assert f"FAIL {failing.claim()} (" in shown


def test_the_table_fits_a_terminal(failing: Conformance) -> None:
    table = text(perfect(failing)).split("eps: the worst")[0]
    lines = table.splitlines()
    assert len(lines) == 2 + len(LEVELS) and max(map(len, lines)) <= 80


def test_full_text_counts_every_number(failing: Conformance) -> None:
    shown = text(failing, full=True)
    assert "gravity-arm6, errors in eps:" in shown and "beyond" in shown
    assert "tree-tree, errors" not in shown


def test_junit_has_a_test_for_each_case(failing: Conformance) -> None:
    suite = ElementTree.fromstring(junit(failing)).find("testsuite")
    assert suite is not None
    assert [own.get("name") for own in suite] == [own.id for own in failing.results]
    counts = {key: suite.get(key) for key in ("tests", "failures", "errors", "skipped")}
    assert counts == {"tests": "4", "failures": "1", "errors": "1", "skipped": "1"}
    failure, skipped = suite.find("testcase/failure"), suite.find("testcase/skipped")
    assert failure is not None and failure.get("message") == "rates are not <counted>"
    assert skipped is not None and skipped.get("type") is None and skipped.get("message") == "no <payloads>"


def test_the_page_is_whole_and_names_are_only_names(failing: Conformance) -> None:
    written = html_of(conformance_page(failing))
    page = html.fromstring(written)
    assert (
        page.xpath("//script | //link | //img | //iframe | //@src | //@href[not(starts-with(., '#'))] | //@onclick")
        == []
    )
    assert page.xpath("//lib | //counted | //payloads") == [] and "49" not in page.xpath("//h1")[0].text_content()
    assert "\x1b" not in written
    text = page.text_content()
    assert all(own.level in text for own in failing.results) and "rates are not <counted>" in text


def test_a_badge_says_no_more_than_the_claim(failing: Conformance) -> None:
    data = json.loads(badge(failing, "badge.json"))
    assert data == {"schemaVersion": 1, "label": "rttrr-pin", "message": failing.claim(4), "color": RED}
    assert "not offered: payload" in data["message"] and "failed: rates, tree" in data["message"]
    picture = ElementTree.fromstring(badge(failing, "badge.svg"))
    texts = [own.text for own in picture.iter("{http://www.w3.org/2000/svg}text")]
    assert texts == ["rttrr-pin", failing.claim(4)]


def test_colours_of_a_badge(failing: Conformance) -> None:
    whole = perfect(failing)
    assert json.loads(badge(whole, "b.json"))["message"] == "14 of 14" and colour(whole) == GREEN
    single = replace(whole, precision="float32")
    assert single.claim() == "14 of 14 in float32"
    some = replace(single, printed=1, results=single.results[:2])
    assert some.claim(4) == "level 2 of 14 (rates) in float32 at 1 digit; not asked: 12 levels"
    assert colour(replace(whole, results=whole.results[:13])) == YELLOW
    assert colour(failing) == RED


def test_a_badge_has_two_forms(failing: Conformance) -> None:
    assert badge(failing, "-").startswith("<svg")
    with pytest.raises(InputError, match=r"expected the name of a \.svg or \.json"):
        badge(failing, "badge.png")
