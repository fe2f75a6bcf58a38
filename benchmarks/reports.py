"""Claim: a report of 100,000 rows of loads is below 2 MB, and can be used within 2 s in Chromium.

Usable: a pointer over the first picture over time is answered with its numbers, from the call that opens the file on.
Run: python benchmarks/reports.py [--repeats N] [--save]. Needs the extra browser, and Chromium. Exit 1 if either fails.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from common import arguments, finish
from rttrr_pin import compute_loads, load
from rttrr_pin.loads.page import loads_page
from rttrr_pin.reporting.html import html
from rttrr_pin.trajectories import trajectory

ROWS = 100_000

LARGEST, SLOWEST = 2_000_000, 2.0
"""Bytes; seconds."""

ROBOTS = ("rttrr", "example:panda", "example:talos_reduced")


def page_of(robot: str) -> str:
    """The report of sines in every joint, with derived v and a, so that there are bands."""
    loaded = load(robot)
    t, rng = np.arange(ROWS) / 1000.0, np.random.default_rng(0)
    rates = 0.5 + 0.1 * np.arange(loaded.model.nv)
    q = 0.3 * np.sin(rates * t[:, None] + np.arange(loaded.model.nv)) + 1e-5 * rng.normal(size=(ROWS, loaded.model.nv))
    report = compute_loads(loaded, trajectory(loaded, t, q))
    return html(loads_page(report, loaded))


def seconds_until_usable(path: Path, repeats: int) -> list[float]:
    """From opening it to its first answer, in a fresh tab each time."""
    from playwright.sync_api import sync_playwright

    program = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))))
    found = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=program)
        for _ in range(repeats + 1):
            page = browser.new_page()
            start = time.perf_counter()
            page.goto(path.as_uri())
            chart = page.locator("figure[data-kind=time] svg.chart").first
            chart.scroll_into_view_if_needed()
            box = chart.bounding_box()
            page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
            page.wait_for_selector(".read:visible")
            found.append(time.perf_counter() - start)
            page.close()
        browser.close()
    return found[1:]  # the first one starts the browser's own processes


def main() -> int:
    parser = arguments(__doc__ or "")
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--robots", nargs="*", default=ROBOTS)
    chosen = parser.parse_args()
    rows = []
    for robot in chosen.robots:
        text = page_of(robot)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "loads.html"
            path.write_text(text, encoding="utf-8")
            times = seconds_until_usable(path, chosen.repeats)
        spread = [round(f(times), 2) for f in (min, statistics.median, max)]
        rows.append({"robot": robot, "rows": ROWS, "bytes": len(text.encode()), "usable_s": spread})
    finish("reports", {"columns": "min, median, max", "rows": rows}, chosen.save)
    return 0 if all(row["bytes"] <= LARGEST and row["usable_s"][1] <= SLOWEST for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
