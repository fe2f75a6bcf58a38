"""The model that Pinocchio built, link by link, and what in it differs from the file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import FLOATING
from rttrr_pin.core.model import Model
from rttrr_pin.implementations.model_comparison import differs


@dataclass(frozen=True, slots=True, eq=False)
class PinLink:
    """A link of the file, where Pinocchio has it: on a joint, at a placement.

    Attributes:
        fixed: whether a fixed joint carries it, so that Pinocchio merged it into the body of `joint`.
        joint: Pinocchio's joint that moves it; 0 is the universe.
        R: maps vectors of the link frame to the joint frame.
        p: from the joint frame's origin to the link's, in the joint frame [m].
        mass: [kg].
        com: in the link frame [m].
        inertia: about the centre of mass, in link axes [kg m^2].
    """

    fixed: bool
    joint: int
    R: Array
    p: Array
    mass: float
    com: Array
    inertia: Array

    def to_joint(self, f: Array, n: Array) -> Array:
        """A force and a moment at the link's origin, (N, 3) each, at the joint's: (N, 6)."""
        f, n = product(self.R, f), product(self.R, n)
        return np.concatenate([f, n + np.cross(self.p, f)], axis=1)

    def from_joint(self, force: Array) -> Array:
        """A spatial force at the joint's origin, (N, 6), at the link's."""
        f, n = force[:, :3], force[:, 3:]
        n = n - np.cross(self.p, f)
        return np.concatenate([product(self.R.T, f), product(self.R.T, n)], axis=1)


def product(matrix: Array, vectors: Array) -> Array:
    """Matrix times vector for each row of (N, 3); the matrix is (3, 3), or one for each row, (N, 3, 3).

    Written out, since a matrix product of the whole batch rounds by its size, and a state must give the same bits in
    any batch.
    """
    x, y, z = (vectors[:, k, None] for k in range(3))
    return matrix[..., :, 0] * x + matrix[..., :, 1] * y + matrix[..., :, 2] * z


def pin_links(model: Model, pin_model: Any) -> list[PinLink]:
    """Each link of the file with Pinocchio's placement and inertia.

    Pinocchio keeps the inertia of a link apart unless massive links are fixed to it; then only the sum is there, and
    the link's own part is the file's (that the sum is right, `differences` has shown).
    """
    links = []
    for i, (joint, link) in enumerate(zip(model.joints, model.links, strict=True)):
        fixed = joint.nv == 0
        frame = pin_model.frames[pin_model.getFrameId(link.name, pin.FrameType.BODY)]
        if fixed:
            inertia = pin_model.frames[pin_model.getFrameId(joint.name, pin.FrameType.FIXED_JOINT)].inertia
        elif any(model.links[k].mass or model.links[k].inertia.any() for k in _merged(model, i)):
            inertia = None  # pin.Inertia refuses tensors that Pinocchio's own reader takes
        else:
            inertia = pin_model.inertias[frame.parentJoint]
        links.append(
            PinLink(
                fixed,
                int(frame.parentJoint),
                np.array(frame.placement.rotation),
                np.array(frame.placement.translation),
                float(inertia.mass if inertia else link.mass),
                np.array(inertia.lever if inertia else link.com),
                np.array(inertia.inertia if inertia else link.inertia),
            )
        )
    return links


def differences(model: Model, pin_model: Any) -> list[str]:
    """One line for each number of Pinocchio's model that is not what the file says."""
    built = [name for name in pin_model.names if name != "universe"]
    expected = [joint.name for joint in model.joints if joint.nv]
    if built != expected:
        return [f"moving joints: {', '.join(built)}, the file has {', '.join(expected)}"]
    found: list[str] = []
    data = pin_model.createData()
    for i, joint in enumerate(model.joints):
        found += _joint_differences(model, pin_model, data, joint, i)
    found += _mimic_differences(model)
    return found


def _joint_differences(model: Model, pin_model: Any, data: Any, joint: Joint, i: int) -> Iterator[str]:
    """Placement, axis and limits of a joint; mass, centre and tensor of what it carries."""
    R, p, ancestor = _placement_on_moving(model, i)
    here, link = f"joint {joint.name!r}", f"link {model.links[i].name!r}"
    if not joint.nv:
        at = pin_model.getFrameId(joint.name, pin.FrameType.FIXED_JOINT)
        frame = pin_model.frames[at]
        yield from differs(f"{here} placement R", R, frame.placement.rotation, 1.0)
        yield from differs(f"{here} placement p", p, frame.placement.translation)
        yield from _inertia_differences(link, _inertia(model, [(i, np.eye(3), np.zeros(3))]), frame.inertia)
        return
    at = pin_model.getJointId(joint.name)
    parent = pin_model.getJointId(model.joints[ancestor].name) if ancestor >= 0 else 0
    if pin_model.parents[at] != parent:
        yield f"{here}: hangs on {pin_model.names[pin_model.parents[at]]!r}, not where the file has it"
    placement = pin_model.jointPlacements[at]
    yield from differs(f"{here} placement R", R, placement.rotation, 1.0)
    yield from differs(f"{here} placement p", p, placement.translation)
    yield from differs(f"{here} axis", _subspace(joint), data.joints[at].S, 1.0)
    yield from _limit_differences(here, joint, pin_model, at)
    merged = [(i, np.eye(3), np.zeros(3)), *((k, *_placement_on_moving(model, k)[:2]) for k in _merged(model, i))]
    yield from _inertia_differences(link, _inertia(model, merged), pin_model.inertias[at])


