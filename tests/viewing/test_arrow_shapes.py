"""Arrows as they are drawn: where they begin and end, and how long a newton is."""

from __future__ import annotations

import numpy as np
import pytest

from rttrr_pin.viewing.arrow_shapes import ball, cone, cylinder, fitting, heads, rung, rung_of, shafts, sticks, tips
from rttrr_pin.viewing.scene import Arrows
from support.tolerances import MODEL

RNG = np.random.default_rng(0)
SOME = Arrows(RNG.normal(size=(40, 3)), RNG.normal(size=(40, 3)) * 10.0 ** RNG.uniform(-6, 2, (40, 1)))
ALONG = Arrows(
    np.zeros((7, 3)), np.array([[0, 0, 1], [0, 0, -1], [1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, 0, 0], [1e-12, 0, -1.0]])
)


def turned(wxyz: np.ndarray, vector: np.ndarray) -> np.ndarray:
    w, r = wxyz[:, :1], wxyz[:, 1:]
    return vector + 2.0 * np.cross(r, np.cross(r, vector) + w * vector)


def ends(own: object) -> tuple[np.ndarray, np.ndarray]:
    """Where copies of a solid begin and end."""
    up = np.zeros_like(own.position) + [0.0, 0.0, 1.0]  # type: ignore[attr-defined]
    return own.position, own.position + turned(own.wxyz, up) * own.scale[:, 2:]  # type: ignore[attr-defined]


@pytest.mark.parametrize("arrows", [SOME, ALONG])
@pytest.mark.parametrize("double", [False, True])
def test_shaft_and_head_make_an_arrow(arrows: Arrows, double: bool) -> None:
    """From its point to its tip, with a head that is never longer than it."""
    reach, per_metre = 2.0, 5.0
    begin, shaft_end = ends(shafts(arrows, per_metre, reach))
    head_begin, head_end = (x[: len(arrows.at)] for x in ends(heads(arrows, per_metre, reach, double)))
    wanted = arrows.at + arrows.vector / per_metre
    for x, y in (
        (begin, arrows.at),
        (head_end, wanted),
        (tips(arrows, per_metre, reach), wanted),
        (shaft_end, head_begin),
    ):
        assert np.abs(x - y).max() <= 3e-9  # what is not drawn is so small


def test_unit_quaternions() -> None:
    for own in (shafts(ALONG, 1.0, 1.0), sticks(ALONG, 0.01)):
        assert np.allclose(np.linalg.norm(own.wxyz, axis=1), 1.0, rtol=MODEL)
        assert (own.scale > 0.0).all()


def test_the_ladder() -> None:
    assert [rung(i) for i in range(-4, 5)] == [0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]
    for x in [*(10.0 ** RNG.uniform(-12, 12, 200)), 1.0, 2.0, 0.5, 1e-300, 1e300]:
        i = rung_of(x)
        assert rung(i) >= x * (1 - 1e-9) and rung(i - 1) < x
    assert rung_of(0.0) == rung_of(float("inf")) == rung_of(float("nan")) == 0


def test_the_longest_arrow_fits() -> None:
    for size in (1e-14, 1.0, 3e7):
        own = Arrows(np.zeros((2, 3)), np.array([[size, 0, 0], [0, size / 3, 0]]))
        length = size / rung(fitting([own], 2.0))
        assert 0.4 * 0.4 * 2.0 <= length <= 0.4 * 2.0 * 1.01
    assert fitting([], 1.0) == fitting([Arrows(np.zeros((0, 3)), np.zeros((0, 3)))], 1.0) == 0


@pytest.mark.parametrize("solid", [cylinder, cone, ball])
def test_solids_are_closed_and_point_outwards(solid: object) -> None:
    """By the volume that their triangles enclose, of a polygon with many sides."""
    corners, faces = solid()  # type: ignore[operator]
    a, b, c = (corners[faces[:, k]] for k in range(3))
    volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0
    exact = {"cylinder": np.pi, "cone": np.pi / 3, "ball": 4 * np.pi / 3}[solid.__name__]  # type: ignore[attr-defined]
    assert 0.9 * exact < volume < exact
