"""Ellipsoids have the mass and the inertia of their links; what no body has is said so."""

from __future__ import annotations

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.solids import Box, Cylinder, RigidBody, Sphere
from rttrr_pin.viewing.ellipsoids import ellipsoids
from support.tolerances import ROUNDING
from support.viewed import AWKWARD, MASSLESS, tree


def inertia_of(mass: float, semi_axes: np.ndarray, axes: np.ndarray) -> np.ndarray:
    """Of a homogeneous ellipsoid: I_1 = m (b^2 + c^2) / 5."""
    squares = semi_axes**2
    return axes @ np.diag(mass * (squares.sum() - squares) / 5.0) @ axes.T


def one(link: Link) -> Model:
    return Model("one", Link("base"), (link,), (Joint("j", REVOLUTE),))


@pytest.mark.parametrize("solid", [Box((0.2, 0.3, 0.5)), Cylinder(0.1, 0.7), Sphere(0.2)])
def test_the_ellipsoid_has_the_inertia_of_a_solid(solid: Box | Cylinder | Sphere) -> None:
    body = RigidBody.of(solid, 1000.0).placed((0.1, 0.2, 0.3), (0.4, -0.5, 0.6))
    tensor = (body.inertia + body.inertia.T) / 2.0
    (own,) = ellipsoids(one(Link("l", body.mass, body.com, tensor)))
    assert not own.impossible
    assert np.linalg.norm(inertia_of(body.mass, own.semi_axes, own.axes) - tensor) <= ROUNDING * np.linalg.norm(tensor)
    assert np.linalg.det(own.axes) > 0.0


def test_of_a_ball_it_is_the_ball() -> None:
    body = RigidBody.of(Sphere(0.2), 1000.0)
    (own,) = ellipsoids(one(Link("l", body.mass, body.com, body.inertia)))
    assert np.allclose(own.semi_axes, 0.2, rtol=ROUNDING)


def test_what_no_body_has_is_marked_and_finite() -> None:
    tiny, huge, impossible = ellipsoids(rttrr_pin.load(AWKWARD).model)
    assert (tiny.impossible, huge.impossible, impossible.impossible) == (False, False, True)
    for own in (tiny, huge, impossible):
        assert np.isfinite(own.semi_axes).all()
    assert np.allclose(tiny.semi_axes, np.sqrt(2.5 * 1e-9 / 2.0))


@pytest.mark.parametrize(
    ("mass", "moments"),
    [
        (0.0, (1, 1, 1)),
        (1.0, (0, 0, 0)),
        (-1.0, (1, 1, 1)),
        (1.0, (1, 2, 3)),
        (1e-300, (1e300, 1e300, 1e300)),
        (1.0, (1, 1, 0)),
    ],
)
def test_nothing_is_ever_no_number(mass: float, moments: tuple[float, float, float]) -> None:
    for own in ellipsoids(one(Link("l", mass, np.zeros(3), np.diag(moments).astype(float)))):
        assert np.isfinite(own.semi_axes).all() and (own.semi_axes >= 0.0).all()


def test_links_without_mass_have_none() -> None:
    assert ellipsoids(rttrr_pin.load(MASSLESS).model) == ()
    robot = tree(2)
    massive = [i for i, link in enumerate(robot.model.links) if link.mass]
    assert [own.link for own in ellipsoids(robot.model)] == massive
