"""The robot as a user holds it: ask it for inverse dynamics (`loading` makes it)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arguments import not_negative
from rttrr_pin.core.inputs import finite, real, vectors
from rttrr_pin.core.joint import EFFECTS, JointEffects
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.payload import payload_link
from rttrr_pin.errors import InputError, UnknownNameError, shortened
from rttrr_pin.robot.identification import Identification
from rttrr_pin.robot.statics import Statics


class Robot(Identification, Statics):
    """A robot and its dynamics.

    Coordinates q are (..., nq) [rad or m], rates v and accelerations a (..., nv) [rad/s or m/s, rad/s^2 or m/s^2]; or
    dicts by joint name. nq is nv, but for floating joints, which have x, y, z and a unit quaternion (x, y, z, w);
    continuous joints take their angle. The rates of a planar or floating joint are the twist in {i}. Leading axes are
    batches, and broadcast, those of payloads too. A payload is what the robot exerts on its surroundings; there are
    several where several links do.

    Every method that takes them raises:

    - ShapeError: an array has not one value for each joint, or leading axes do not broadcast.
    - NumberError: a value is NaN, inf, complex, ..., or so large that the result overflows.
    - UnknownNameError, MissingJointError: a dict's keys, or the payload's link, do not exist.
    """

    def __repr__(self) -> str:
        joints = ", ".join(f"{joint.name} ({joint.type})" for joint in self.model.moving)
        return f"<Robot {self.name!r}: {joints or 'no moving joint'}>"

    def with_joint_effects(self, effects: Mapping[str, JointEffects]) -> Robot:
        """The same robot, whose joints take torque themselves.

        Args:
            effects: by joint name: armature (rotor inertia times gear ratio squared), damping, Coulomb friction. Joints
                left out keep what they have.

        Returns:
            A robot whose tau contains tau_joint = armature a + damping v + friction sign(v); f and n are the same.

        Raises:
            UnknownNameError: no joint that moves is called so.
            NumberError: a number is not finite, or is negative.
        """
        moving = [joint.name for joint in self.model.joints if joint.nv]
        if not isinstance(effects, Mapping):
            raise InputError(f"effects is a {type(effects).__name__}: pass a dict from joint name to JointEffects(...)")
        checked: dict[str, JointEffects] = {}
        for name, own in effects.items():
            if name not in moving:
                raise UnknownNameError("moving joint", name, moving)
            if not isinstance(own, JointEffects):
                raise InputError(
                    f"the entry of joint {name!r} is a {type(own).__name__}: pass JointEffects(armature=...)"
                )
            numbers = [not_negative(f"{x} of joint {name!r}", getattr(own, x), x, name) for x in EFFECTS]
            checked[name] = JointEffects(*numbers)
        joints = tuple(replace(joint, effects=checked.get(joint.name, joint.effects)) for joint in self.model.joints)
        return Robot(replace(self.model, joints=joints))

    def with_payload_body(
        self,
        mass: float,
        com: ArrayLike = (0.0, 0.0, 0.0),
        inertia: ArrayLike | None = None,
        link: str | None = None,
        name: str = "payload",
    ) -> Robot:
        """The same robot, carrying a body: a link more, the last one, on a fixed joint that tells what holds the body.

        The text that other programs read has the link too.

        Args:
            mass: of the body [kg].
            com: its centre of mass from the origin of the link that carries it, in that link's axes, (3,) [m].
            inertia: its tensor about its centre of mass in the same axes, (3, 3) [kg m^2], with URDF's signs;
                None for a point.
            link: the link that carries it; None: the tool, that is the robot's only last link.
            name: of the new link; its joint is called so with `_joint` behind.

        Raises:
            UnknownNameError: no link is called so.
            NumberError: a number is not finite, or the mass is negative.
            InputError: the tensor is not symmetric, or the name is taken.
        """
        from rttrr_pin.core import altered

        kilograms = not_negative("mass", mass)
        tensor = np.zeros((3, 3)) if inertia is None else finite("inertia", real("inertia", inertia))
        body = Link(name, kilograms, vectors("com", com), tensor)
        parent = payload_link(self.model, link)
        model = altered.with_body(self.model, body, parent)
        if model.document is not None:
            from rttrr_pin.urdf.altered import with_body  # loads lxml

            document = with_body(model.document, body, model.joints[-1], model.links[parent].name)
            model = replace(model, document=document)
        return Robot(model)

    def with_locked(self, joints: Mapping[str, ArrayLike]) -> Robot:
        """The same robot, some of whose joints stand still; they have no place in q, v, a and tau any more.

        A joint that follows a locked one stands still with it. Links, and the forces across them, stay as they are, and
        the place of a locked link is as exact as it is at that coordinate. The text that other programs read has fixed
        joints there.

        Args:
            joints: by name of a moving joint the coordinate at which it is locked [rad or m]; of a joint with several
                coordinates all of them. These doubles are exact. Of a floating base the joint is called `root_joint`:
                its seven are the pose at which the base is fixed then.

        Raises:
            UnknownNameError: no joint that moves by itself is called so.
            NumberError: the length of a quaternion is not 1 to rounding.
        """
        from rttrr_pin.core import altered

        model = altered.with_locked(self.model, joints)
        if model.document is not None:
            from rttrr_pin.urdf.altered import with_fixed  # loads lxml

            model = replace(model, document=with_fixed(model.document, model))
        return Robot(model)


def model_of(robot: object) -> Model:
    """The model of what should be a robot.

    Raises:
        InputError: it is something else.
    """
    if not isinstance(robot, Robot):
        source = repr(shortened(robot)) if isinstance(robot, str) else "..."
        raise InputError(f"robot is a {type(robot).__name__}: pass a Robot, such as rttrr_pin.load({source})")
    return robot.model
