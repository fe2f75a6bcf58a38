"""The viewer as a person uses it: in Chromium, by its controls, against the API."""

from __future__ import annotations

import re
import threading
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot, Wrench
from rttrr_pin.cli import main
from rttrr_pin.core.payload import loads_of
from rttrr_pin.viewing import view
from rttrr_pin.viewing.numbers import digits
from rttrr_pin.viewing.run import prepared
from rttrr_pin.viewing.states import State
from rttrr_pin.viewing.viewer import Viewer
from support.browser import Tabs
from support.viewed import AWKWARD, MASSLESS, Swing

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.browser

PATIENCE = 30_000
"""Milliseconds: pictures are drawn without a graphics card."""

Served = Callable[..., Viewer]


@pytest.fixture
def served() -> Iterator[Served]:
    """Viewers that run in threads; an exception in one fails the test."""
    running: list[tuple[Viewer, threading.Thread, list[BaseException]]] = []

    def serve(robot: Robot, **arguments: Any) -> Viewer:
        viewer, errors = Viewer(prepared(robot, **arguments)), list[BaseException]()

        def run() -> None:
            try:
                viewer.run()
            except BaseException as error:
                errors.append(error)

        thread = threading.Thread(target=run)
        thread.start()
        running.append((viewer, thread, errors))
        return viewer

    yield serve
    for viewer, thread, errors in running:
        viewer.close()
        thread.join(20.0)
        assert not thread.is_alive() and errors == []


def opened(tabs: Tabs, viewer: Viewer) -> Page:
    page = tabs.open(viewer.address, width=1000, height=500)
    page.set_default_timeout(PATIENCE)
    page.wait_for_selector(".rp table")
    return page


def shown_numbers(page: Page) -> list[list[str]]:
    """The cells of the table of joints."""
    return page.eval_on_selector_all(
        ".rp table >> nth=0", "t => [...t[0].tBodies[0].rows].map(r => [...r.cells].map(c => c.textContent))"
    )


def wait_for(page: Page, text: str) -> None:
    page.wait_for_function("text => document.body.innerText.includes(text)", arg=text)