def _mimic_differences(model: Model) -> Iterator[str]:
    """Multiplier and offset of followers, where Pinocchio can build them: not if the followed joint sorts later."""
    followers = [joint for joint in model.joints if joint.mimic is not None and not joint.mimic.rounded]
    if not followers:
        return
    try:
        pin_model = pin.buildModelFromXML(model.urdf, mimic=True)
    except (ValueError, RuntimeError):
        return
    for joint in followers:
        number = pin_model.getJointId(joint.name)
        if number < pin_model.njoints and pin_model.joints[number].shortname() == "JointModelMimic" and joint.mimic:
            built = pin_model.joints[number].extract()
            yield from differs(f"joint {joint.name!r} mimic multiplier", joint.mimic.multiplier, built.scaling)
            yield from differs(f"joint {joint.name!r} mimic offset", joint.mimic.offset, built.offset)


def _inertia_differences(link: str, expected: tuple[float, Array, Array], built: Any) -> Iterator[str]:
    mass, com, tensor = expected
    yield from differs(f"{link} mass", mass, built.mass)
    if mass:
        yield from differs(f"{link} centre of mass", com, built.lever)
    yield from differs(f"{link} inertia", tensor, built.inertia, mass * float(com @ com))


def _limit_differences(here: str, joint: Joint, pin_model: Any, at: int) -> Iterator[str]:
    """Limits, where the file sets them (a continuous joint has none on its angle), damping and friction."""
    if not joint.type.has_axis:
        return
    limits, v, q = joint.limits, pin_model.joints[at].idx_v, pin_model.joints[at].idx_q
    compared = [
        ("velocity limit", limits.velocity, pin_model.velocityLimit[v]),
        ("effort limit", limits.effort, pin_model.effortLimit[v]),
    ]
    yield from differs(f"{here} damping", joint.dynamics.damping, pin_model.damping[v])
    yield from differs(f"{here} friction", joint.dynamics.friction, pin_model.upperDryFrictionLimit[v])
    if joint.type.limits != "none":
        compared += [
            ("lower limit", limits.lower, pin_model.lowerPositionLimit[q]),
            ("upper limit", limits.upper, pin_model.upperPositionLimit[q]),
        ]
    for what, expected, built in compared:
        if np.isfinite(expected):
            yield from differs(f"{here} {what}", expected, built)


def _subspace(joint: Joint) -> Array:
    """The joint's motion per unit rate, linear before angular: (6,), or (6, nv) where there are several rates."""
    if joint.type.has_axis:
        return np.concatenate([np.zeros(3), joint.axis] if joint.type.rotates else [joint.axis, np.zeros(3)])
    return np.eye(6) if joint.type == FLOATING else _with_axis(joint.axis)


def _with_axis(axis: Array) -> Array:
    """The subspace of a planar joint: along x and y, about the axis."""
    S = np.zeros((6, 3))
    S[0, 0] = S[1, 1] = 1.0
    S[3:, 2] = axis
    return S


def _placement_on_moving(model: Model, i: int) -> tuple[Array, Array, int]:
    """R, p of joint i on the nearest link further in that a moving joint carries, and that link's index (-1: root)."""
    joint = model.joints[i]
    R, p, k = joint.R, joint.p, joint.parent
    while k >= 0 and model.joints[k].nv == 0:
        R, p = model.joints[k].R @ R, model.joints[k].p + model.joints[k].R @ p
        k = model.joints[k].parent
    return R, p, k


def _merged(model: Model, i: int) -> list[int]:
    """The links that fixed joints hold to link i, which a moving joint carries."""
    fixed = (k for k, joint in enumerate(model.joints) if joint.nv == 0)
    return [k for k in fixed if _placement_on_moving(model, k)[2] == i]


def _inertia(model: Model, parts: list[tuple[int, Array, Array]]) -> tuple[float, Array, Array]:
    """Mass, centre of mass and tensor about it of links at placements R, p (parallel axis theorem)."""
    masses = np.array([model.links[k].mass for k, _, _ in parts])
    centres = np.array([p + R @ model.links[k].com for k, R, p in parts])
    mass = float(masses.sum())
    com = masses @ centres / mass if mass else centres[0]
    tensor = np.zeros((3, 3))
    for (k, R, _), m, c in zip(parts, masses, centres, strict=True):
        tensor += R @ model.links[k].inertia @ R.T + m * point_tensor(Vector.of(c - com)).array
    return mass, com, tensor
