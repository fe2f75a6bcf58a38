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
from rttrr_pin.core.model import Link, Model
from rttrr_pin.implementations import library


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

    @property
    def arm(self) -> float:
        """The distance of its origin from the joint's [m]."""
        return float(np.linalg.norm(self.p))

    @property
    def massive(self) -> bool:
        """Whether it has any inertia."""
        return bool(self.mass or self.inertia.any())

    def to_joint(self, f: Array, n: Array) -> Array:
        """A force and a moment at the link's origin, (N, 3) each, at the joint's: (N, 6)."""
        f, n = library.product(self.R, f), library.product(self.R, n)
        return np.concatenate([f, n + np.cross(self.p, f)], axis=1)

    def from_joint(self, force: Array) -> Array:
        """A spatial force at the joint's origin, (N, 6), at the link's."""
        f, n = force[:, :3], force[:, 3:]
        n = n - np.cross(self.p, f)
        return np.concatenate([library.product(self.R.T, f), library.product(self.R.T, n)], axis=1)


def pin_joints(model: Model, pin_model: Any) -> list[library.LibraryJoint]:
    """The moving joints, in our order."""

    def place(joint: Joint, link: Link) -> tuple[slice, slice]:
        built = pin_model.joints[pin_model.getJointId(joint.name)]
        return slice(built.idx_q, built.idx_q + built.nq), slice(built.idx_v, built.idx_v + built.nv)

    return library.library_joints(model, place)


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
        mass, com, tensor = link.mass, link.com, link.inertia
        if inertia is not None:
            mass, com, tensor = float(inertia.mass), np.array(inertia.lever), np.array(inertia.inertia)
        R, p = np.array(frame.placement.rotation), np.array(frame.placement.translation)
        links.append(PinLink(fixed, int(frame.parentJoint), R, p, mass, com, tensor))
    return links


def differences(model: Model, pin_model: Any) -> list[str]:
    """One line for each number of Pinocchio's model that is not what the file says."""
    built = [name for name in pin_model.names if name != "universe"]
    expected = [joint.name for joint in model.joints if joint.nv]
    if sorted(built) != sorted(expected):  # an object's joints keep their order, which may be another
        return [f"moving joints: {', '.join(built)}, the file has {', '.join(expected)}"]
    data = pin_model.createData()
    lines = [line for i in range(len(model.joints)) for line in _joint_differences(model, pin_model, data, i)]
    return [*lines, *_mimic_differences(model)]


def _joint_differences(model: Model, pin_model: Any, data: Any, i: int) -> Iterator[str]:
    """Placement, axis and limits of a joint; mass, centre and tensor of what it carries."""
    joint, link, at_link = model.joints[i], model.links[i], (i, np.eye(3), np.zeros(3))
    R, p, ancestor = _placement_on_moving(model, i)
    if not joint.nv:
        frame = pin_model.frames[pin_model.getFrameId(joint.name, pin.FrameType.FIXED_JOINT)]
        yield from library.placement_differences(joint, (R, p), frame.placement.rotation, frame.placement.translation)
        yield from _inertia_differences(link, _inertia(model, [at_link]), frame.inertia)
        return
    number = pin_model.getJointId(joint.name)
    parent = pin_model.getJointId(model.joints[ancestor].name) if ancestor >= 0 else 0
    if pin_model.parents[number] != parent:
        hanging_on = pin_model.names[pin_model.parents[number]]
        yield f"joint {joint.name!r}: hangs on {hanging_on!r}, not where the file has it"
    placement, built = pin_model.jointPlacements[number], pin_model.joints[number]
    yield from library.placement_differences(joint, (R, p), placement.rotation, placement.translation)
    yield from library.differs(f"joint {joint.name!r} axis", _subspace(joint), data.joints[number].S, 1.0)
    if joint.type.has_axis:
        yield from library.limit_differences(joint, _limits(pin_model, built.idx_q, built.idx_v))
    merged = [at_link, *((k, *_placement_on_moving(model, k)[:2]) for k in _merged(model, i))]
    yield from _inertia_differences(link, _inertia(model, merged), pin_model.inertias[number])


def _limits(pin_model: Any, q: int, v: int) -> dict[str, float]:
    return {
        "damping": pin_model.damping[v],
        "friction": pin_model.upperDryFrictionLimit[v],
        "velocity limit": pin_model.velocityLimit[v],
        "effort limit": pin_model.effortLimit[v],
        "lower limit": pin_model.lowerPositionLimit[q],
        "upper limit": pin_model.upperPositionLimit[q],
    }


def _inertia_differences(link: Link, expected: tuple[float, Array, Array], built: Any) -> Iterator[str]:
    mass, com, _ = expected
    scale = mass * float(com @ com)  # what is merged was moved to the common centre of mass
    yield from library.inertia_differences(link, expected, (built.mass, built.lever, built.inertia), scale)


def _mimic_differences(model: Model) -> Iterator[str]:
    """Multiplier and offset of followers, where Pinocchio can build them: not if the followed joint sorts later."""
    joints = library.followers(model)
    try:
        pin_model: Any = pin.buildModelFromXML(model.urdf, mimic=True) if joints else None
    except (ValueError, RuntimeError):
        return
    for joint in joints:
        number = pin_model.getJointId(joint.name)  # njoints for one that it did not build
        if number < pin_model.njoints and pin_model.joints[number].shortname() == "JointModelMimic":
            built = pin_model.joints[number].extract()
            yield from library.mimic_differences(joint, built.scaling, built.offset)


def _subspace(joint: Joint) -> Array:
    """The joint's motion per unit rate, linear before angular: (6,), or (6, nv) where there are several rates."""
    S = np.eye(6)[:, : joint.nv]  # of a floating joint all six, of a planar one x and y
    if joint.type != FLOATING:
        S[:, -1] = [0, 0, 0, *joint.axis] if joint.type.rotations[-1] else [*joint.axis, 0, 0, 0]
    return S.squeeze()


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
