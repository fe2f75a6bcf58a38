"""What is drawn of a robot, and its URDF: numbers in tenths, which have few digits, and bodies that are possible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

FOLLOWING = ("revolute", "prismatic", "continuous")
"""Types that may follow another by <mimic>."""

AXES = ((0, 0, 1), (1, 0, 0), (0, 1, 0))
"""The simplest directions; others are of small whole numbers."""

ENTRIES = {"ixx": (0, 0), "ixy": (0, 1), "ixz": (0, 2), "iyy": (1, 1), "iyz": (1, 2), "izz": (2, 2)}


@dataclass(frozen=True, slots=True)
class DrawnJoint:
    """What is drawn of a joint and its link; positions and angles in tenths.

    Attributes:
        kind: type of the joint.
        back: how many links before the last one its parent is.
        follows: the how-manieth last of the joints before it that it follows, where it can; 0 for none.
        xyz: of the origin.
        rpy: of the origin.
        axis: small whole numbers.
        body: mass, centre of mass, and a factor of the second moments of the link.
        motion: in tenths q, v and a, of which a joint takes as many as it has; empty where only a robot is drawn.
    """

    kind: str
    back: int
    follows: int
    xyz: Sequence[int]
    rpy: Sequence[int]
    axis: Sequence[int]
    body: DrawnBody
    motion: Sequence[Sequence[int]]


@dataclass(frozen=True, slots=True)
class DrawnRobot:
    """The root's body and motion, where it floats, and the joints with their links."""

    root: DrawnBody | None
    motion: Sequence[Sequence[int]]
    joints: Sequence[DrawnJoint]


@dataclass(frozen=True, slots=True)
class DrawnBody:
    """Tenths: mass [kg], centre of mass [m], and lower triangle L of second moments L L^T about it [m sqrt(kg)]."""

    mass: int
    com: Sequence[int]
    factor: Sequence[int]


def text_of(root: DrawnBody | None, joints: Sequence[DrawnJoint]) -> str:
    """The text of the robot; the root has a body where it floats."""
    lines = ['<robot name="drawn">', f'  <link name="base">{"" if root is None else _inertial(root)}</link>']
    lead: list[int] = []
    for i, own in enumerate(joints):
        parent = f"link_{max(i - 1 - own.back, -1) + 1}" if i > own.back else "base"
        leader = lead[-own.follows] if own.kind in FOLLOWING and 0 < own.follows <= len(lead) else None
        lines += [f'  <link name="link_{i + 1}">{_inertial(own.body)}</link>', *_joint(i, own, parent, leader)]
        if own.kind in FOLLOWING and leader is None:
            lead.append(i)
    return "\n".join([*lines, "</robot>"])


def _inertial(body: DrawnBody) -> str:
    """Second moments L L^T are those of a possible body; the tensor is their trace times 1, less them."""
    L = np.zeros((3, 3), dtype=np.int64)
    L[np.tril_indices(3)] = body.factor
    moments = L @ L.T
    tensor = np.trace(moments) * np.eye(3, dtype=np.int64) - moments
    entries = " ".join(f'{name}="{tensor[at] / 100:g}"' for name, at in ENTRIES.items())
    origin = f'<origin xyz="{_decimals(body.com)}"/>' if any(body.com) else ""
    return f'<inertial>{origin}<mass value="{body.mass / 10:g}"/><inertia {entries}/></inertial>'


def _joint(i: int, own: DrawnJoint, parent: str, leader: int | None) -> list[str]:
    names = f'<parent link="{parent}"/><child link="link_{i + 1}"/>'
    origin = f'<origin xyz="{_decimals(own.xyz)}" rpy="{_decimals(own.rpy)}"/>' if any((*own.xyz, *own.rpy)) else ""
    moves = ""
    if own.kind not in ("fixed", "floating"):
        axis = AXES[0] if own.kind == "planar" else own.axis
        moves = f'<axis xyz="{" ".join(map(str, axis))}"/><limit lower="-2" upper="2" velocity="3" effort="10"/>'
    mimic = "" if leader is None else f'<mimic joint="joint_{leader + 1}" multiplier="-2" offset="0.5"/>'
    return [f'  <joint name="joint_{i + 1}" type="{own.kind}">{names}{origin}{moves}{mimic}</joint>']


def _decimals(tenths: Sequence[int]) -> str:
    return " ".join(f"{k / 10:g}" for k in tenths)
