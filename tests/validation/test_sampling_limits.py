"""Limits that are none: files write 1e16, or the largest double, where a joint may do what it likes."""

from __future__ import annotations

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.validation import Sampler

ARM = """<robot name="x"><link name="base"/>
  <link name="arm"><inertial><origin xyz="0.1 0 0.2"/><mass value="1"/>
    <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>
  <joint name="j" type="{0}"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-{1}" upper="{1}" velocity="{1}" effort="{1}"/></joint></robot>
"""


@pytest.mark.parametrize("limit", ["1e16", "1e308", "1.7976931348623157e308"])
@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_a_limit_beyond_all_reason_is_none(limit: str, kind: str) -> None:
    robot = rttrr_pin.load(ARM.format(kind, limit))
    batch = Sampler(robot.model).draw(0, 100)
    assert np.abs(batch.q).max() < 10 and np.abs(batch.v).max() < 10
    assert rttrr_pin.validate(robot, "recursion", "lagrange", n_states=20).passed
