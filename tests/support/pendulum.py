"""A pendulum whose driving moment stands on one line, for programs, functions and tables that know no library."""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import rttrr_pin

URDF = """<robot name="pendulum">
<link name="base"/>
<link name="rod"><inertial><mass value="2"/><origin xyz="0 0 -0.5"/>
<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>
<joint name="pivot" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint>
</robot>"""

PROGRAM = """
import json, os, sys, time
from math import nan, sin
for k, line in enumerate(sys.stdin):
    state = json.loads(line)
    q, v, a = state["q"][0], state["v"][0], state["a"][0]
    tau = 0.6 * a + 9.81 * sin(q)
    {reply}
"""
"""What a user's program looks like; `reply` is a line of Python that writes tau."""


@cache
def pendulum() -> rttrr_pin.Robot:
    return rttrr_pin.load(URDF)


def moment(q: NDArray[np.float64], v: NDArray[np.float64], a: NDArray[np.float64]) -> NDArray[np.float64]:
    """tau of one state or many."""
    return 0.6 * a + 9.81 * np.sin(q)


def program(folder: Path, reply: str) -> list[str]:
    """The command of a program that replies so."""
    path = folder / "my_id.py"
    path.write_text(PROGRAM.format(reply=reply))
    return [sys.executable, "-S", str(path)]
