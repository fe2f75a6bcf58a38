"""A program that gives links without inertia that of a body: named, at one link and at all of them."""

from __future__ import annotations

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.diagnosis import diagnose

INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
ARM = rttrr_pin.load("rttrr").model.urdf.replace('<link name="tool" />', '<link name="tool"/>')


@pytest.mark.one_in(3)
@pytest.mark.parametrize(("frames", "wrenches"), [(1, False), (1, True), (2, False)])
def test_the_default_of_a_program_is_named(frames: int, wrenches: bool) -> None:
    """Also by forces and moments at that link, which are zero in the reference."""
    second = '<link name="lens"/><joint name="lens_joint" type="fixed"><origin xyz="0.1 0.2 0"/><parent link="link_3"/><child link="lens"/></joint></robot>'
    text = ARM if frames == 1 else ARM.replace("</robot>", second)
    filled = text
    for name in ("tool", "lens")[:frames]:
        assert f'<link name="{name}"/>' in text
        filled = filled.replace(f'<link name="{name}"/>', f'<link name="{name}">{INERTIAL}</link>')
    other = rttrr_pin.load(filled)

    def program(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> dict[str, np.ndarray]:
        result = other.inverse_dynamics(q, v, a)
        return {"tau": result.tau} | ({"f": result.f, "n": result.n} if wrenches else {})

    found = diagnose(rttrr_pin.load(text), program, n_states=60)
    assert [cause.hypothesis for cause in found.causes] == [
        ("default inertia", "default inertia at every link")[frames - 1]
    ]
