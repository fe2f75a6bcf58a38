"""The HTML pages of `diagnose` and `compare`: whole, alone, and with names that are only names."""

from __future__ import annotations

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from lxml import html

from rttrr_pin import compare_robots, load
from rttrr_pin.diagnosis import NearMiss, diagnose, diagnose_log
from rttrr_pin.diagnosis.pages import write_page
from rttrr_pin.reporting.html import by_decades, of_longest
from support.implementations import still
from support.logs import write_log

ODD = "<b>&'\"{{ 7 * 7 }}<script>x</script>" + "y" * 200
"""A name of a joint."""

KINDS = ("explained", "unexplained", "log", "comparison")


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    folder = tmp_path_factory.mktemp("pages")
    text = load("trr").model.urdf
    escaped = ODD.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    odd = load(text.replace('"joint_1"', f'"{escaped}"'))
    write_log(folder / "log.csv", odd, rate=200.0, seconds=2.0, offset=5.0)
    explained = diagnose(odd, still, n_states=20)
    near = (NearMiss(f"{ODD} has viscous friction", 0.3),)
    results = {
        "explained": explained,
        "unexplained": replace(explained, verdict="unexplained", causes=(), dependence=("at rest",), near_misses=near),
        "log": diagnose_log(odd, folder / "log.csv"),
        "comparison": compare_robots(odd, load(text.replace("3.", "4.")), n_states=20),
    }
    assert set(results) == set(KINDS)
    for name, result in results.items():
        write_page(str(folder / f"{name}.html"), result)
    return {name: (folder / f"{name}.html").read_text(encoding="utf-8") for name in results}


@pytest.mark.parametrize("kind", KINDS)
def test_nothing_is_run_or_loaded(kind: str, pages: dict[str, str]) -> None:
    text, page = pages[kind], html.fromstring(pages[kind])
    assert (
        page.xpath("//script | //link | //img | //iframe | //@src | //@href[not(starts-with(., '#'))] | //@onclick")
        == []
    )
    assert "url(" not in text and "@import" not in text
    assert text.startswith("<!doctype html>") and text.endswith("</html>\n")


@pytest.mark.parametrize("kind", KINDS)
def test_names_are_only_names(kind: str, pages: dict[str, str]) -> None:
    page = html.fromstring(pages[kind])
    assert page.xpath("//b") == [] and "49" not in re.findall(r"&'\"(.*?)<", page.text_content())
    assert ODD in page.text_content()


@pytest.mark.parametrize("kind", KINDS)
def test_each_row_of_a_table_has_its_bar(kind: str, pages: dict[str, str]) -> None:
    page = html.fromstring(pages[kind])
    tables = page.xpath("//table")
    assert tables
    for table in tables:
        columns = len(table.xpath(".//thead/tr/*"))
        for row in table.xpath(".//tbody/tr"):
            assert len(row.xpath("./td")) == columns and len(row.xpath(".//svg/title/text()")) == 1
            assert all(0.0 <= float(width) <= 100.0 for width in row.xpath(".//rect/@width"))


def test_a_diagnosis_shows_its_cause_repair_and_test(pages: dict[str, str]) -> None:
    explained, unexplained = (html.fromstring(pages[name]) for name in ("explained", "unexplained"))
    assert len(explained.xpath("//section//p[@class='sentence']")) >= 1
    assert "repair:" in explained.xpath("string(//section)")
    assert unexplained.xpath("//section") == [] and "What the difference depends on" in unexplained.text_content()
    for page in (explained, unexplained):
        [code] = page.xpath("//pre/text()")
        compile(code, "test", "exec")
        assert code.lstrip().startswith("def test_")


def test_bars_grow_with_what_they_show() -> None:
    assert of_longest([0.0, 1.0, 2.0, np.nan]) == [0.0, 50.0, 100.0, 0.0]
    assert of_longest([0.0, 0.0]) == [0.0, 0.0] and of_longest([]) == []
    lengths, one = by_decades([0.0, 1.0, 1e12, np.inf])
    assert lengths == sorted(lengths) and lengths[0] == 0.0 and lengths[1] == one and lengths[-1] == 100.0
    assert by_decades([0.5]) == ([by_decades([0.5])[0][0]], 100.0)


def test_pages_cost_nothing_where_none_is_asked_for(tmp_path: Path) -> None:
    """jinja2 is loaded for a page, and only then."""
    code = """
import sys
from rttrr_pin.cli import main
words = ["compare", "trr", "trr", "--states", "5", "-q"]
assert main(words) == 0 and "jinja2" not in sys.modules
assert main([*words, "--html", sys.argv[1]]) == 0 and "jinja2" in sys.modules
"""
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "out.html")], check=True)
    assert [path.name for path in tmp_path.iterdir()] == ["out.html"]
