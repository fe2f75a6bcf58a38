"""Pages opened in headless Chromium, as a reader would: no network but this machine's, and no error on the console."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import pytest

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page, Route

NAMES = ("chromium", "chromium-browser", "google-chrome")

ARGUMENTS = (
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE localhost, EXCLUDE 127.0.0.1, EXCLUDE [::1]",
    "--enable-unsafe-swiftshader",  # WebGL without a graphics card
    "--use-angle=swiftshader",
)

OFFLINE = ("file", "data", "blob", "about", "chrome-error")

LOOPBACK = ("127.0.0.1", "localhost", "::1")

GRAVE = ("serious", "critical")
"""What of axe's findings keeps people from reading a page."""


def stays_here(url: str) -> bool:
    """Whether nothing of it leaves this machine."""
    parts = urlsplit(url)
    return (parts.scheme in OFFLINE and not parts.netloc) or (
        parts.scheme in ("http", "https", "ws", "wss") and parts.hostname in LOOPBACK
    )


class Tabs:
    """Opens pages, and gathers what was wrong with them.

    Attributes:
        faults: errors on the console, exceptions that no script caught, requests that would leave this machine.
    """

    def __init__(self, browser: Browser) -> None:
        self.browser = browser
        self.faults: list[str] = []
        self._contexts: list[BrowserContext] = []

    def open(
        self,
        where: Path | str,
        *,
        dark: bool = False,
        width: int = 1280,
        height: int = 900,
        javascript: bool = True,
        wait_until: Any = "load",
    ) -> Page:
        """A file or an address in a tab of its own, with a profile of its own."""
        context = self.browser.new_context(
            viewport={"width": width, "height": height},
            color_scheme="dark" if dark else "light",
            reduced_motion="reduce",
            java_script_enabled=javascript,
            locale="en-GB",
        )
        self._contexts.append(context)
        context.route("**/*", self._route)
        page = context.new_page()
        page.on("console", lambda message: self._fault(f"console: {message.text}", message.type == "error"))
        page.on("pageerror", lambda error: self._fault(f"uncaught: {error}"))
        page.on("websocket", lambda socket: self._fault(f"network: {socket.url}", not stays_here(socket.url)))
        page.goto(where.resolve().as_uri() if isinstance(where, Path) else where, wait_until=wait_until)
        return page

    def close(self) -> None:
        for context in self._contexts:
            context.close()
        self._contexts.clear()

    def _route(self, route: Route) -> None:
        if stays_here(route.request.url):
            route.continue_()
        else:
            self._fault(f"network: {route.request.url}")
            route.abort()

    def _fault(self, text: str, counts: bool = True) -> None:
        if counts:
            self.faults.append(text)


def grave_findings(page: Page, **options: Any) -> list[str]:
    """What axe finds in a page that is serious or critical: rule, what is wrong, and where."""
    from axe_playwright_python.sync_playwright import Axe

    found = Axe().run(page, options={"resultTypes": ["violations"]} | options)
    return [
        f"{rule['id']}: {rule['help']}: {node['target']}: {node.get('failureSummary', '')}"
        for rule in found.response["violations"]
        if rule["impact"] in GRAVE
        for node in rule["nodes"]
    ]


def overflow(page: Page) -> int:
    """How many pixels a page is wider than its window: what a reader would have to scroll sideways."""
    return int(page.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth"))


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    """A browser for all tests of a worker; one that is not there is an error, since `-m browser` asked for it."""
    from playwright.sync_api import sync_playwright

    program = next(filter(None, map(shutil.which, NAMES)), None)
    if program is None:
        pytest.fail(
            f"no {', '.join(NAMES)} on PATH: install one (Debian: apt install chromium), or leave out -m browser"
        )
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program, args=list(ARGUMENTS))
        yield browser
        with suppress(Exception):  # it may have been closed
            browser.close()


@pytest.fixture
def tabs(chromium: Browser) -> Iterator[Tabs]:
    """Opens pages: `tabs.open(path)`; what was wrong with any of them fails the test."""
    tabs = Tabs(chromium)
    yield tabs
    tabs.close()
    assert tabs.faults == []
