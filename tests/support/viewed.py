"""Robots and motions to look at."""

from __future__ import annotations

from typing import Any

import numpy as np

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.validation.sampling import Sampler
from rttrr_pin.viewing.states import State
from support.trees import random_tree

AWKWARD = """<robot name="awkward">
 <link name="base"/>
 <link name="&lt;img src=x onerror=alert(1)&gt;"><inertial><mass value="2"/><inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><geometry><mesh filename="package://nowhere/&lt;b&gt;.stl"/></geometry></visual></link>
 <link name="heavy/{curly}"><inertial><origin xyz="0.1 0 0"/><mass value="3"/><inertia ixx="1e9" iyy="1e9" izz="1e9" ixy="0" ixz="0" iyz="0"/></inertial></link>
 <link name="impossible"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="3" ixy="0" ixz="0" iyz="0"/></inertial></link>
 <joint name="&quot;&lt;script&gt;alert(2)&lt;/script&gt;" type="revolute"><parent link="base"/><child link="&lt;img src=x onerror=alert(1)&gt;"/>
  <axis xyz="0 1 0"/><limit lower="-1" upper="2" velocity="1" effort="10"/></joint>
 <joint name="b" type="continuous"><parent link="&lt;img src=x onerror=alert(1)&gt;"/><child link="heavy/{curly}"/><origin xyz="0.5 0 0"/><axis xyz="0 1 0"/></joint>
 <joint name="c" type="prismatic"><parent link="heavy/{curly}"/><child link="impossible"/><origin xyz="0.5 0 0"/><axis xyz="1 0 0"/>
  <limit lower="0" upper="1e-4" velocity="1" effort="10"/></joint>
</robot>"""
"""Names that would be markup, numbers from 1e-9 to 1e9, a tensor that no body has, a mesh that is nowhere."""

MASSLESS = """<robot name="massless"><link name="base"/><link name="a"/>
 <joint name="j" type="continuous"><parent link="base"/><child link="a"/><origin xyz="0 0 0.4"/><axis xyz="0 0 1"/></joint></robot>"""


def tree(seed: int, joints: int = 8, floating: bool = False) -> Robot:
    return rttrr_pin.load(random_tree(seed, joints), base="floating" if floating else "fixed")


def random_state(robot: Robot, seed: int = 0) -> State:
    batch = Sampler(robot.model, seed=seed).draw(0, 1)
    return State(batch.q[0], batch.v[0], batch.a[0])


class Swing:
    """A motion of every joint, in blocks of any size."""

    name = "swing"

    def __init__(self, robot: Robot, rows: int = 101) -> None:
        self.model, self.rows = robot.model, rows
        batch = Sampler(self.model, seed=3).draw(0, 1)
        self.time = np.arange(rows) * 0.02
        w = 1.0 + np.arange(self.model.nv) % 3
        phase, size = w * self.time[:, None], 0.3
        self.q = self.model.coordinates_at(size * np.sin(phase) + 0.0 * batch.v)
        self.v, self.a = size * w * np.cos(phase), -size * w * w * np.sin(phase)

    def blocks(self, size: int = 4096) -> Any:
        for start in range(0, self.rows, size):
            yield _Block(self, slice(start, min(start + size, self.rows)))


class _Block:
    def __init__(self, swing: Swing, part: slice) -> None:
        self.rows = np.arange(2, swing.rows + 2)[part]
        self.time, self.q, self.v, self.a = (getattr(swing, name)[part] for name in ("time", "q", "v", "a"))
        self.payload = ()
