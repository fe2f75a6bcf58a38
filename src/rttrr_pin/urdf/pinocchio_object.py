"""The robot of a `pinocchio.Model`, read through its attributes; its joints keep their order.

| Pinocchio's joint | ours |
|---|---|
| `RX`, `RevoluteUnaligned`, ... | revolute; continuous where it has no limit |
| `RUBX`, `RevoluteUnboundedUnaligned`, ... (cosine and sine) | continuous: the angle |
| `PX`, `PrismaticUnaligned`, ... | prismatic |
| `Planar` (x, y, cosine, sine), `FreeFlyer` | planar (x, y, angle), floating |
| `Translation`, `SphericalZYX`, `Universal`, `Composite` | one joint for each part, with links without mass between |
| `Mimic` | the same |
| `Spherical`, `H...`, `Ellipsoid` | none: refused |

Pinocchio keeps one inertia for all links that fixed joints hold together. So the link of a moving joint has it, under
the name of the joint's own body frame, and the frames of fixed bodies and points are links without mass.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import JointEffects, Limits, Mimic
from rttrr_pin.core.joints import CONTINUOUS, FLOATING, PLANAR, PRISMATIC, REVOLUTE, JointType
from rttrr_pin.core.model import Model
from rttrr_pin.errors import listed, shortened
from rttrr_pin.urdf.object_tree import ObjectTree, limit

X, Y, Z = np.eye(3)

ALIGNED: dict[str, tuple[JointType, Array]] = {
    f"{prefix}{letter}": (joint_type, axis)
    for prefix, joint_type in (("R", REVOLUTE), ("RUB", CONTINUOUS), ("P", PRISMATIC))
    for letter, axis in zip("XYZ", (X, Y, Z), strict=True)
}
"""Joints along an axis of their frame."""

UNALIGNED = {
    "RevoluteUnaligned": REVOLUTE,
    "RevoluteUnboundedUnaligned": CONTINUOUS,
    "PrismaticUnaligned": PRISMATIC,
}

WHOLE = {"Planar": PLANAR, "FreeFlyer": FLOATING}

SEVERAL = {
    "Translation": ((PRISMATIC, X, "x"), (PRISMATIC, Y, "y"), (PRISMATIC, Z, "z")),
    "SphericalZYX": ((REVOLUTE, Z, "z"), (REVOLUTE, Y, "y"), (REVOLUTE, X, "x")),
}
"""Joints whose rates are those of joints in a row."""

FRAMES = ("BODY", "OP_FRAME")
"""Frames that become links."""


@dataclass(frozen=True, slots=True)
class _Part:
    """A joint of one of our types, in the order in which they move the body; `label` tells it from the others."""

    type: JointType
    axis: Array
    label: str
    R: Array
    p: Array
    q: int
    v: int


def as_model(pin_model: Any, source: str) -> Model:
    """The robot.

    Args:
        pin_model: a `pinocchio.Model`.
        source: what to call it in messages.

    Raises:
        UrdfError: a joint has no counterpart, or numbers are none that a robot can have.
    """
    return _Reader(pin_model, source).read()


class _Reader:
    def __init__(self, pin_model: Any, source: str) -> None:
        self.pin, self.tree = pin_model, ObjectTree(source)
        self.frames = list(pin_model.frames)
        self.names = list(pin_model.names)
        self.links = {0: -1}
        """By Pinocchio's number of a joint, the link that it moves."""
        self.first: dict[int, int] = {}
        """By the place of a rate in v, the joint of ours that has it."""

    def read(self) -> Model:
        pin, tree = self.pin, self.tree
        own: dict[int, int] = {}  # by joint, the frame of the body that it moves: the first that is the joint's own
        begins: dict[int, int] = {}  # by joint, its frame
        for k, frame in enumerate(self.frames):
            if frame.type.name == "BODY" and frame.parentJoint not in own and _is_identity(frame.placement):
                own[frame.parentJoint] = k
            elif frame.type.name == "JOINT":
                begins[frame.parentJoint] = k
        bodies = {j: self.frames[k].name for j, k in own.items()}
        kept = set(own.values())
        fixed = [k for k, frame in enumerate(self.frames) if frame.type.name in FRAMES and k not in kept]
        tree.root(bodies.get(0, "universe"), self._inertial(0))
        for j in range(1, pin.njoints):
            while fixed and fixed[0] < begins.get(j, 0) and self.frames[fixed[0]].parentJoint in self.links:
                self._fixed(fixed.pop(0))
            self._joint(j, bodies.get(j, self.names[j]))
        for k in fixed:
            self._fixed(k)
        self._note_left(kept)
        return tree.model(pin.name, pin.gravity.linear)

    def _inertial(self, j: int) -> tuple[float, Array, Array]:
        inertia = self.pin.inertias[j]
        return inertia.mass, np.array(inertia.lever), np.array(inertia.inertia)

    def _joint(self, j: int, body: str) -> None:
        """The joints of ours that one of Pinocchio's is."""
        name = self.names[j]
        if self.pin.joints[j].shortname() == "JointModelMimic":
            parts, mimic = [self._follower(j)], self._mimic(j)
        else:
            parts, mimic = self._parts(self.pin.joints[j], name), None
        placement = self.pin.jointPlacements[j]
        R, p = np.array(placement.rotation), np.array(placement.translation)
        parent = self.links[int(self.pin.parents[j])]
        for k, part in enumerate(parts):
            last = k == len(parts) - 1
            joint = f"{name}.{part.label}" if len(parts) > 1 else name
            R, p = (part.R, part.p) if k else (R @ part.R, p + R @ part.p)
            parent = self.tree.add(
                joint=self.tree.name("joint", joint, f"joint_{j}"),
                link=self.tree.name("link", body if last else joint, f"link_{j}"),
                parent=parent,
                R=R,
                p=p,
                type=part.type,
                axis=part.axis,
                inertial=self._inertial(j) if last else None,
                limits=self._limits(part),
                effects=JointEffects() if mimic else self._effects(part, joint),
                mimic=mimic,
            )
            if mimic is None:
                self.first[part.v] = parent
        self.links[j] = parent

    def _parts(self, joint: Any, name: str) -> list[_Part]:
        own = joint.extract() if hasattr(joint, "extract") else joint
        type_name = joint.shortname().removeprefix("JointModel")
        eye, zero, q, v = np.eye(3), np.zeros(3), int(joint.idx_q), int(joint.idx_v)
        if type_name in ALIGNED:
            return [_Part(*ALIGNED[type_name], "", eye, zero, q, v)]
        if type_name in UNALIGNED:
            S = np.ravel(joint.createData().S)  # not every one of them tells its axis
            return [_Part(UNALIGNED[type_name], S[:3] + S[3:], "", eye, zero, q, v)]
        if type_name in WHOLE:
            return [_Part(WHOLE[type_name], Z, "", eye, zero, q, v)]
        if type_name in SEVERAL:
            return [_Part(*each, eye, zero, q + k, v + k) for k, each in enumerate(SEVERAL[type_name])]
        if type_name == "Universal":
            axes = (np.array(own.axis1), np.array(own.axis2))
            return [_Part(REVOLUTE, axis, str(k + 1), eye, zero, q + k, v + k) for k, axis in enumerate(axes)]
        if type_name == "Composite":
            return list(self._composite(own, name))
        raise self.tree.error(
            f"is {type_name}, which is none of our joint types ({', '.join((*ALIGNED, *UNALIGNED, *WHOLE, *SEVERAL))}, "
            "Universal, Composite, Mimic): model it by these",
            f'joint "{shortened(name)}"',
        )

    def _composite(self, own: Any, name: str) -> Iterator[_Part]:
        """The parts in a row, each on the one before at its placement."""
        for k, (joint, placement) in enumerate(zip(own.joints, own.jointPlacements, strict=True), 1):
            R, p = np.array(placement.rotation), np.array(placement.translation)
            for i, part in enumerate(self._parts(joint, name)):
                label = f"{k}.{part.label}" if part.label else str(k)
                at = (part.R, part.p) if i else (R @ part.R, p + R @ part.p)
                yield _Part(part.type, part.axis, label, *at, part.q, part.v)

    def _follower(self, j: int) -> _Part:
        """How a joint that follows another moves: its motion per rate of that one, divided by the multiplier."""
        scaling = self.pin.joints[j].extract().scaling
        S = np.ravel(self.pin.joints[j].createData().S)
        if S.shape != (6,) or not scaling or not S.any() or (S[:3].any() and S[3:].any()):
            raise self.tree.error(
                f"follows another joint by a motion that is not told (multiplier {scaling}): let it move by itself",
                f'joint "{shortened(self.names[j])}"',
            )
        turns = bool(S[3:].any())
        axis = (S[3:] if turns else S[:3]) / scaling
        return _Part(CONTINUOUS if turns else PRISMATIC, axis, "", np.eye(3), np.zeros(3), -1, -1)

    def _mimic(self, j: int) -> Mimic:
        own = self.pin.joints[j].extract()
        self.tree.note(
            f"joint {self.names[j]!r} follows another, and Pinocchio keeps no damping, friction and armature of its own"
        )
        return Mimic(self.first[int(self.pin.joints[j].idx_v)], float(own.scaling), float(own.offset))

    def _limits(self, part: _Part) -> Limits:
        if not part.type.has_axis or part.v < 0:
            return Limits()
        ranged = part.type != CONTINUOUS
        return Limits(
            lower=limit(self.pin.lowerPositionLimit[part.q]) if ranged else -np.inf,
            upper=limit(self.pin.upperPositionLimit[part.q]) if ranged else np.inf,
            velocity=limit(self.pin.velocityLimit[part.v]),
            effort=limit(self.pin.effortLimit[part.v]),
        )

    def _effects(self, part: _Part, name: str) -> JointEffects:
        """Armature, damping and friction, each one number for all rates of a joint."""
        at, pin = slice(part.v, part.v + part.type.nv), self.pin
        upper, lower = np.array(pin.upperDryFrictionLimit[at]), np.array(pin.lowerDryFrictionLimit[at])
        values = {"armature": pin.armature[at], "damping": pin.damping[at], "friction": upper}
        for key, each in values.items():
            if len(set(each.tolist())) > 1 or (key == "friction" and not np.array_equal(lower, -upper)):
                raise self.tree.error(
                    f"its {key} is {each.tolist()}"
                    + (f", and {lower.tolist()} the other way" if key == "friction" else "")
                    + ": expected one number for all its rates, both ways",
                    f'joint "{shortened(name)}"',
                )
        return JointEffects(**{key: float(each[0]) for key, each in values.items()})

    def _fixed(self, k: int) -> None:
        """A frame that a joint moves along, as a link without mass."""
        frame = self.frames[k]
        carrier = self.frames[frame.parentFrame]
        joint = carrier.name if carrier.type.name == "FIXED_JOINT" and frame.parentFrame else f"{frame.name}_fixed"
        self.tree.add(
            joint=self.tree.name("joint", joint, f"frame_{k}_fixed"),
            link=self.tree.name("link", frame.name, f"frame_{k}"),
            parent=self.links[int(frame.parentJoint)],
            R=np.array(frame.placement.rotation),
            p=np.array(frame.placement.translation),
        )

    def _note_left(self, own: set[int]) -> None:
        """What is not where a URDF has it, and what takes no part."""
        pin, tree = self.pin, self.tree
        merged = [
            frame.name
            for k, frame in enumerate(self.frames)
            if k not in own and (frame.inertia.mass or frame.inertia.inertia.any())
        ]
        if merged:
            tree.note(
                f"the inertia at {listed(merged)} is part of the link that holds it, as Pinocchio has added it up: "
                "F, N, f, n of that link are those of the sum, and links on fixed joints have no mass"
            )
        tree.note_effects("Pinocchio's rnea", left_out=False)
        if np.any(pin.rotorInertia):
            tree.note("rotorInertia is set, which neither Pinocchio's rnea nor tau uses: what counts is armature")
        if np.any(pin.gravity.angular):
            tree.note("the angular part of gravity is left out, which Pinocchio's rnea has", left_out=True)


def _is_identity(placement: Any) -> bool:
    return np.array_equal(placement.rotation, np.eye(3)) and not np.any(placement.translation)
