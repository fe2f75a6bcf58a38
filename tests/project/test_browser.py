"""The browser of the tests sees what it is to see."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from support.browser import Tabs, grave_findings, overflow, stays_here

pytestmark = pytest.mark.browser


def page_of(folder: Path, body: str) -> Path:
    path = folder / "page.html"
    path.write_text(f'<!doctype html><html lang="en"><head><title>t</title></head><body>{body}</body></html>')
    return path


def test_a_quiet_page_has_no_faults(tmp_path: Path, tabs: Tabs) -> None:
    page = tabs.open(page_of(tmp_path, "<main><h1>one</h1><script>document.title = 'two'</script></main>"))
    assert page.title() == "two"
    assert grave_findings(page) == []
    assert overflow(page) == 0


@pytest.mark.parametrize(
    ("body", "fault"),
    [
        ("<script>console.error('no')</script>", "console: no"),
        ("<script>throw new Error('no')</script>", "uncaught: no"),
        ("<img src='https://example.org/a.png' alt=''>", "network: https://example.org/a.png"),
        ("<link rel=stylesheet href='https://example.org/a.css'>", "network: https://example.org/a.css"),
        ("<script>new WebSocket('ws://192.0.2.1:9/')</script>", "network: ws://192.0.2.1:9/"),
        ("<script>fetch('http://192.0.2.1/').catch(() => 0)</script>", "network: http://192.0.2.1/"),
    ],
)
def test_faults_are_seen(tmp_path: Path, chromium: Any, body: str, fault: str) -> None:
    tabs = Tabs(chromium)
    tabs.open(page_of(tmp_path, body)).wait_for_timeout(100)
    tabs.close()
    assert fault in tabs.faults


def test_what_cannot_be_read_and_what_is_too_wide_is_found(tmp_path: Path, tabs: Tabs) -> None:
    page = tabs.open(page_of(tmp_path, "<main><p style='color:#ccc;width:2000px'>pale</p></main>"), width=390)
    assert [finding.partition(":")[0] for finding in grave_findings(page)] == ["color-contrast"]
    assert overflow(page) > 1000


def test_loopback_is_all_there_is() -> None:
    assert all(map(stays_here, ["file:///a", "data:,a", "http://127.0.0.1:80/", "ws://localhost:1/", "http://[::1]/"]))
    assert not any(
        map(stays_here, ["http://127.0.0.1.example.org/", "https://example.org", "ftp://localhost/", "file://host/a"])
    )
