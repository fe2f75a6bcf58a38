"""The robot's drawing: every link at its place, names apart, and forces along their directions."""

from __future__ import annotations

import re
from itertools import combinations

import numpy as np
import pytest
from lxml import etree

from rttrr_pin import Robot, load
from rttrr_pin.core.placements import in_base
from rttrr_pin.reporting.html import robot_drawing
from rttrr_pin.reporting.html.labels import LETTER, LINE, placed
from rttrr_pin.validation import Sampler
from support.trees import random_tree

ODD = "<b>&amp;</svg><script>x</script>" + "y" * 100


def drawn(robot: Robot, seed: int = 0, **more: object) -> tuple[etree._Element, np.ndarray]:
    batch = Sampler(robot.model, "uniform", seed).draw(0, 1)
    return etree.fromstring(str(robot_drawing(robot.model, batch.q[0], **more).svg)), batch.q


@pytest.mark.parametrize("seed", range(6))
def test_every_link_is_at_its_place(seed: int) -> None:
    robot = load(random_tree(seed, 2 + 7 * seed))
    root, q = drawn(robot, seed)
    told = dict(re.fullmatch(r"(.*), at (.*) m", x).groups() for x in root.xpath("//title/text()"))
    _, p = in_base(robot.model, q)
    assert set(told) == {robot.model.root.name, *robot.link_names}
    for name, place in zip(robot.link_names, p[0], strict=True):
        np.testing.assert_allclose([float(x) for x in told[name].split(", ")], place, rtol=1e-3, atol=1e-9)


def signs(root: etree._Element) -> np.ndarray:
    """The places of joints in the picture, in the order of drawing."""
    return np.array([[float(x.get("cx")), float(x.get("cy"))] for x in root.xpath("//*[local-name()='circle'][*]")])


@pytest.mark.parametrize("seed", range(4))
def test_it_stays_inside_the_picture(seed: int) -> None:
    root, _ = drawn(load(random_tree(seed, 20)), seed)
    places = signs(root)
    assert (places >= 0.0).all() and (places[:, 0] <= 480.0).all() and (places[:, 1] <= 400.0).all()


def test_names_that_are_drawn_do_not_cover_each_other_and_what_is_marked_is_named() -> None:
    robot = load(random_tree(10, 60))
    marked = robot.link_names[30:33]
    root, _ = drawn(robot, marked=marked)
    boxes = []
    for text in root.xpath("//*[contains(@class, 'halo')]"):
        width, x, y = LETTER * len(text.text), float(text.get("x")), float(text.get("y"))
        left = x - width if "end" in text.get("class") else x
        boxes.append((text.text, left, y - LINE + 3.5, left + width, y + 3.5))
    assert set(marked) <= {box[0] for box in boxes} and 5 <= len(boxes) <= 40
    for a, b in combinations(boxes, 2):
        wide, tall = min(a[3], b[3]) - max(a[1], b[1]), min(a[4], b[4]) - max(a[2], b[2])
        assert wide <= 0.5 or tall <= 0.5 or {a[0], b[0]} & set(marked), (a, b)


def test_a_joint_is_marked_by_its_link(rttrr: Robot) -> None:
    root, _ = drawn(rttrr, marked=["joint_3"])
    assert root.xpath("//*[contains(@class, 'halo') and contains(@class, 'marked')]/text()") == ["link_3"]


def test_the_largest_force_is_drawn_and_small_ones_are_not(rttrr: Robot) -> None:
    forces = np.zeros((6, 3))
    forces[2], forces[3], forces[4] = (0, 0, 100.0), (0, 0, 1.0), np.nan
    root, _ = drawn(rttrr, wrenches=forces)
    assert len(root.xpath("//*[@class='force']")) == 1
    assert drawn(rttrr, wrenches=np.zeros((6, 3)))[0].xpath("//*[@class='force']") == []


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_robots_of_any_size(scale: float) -> None:
    text = re.sub(
        r'(<origin xyz=")([^"]*)"',
        lambda m: m[1] + " ".join(f"{scale * float(x):.9g}" for x in m[2].split()) + '"',
        random_tree(3, 5),
    )
    root, _ = drawn(load(text))
    places = signs(root)
    assert np.isfinite(places).all() and np.ptp(places, axis=0).max() > 100.0


def test_links_at_one_place_and_a_name_that_is_only_a_name() -> None:
    robot = load(
        f'<robot name="r"><link name="base"/><link name="{ODD}"/>'.replace("<b>", "&lt;b&gt;")
        .replace("</svg><script>", "&lt;/svg&gt;&lt;script&gt;")
        .replace("</script>", "&lt;/script&gt;")
        + '<joint name="j" type="fixed"><parent link="base"/><child link="'
        + robot_name()
        + '"/></joint></robot>'
    )
    chart = robot_drawing(robot.model)
    assert {etree.QName(x).localname for x in etree.fromstring(str(chart.svg)).iter()} <= {
        "svg",
        "g",
        "line",
        "text",
        "path",
        "rect",
        "circle",
        "title",
    }
    assert "is fixed to base" in chart.text


def robot_name() -> str:
    return "&lt;b&gt;&amp;&lt;/svg&gt;&lt;script&gt;x&lt;/script&gt;" + "y" * 100


def test_names_get_other_places_where_one_is_taken() -> None:
    names = [(f"name_{k}", 200.0, 200.0, False, False) for k in range(6)]
    found = list(placed(names, [], (0, 0, 480, 400)))
    assert len({(own.x, own.y) for own in found}) == len(found) >= 4
