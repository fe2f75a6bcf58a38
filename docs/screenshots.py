"""Take the pictures of the viewer that the documents show, in headless Chromium.

`python docs/screenshots.py` writes docs/figures/view_*.png, each below 150 kB. It needs the extras `browser` and
`robots`.
"""

from __future__ import annotations

import io
import shutil
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import Browser, sync_playwright

import rttrr_pin
from rttrr_pin import Evaluation, Robot
from rttrr_pin.trajectories import trajectory
from rttrr_pin.viewing.run import prepared, state_of
from rttrr_pin.viewing.viewer import Viewer

FIGURES = Path(__file__).parent / "figures"
LARGEST = 150_000
"""Bytes of a picture."""

SIZE = (1280, 720)
SETTLING = 9000
"""Milliseconds until a scene has faded in and is drawn, without a graphics card."""


@contextmanager
def served(robot: Robot, **arguments: Any) -> Iterator[Viewer]:
    """A viewer that runs in a thread."""
    viewer = Viewer(prepared(robot, **arguments))
    thread = threading.Thread(target=viewer.run)
    thread.start()
    try:
        yield viewer
    finally:
        viewer.close()
        thread.join()


def show(viewer: Viewer, *things: str, hide: tuple[str, ...] = (), **look: Any) -> None:
    """Check some boxes, and set other controls."""
    for thing, handle in viewer.panel.shown.items():
        handle.value = (handle.value or thing in things) and thing not in hide
    for name, value in look.items():
        getattr(viewer.panel, name).value = value
    viewer.panel.touched.put(("show", 0))


def moving_arm(browser: Browser) -> None:
    """The bundled arm in the worst state of a motion."""
    robot = rttrr_pin.load("rttrr")
    time = np.arange(0.0, 4.0, 0.01)
    size, w = np.array([1.2, 0.15, 0.15, 0.9, 0.9]), np.array([1.5, 2.0, 1.3, 2.2, 2.0])
    q = size * np.sin(w * time[:, None]) + [0.0, 0.0, 0.15, 0.0, 0.0]
    motion = trajectory(robot, time, q, name="motion.csv")
    with served(robot, trajectory=motion) as viewer:
        viewer.jump_to_worst()
        show(viewer, "F", opacity=0.35)
        save(browser, viewer, "view_arm")


def bodies(browser: Browser) -> None:
    """Inertia ellipsoids and link frames of Panda."""
    robot = rttrr_pin.load("example:panda")
    state = state_of(robot, q=[0.4, -0.5, 0.0, -2.2, 0.0, 1.8, 0.6, 0.03])
    with served(robot, state=state) as viewer:
        show(viewer, "inertia ellipsoids", "link frames", hide=("f", "n"), opacity=0.2)
        save(browser, viewer, "view_bodies", tab="Show")


def difference(browser: Browser) -> None:
    """Two programs, one of which leaves the products of inertia of a link out: the arrows are their difference."""
    robot = rttrr_pin.load("rttrr")
    links = list(robot.model.links)
    links[2] = replace(links[2], inertia=np.diag(np.diag(links[2].inertia)))
    wrong = Robot(replace(robot.model, links=tuple(links), document=None))

    class Ported:
        name, version, quantities = "my_port", "", ("tau", "F", "N", "f", "n")

        def evaluate(self, batch: Any) -> Any:
            return Evaluation(dict(wrong.inverse_dynamics(batch.q, batch.v, batch.a).items()))

    with served(robot, subject=Ported()) as viewer:
        viewer.jump_to_worst()
        show(viewer, "F", "N", opacity=0.35)
        viewer.panel.touched.put(("fit", 0))
        save(browser, viewer, "view_difference")


def save(browser: Browser, viewer: Viewer, name: str, tab: str = "") -> None:
    """Take the picture."""
    page = browser.new_page(viewport={"width": SIZE[0], "height": SIZE[1]}, reduced_motion="reduce")
    page.goto(viewer.address)
    page.wait_for_selector(".rp table")
    if tab:
        page.get_by_role("tab", name=tab).click()
    page.wait_for_timeout(SETTLING)
    page.evaluate("document.querySelectorAll('.mantine-Notification-closeButton').forEach(own => own.click())")
    page.wait_for_timeout(SETTLING)
    picture = Image.open(io.BytesIO(page.screenshot(timeout=200_000))).convert("RGB")
    page.close()
    path = FIGURES / f"{name}.png"
    for colours in (256, 128, 64, 32):
        picture.quantize(colours, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE).save(path, optimize=True)
        if path.stat().st_size <= LARGEST:
            break
    print(f"{path}: {path.stat().st_size:,} bytes")


PICTURES: dict[str, Callable[[Browser], None]] = {"arm": moving_arm, "bodies": bodies, "difference": difference}


def main(names: list[str]) -> None:
    """Take all, or those that are named."""
    program = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=program, args=["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        )
        for name in names or PICTURES:
            PICTURES[name](browser)
        browser.close()


if __name__ == "__main__":
    main(sys.argv[1:])
