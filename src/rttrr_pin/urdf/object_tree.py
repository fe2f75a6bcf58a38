"""The tree that the readers of other libraries' objects build: link by link, with what had to be said about it.

A reader calls `add` for each joint, parents first, and `model` at the end. What the object cannot say in our words is
refused by `error`, or noted; names that a URDF cannot hold are replaced, and that is noted too.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any, Literal

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint, JointEffects, Limits, Mimic
from rttrr_pin.core.joints import FIXED, JointType
from rttrr_pin.core.model import Link, Model, Note
from rttrr_pin.errors import InputError, UrdfError, listed, shortened

ROUNDED, NEARLY = 8 * float(np.finfo(float).eps), 1e-9
"""How far a matrix may be from the nearest rotation to be taken as it stands, and to be taken at all."""

UNLIMITED = 1e300
"""Libraries write the largest double where there is no limit."""


class ObjectTree:
    """A robot under construction.

    Attributes:
        source: what to call the object in messages.
    """

    def __init__(self, source: str) -> None:
        self.source = source
        self._root = Link("world")
        self._links: list[Link] = []
        self._joints: list[Joint] = []
        self._names: dict[str, set[str]] = {"link": set(), "joint": set()}
        self._notes: list[Note] = []
        self._renamed: list[str] = []

    def error(self, message: str, element: str = "") -> UrdfError:
        """An error at an element of the object."""
        return UrdfError(message, source=self.source, element=element)

    def note(self, text: str, left_out: bool = False, friction: bool = False) -> None:
        """Something that the user must know, see `Note`."""
        self._notes.append(Note(text, left_out, friction))

    def note_effects(self, why: str, left_out: bool) -> None:
        """What the joints take themselves, and whether tau has it."""
        by_effect = {
            key: [joint.name for joint in self._joints if getattr(joint.effects, key)]
            for key in ("armature", "damping", "friction")
        }
        if by_effect["armature"]:
            self.note(f"armature is part of tau, as in {why}: {listed(by_effect['armature'])}")
        del by_effect["armature"]
        if any(by_effect.values()):
            each = "; ".join(f"{key} of {listed(names)}" for key, names in by_effect.items() if names)
            self.note(f"no part of tau unless asked for (friction=True, --friction): {each}", left_out, friction=True)

    def name(self, kind: Literal["link", "joint"], own: str, otherwise: str) -> str:
        """The name of a link or joint: its own, unless that is blank, taken, or no text of XML."""
        clean = "".join(letter if letter.isprintable() else "_" for letter in own) if own.strip() else otherwise
        name, number = clean, 1
        while name in self._names[kind]:
            number += 1
            name = f"{clean}_{number}"
        self._names[kind].add(name)
        if name != own and own:
            self._renamed.append(f"{kind} {shortened(own)!r} is {name!r}")
        return name

    def root(self, name: str, inertial: tuple[float, Array, Array] | None = None) -> None:
        """The link that carries all others."""
        self._root = self._link(self.name("link", name, "world"), inertial)

    def add(
        self,
        joint: str,
        link: str,
        parent: int,
        R: Any,
        p: Any,
        type: JointType = FIXED,
        axis: Any = (1.0, 0.0, 0.0),
        inertial: tuple[float, Array, Array] | None = None,
        limits: Limits | None = None,
        effects: JointEffects | None = None,
        mimic: Mimic | None = None,
    ) -> int:
        """A joint and the link that it carries, with names from `name`.

        Args:
            joint: the joint's name.
            link: the link's.
            parent: index of the link that carries the joint; -1 is the root.
            R: maps vectors of the joint frame to the parent's, (3, 3).
            p: its origin there, (3,) [m].
            type: how it moves.
            axis: along which, of any length.
            inertial: mass [kg], centre of mass [m], and the tensor about it [kg m^2] in link axes.
            limits: what it may do.
            effects: what it takes itself.
            mimic: whom it follows.

        Returns:
            The link's index.

        Raises:
            UrdfError: numbers that no robot has.
        """
        where = f'joint "{shortened(joint)}"'
        axis = np.array(axis, dtype=float)
        if type.has_axis:
            length = np.linalg.norm(axis)
            if not 0.0 < length < np.inf:
                raise self.error(f"its axis is {axis.tolist()}, which has no direction", where)
            axis = axis / length
        limits = limits or Limits()
        if limits.lower > limits.upper:
            raise self.error(f"lower limit {limits.lower} is above the upper one, {limits.upper}: exchange them", where)
        for key, value in asdict(effects := effects or JointEffects()).items():
            if not 0.0 <= value < np.inf:
                raise self.error(f"its {key} is {value}: expected a finite number that is not negative", where)
        direction = type.axis_direction
        try:
            joint_read = Joint(
                name=joint,
                type=type,
                parent=parent,
                R=self._rotation(np.array(R, dtype=float), where),
                p=np.array(p, dtype=float),
                axis=axis if direction is None else np.array(direction),
                limits=limits,
                mimic=mimic,
                effects=effects,
            )
        except InputError as error:
            raise self.error(str(error)) from None
        self._links.append(self._link(link, inertial))
        self._joints.append(joint_read)
        return len(self._links) - 1

    def follow(self, joint: int, mimic: Mimic) -> None:
        """Let a joint follow another, which may come later."""
        self._joints[joint] = replace(self._joints[joint], mimic=mimic)

    def model(self, name: str, gravity: Sequence[float] | Array) -> Model:
        """The robot."""
        if self._renamed:
            self.note(f"names were replaced: {listed(self._renamed)}")
        name = name if name.strip() and name.isprintable() else "robot"
        try:
            return Model(
                name=name,
                root=self._root,
                links=tuple(self._links),
                joints=tuple(self._joints),
                gravity=np.array(gravity, dtype=float),
                notes=tuple(self._notes),
            )
        except InputError as error:
            raise self.error(str(error)) from None

    def _link(self, name: str, inertial: tuple[float, Array, Array] | None) -> Link:
        if inertial is None:
            return Link(name)
        mass, com, tensor = inertial
        try:
            return Link(name, float(mass), np.array(com), np.array(tensor))
        except InputError as error:
            raise self.error(str(error)) from None

    def _rotation(self, R: Array, where: str) -> Array:
        """The matrix, or the rotation nearest to it."""
        if np.isfinite(R).all():
            U, _, V = np.linalg.svd(R)
            off = float(np.abs(U @ V - R).max())
            if off <= ROUNDED and np.linalg.det(R) > 0.0:
                return R
            if off <= NEARLY and np.linalg.det(R) > 0.0:
                self.note(f"{where}: its placement is a rotation only to {off:.1g}; the nearest rotation is taken")
                return np.asarray(U @ V)
        raise self.error(f"its placement {R.tolist()} is no rotation: set a matrix with orthonormal columns", where)


def limit(value: float) -> float:
    """A limit, infinite where a library writes the largest double."""
    return float(value) if abs(value) < UNLIMITED else float(np.copysign(np.inf, value))