def until(page: Page, shown: Callable[[], object], wanted: object) -> None:
    """What is shown comes to be what is wanted: a page answers when it has time."""
    for _ in range(PATIENCE // 50):
        if shown() == wanted:
            break
        page.wait_for_timeout(50)
    assert shown() == wanted


def until_numbers(page: Page, wanted: list[str]) -> None:
    """The column of the joints' numbers comes to be the wanted one."""
    until(page, lambda: [row[4] for row in shown_numbers(page)], wanted)


def expected(robot: Robot, state: State) -> list[str]:
    return [digits(x) for x in robot.inverse_dynamics(state.q, state.v, state.a, list(state.loads) or None).tau]


def fill(page: Page, label: str, value: str) -> None:
    """Type into the field beside a slider."""
    words = page.locator("label", has_text=re.compile(f"^{re.escape(label)}$")).first  # has soft breaks in it
    field = words.locator("xpath=ancestor::*[.//input][1]").locator("input.mantine-NumberInput-input")
    field.fill(value)
    field.press("Enter")


def test_a_slider_moves_the_arm_and_its_numbers(tabs: Tabs, served: Served) -> None:
    robot = rttrr_pin.load("rttrr")
    viewer = served(robot)
    page = opened(tabs, viewer)
    until_numbers(page, expected(robot, viewer.state))
    fill(page, "joint_4 [rad]", "0.7")
    state = replace(viewer.state, q=np.array([0, 0, 0, 0.7, 0]))
    until(page, lambda: viewer.state.q.tolist(), state.q.tolist())
    until_numbers(page, expected(robot, state))
    page.get_by_text("Payload: what the robot exerts").click()
    fill(page, "fz [N]", "20")
    loaded = replace(state, loads=loads_of(robot.model, Wrench((0, 0, 20), link="tool", expressed_in="base")))
    until_numbers(page, expected(robot, loaded))
    values = robot.inverse_dynamics(state.q, state.v, state.a, list(loaded.loads)).at("link_1")
    link = page.eval_on_selector_all(
        ".rp table >> nth=1", "t => [...t[0].tBodies[0].rows].map(r => [...r.cells].map(c => c.textContent))"
    )
    for name, *cells in link:
        assert cells[:3] == [digits(x) for x in values[name]]


def test_playing_and_the_worst_state(tabs: Tabs, served: Served) -> None:
    robot = rttrr_pin.load("rttrr")
    swing = Swing(robot, 501)
    viewer = served(robot, trajectory=swing)
    page = opened(tabs, viewer)
    page.get_by_role("button", name="Worst state").click()
    recording = viewer.subject.recording
    assert recording is not None
    k = recording.worst
    wait_for(page, f"{recording.place(k)} of swing")
    tau = [digits(x) for x in robot.inverse_dynamics(swing.q[k], swing.v[k], swing.a[k]).tau]
    until_numbers(page, tau)
    page.get_by_role("button", name="Play").click()
    page.get_by_role("button", name="Pause").wait_for()
    page.wait_for_function("place => !document.body.innerText.includes(place)", arg=f"{recording.place(k)} of swing")
    page.get_by_role("button", name="Pause").click()
    page.get_by_role("button", name="Play").wait_for()
    row = viewer.row
    assert row > k
    wait_for(page, f"{recording.place(row)} of swing")
    tau = [digits(x) for x in robot.inverse_dynamics(swing.q[row], swing.v[row], swing.a[row]).tau]
    until_numbers(page, tau)


def test_two_programs_and_a_program_that_refuses(tabs: Tabs, served: Served) -> None:
    robot = rttrr_pin.load("rttrr")

    def wrong(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
        if np.abs(q).max() == 0.7:
            raise ArithmeticError("<b>no</b>")
        return robot.inverse_dynamics(q, v, a).tau * 1.5

    viewer = served(robot, subject=wrong)
    page = opened(tabs, viewer)
    page.get_by_role("button", name="All zero").click()
    wait_for(page, "a state of your own")
    ours = robot.inverse_dynamics(viewer.state.q, viewer.state.v, viewer.state.a).tau
    assert [row[2:5] for row in shown_numbers(page)] == [
        [digits(1.5 * x), digits(x), digits(1.5 * x - x)] for x in ours
    ]
    fill(page, "joint_4 [rad]", "0.7")
    wait_for(page, "error: ")
    wait_for(page, "<b>no</b>")
    fill(page, "joint_4 [rad]", "0.6")
    page.wait_for_selector(".rp table")


@pytest.mark.parametrize("source", [AWKWARD, MASSLESS])
def test_names_are_no_markup_and_awkward_numbers_are_drawn(tabs: Tabs, served: Served, source: str) -> None:
    viewer = served(rttrr_pin.load(source, base="floating"))
    page = opened(tabs, viewer)
    for thing in ("inertia ellipsoids", "link frames", "F", "N", "names"):
        viewer.panel.shown[thing].value = True
    viewer.panel.touched.put(("show", 0))
    page.wait_for_timeout(1500)
    assert page.locator("#root img[src=x]").count() == 0
    assert page.locator("canvas").count() > 0
    if source is AWKWARD:
        wait_for(page, "<img src=x onerror=alert(1)>")
        assert "no body has the inertia of impossible" in page.inner_text("body")


def test_a_page_of_its_own_opens_offline(tabs: Tabs, tmp_path: Path) -> None:
    """A state, with its numbers in words."""
    target = tmp_path / "arm.html"
    (tmp_path / "awkward.urdf").write_text(AWKWARD)
    assert main(["view", str(tmp_path / "awkward.urdf"), "--q", "0.5,1,0", "--html", str(target)]) == 0
    page = tabs.open(target, width=900, height=500)
    page.wait_for_selector("canvas", timeout=PATIENCE)
    robot = rttrr_pin.load(AWKWARD)
    tau = robot.inverse_dynamics([0.5, 1.0, 0.0], [0, 0, 0], [0, 0, 0]).tau
    assert [row[4] for row in shown_numbers(page)] == [digits(x) for x in tau]
    assert page.title() == "awkward: forces and moments"
    assert page.locator("aside img").count() == 0 and "<img src=x" in page.locator("aside").text_content()


def test_a_trajectory_plays_in_its_page(tabs: Tabs, tmp_path: Path) -> None:
    robot = rttrr_pin.load("rttrr")
    swing = Swing(robot, 201)
    target = tmp_path / "swing.html"
    view(robot, swing, html=target)
    page = tabs.open(target, width=900, height=500)
    page.wait_for_selector("canvas", timeout=PATIENCE)
    page.wait_for_function("!document.querySelector('#rttrr-place').textContent.startsWith('row 2,')", timeout=PATIENCE)
    page.keyboard.press("Space")
    page.wait_for_timeout(500)
    row = int(str(page.locator("#rttrr-place").text_content()).split()[1].rstrip(",")) - 2
    tau = robot.inverse_dynamics(swing.q[row], swing.v[row], swing.a[row]).tau
    assert [cells[4] for cells in shown_numbers(page)] == [digits(x) for x in tau]
    assert target.stat().st_size < 2**21
