"""The robot as a user holds it: ask it for inverse dynamics (`loading` makes it)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, cast, overload

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arguments import choice, names_of, not_negative
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import common_shape
from rttrr_pin.core.dynamics import bodies
from rttrr_pin.core.inertia import SpatialInertia
from rttrr_pin.core.inputs import Coordinates, coordinates, finite, real, vectors
from rttrr_pin.core.joint import EFFECTS, JointEffects
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.payload import Payloads, load_of, loads_of, payload_link
from rttrr_pin.core.scalars import FLOAT
from rttrr_pin.core.wrench import RESULTS, LinkWrenches, Wrench
from rttrr_pin.errors import InputError, UnknownNameError, shortened

if TYPE_CHECKING:  # what few robots are asked for is loaded when one is
    from rttrr_pin.compile import Kernel
    from rttrr_pin.core.identification import BaseParameters
    from rttrr_pin.core.statics import WrenchEstimate
    from rttrr_pin.exact.enclosures import Enclosures
    from rttrr_pin.exact.parameters import Parameters


class Robot:
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

    def __init__(self, model: Model) -> None:
        if not isinstance(model, Model):
            raise InputError(f"model is a {type(model).__name__}: pass a Model; load(...) makes robots of files")
        self._model = model
        self._kernels: dict[object, Kernel[Any]] = {}

    @property
    def model(self) -> Model:
        """Its links and joints as data; another model is another robot, `Robot(model)`."""
        return self._model

    def __reduce__(self) -> tuple[object, ...]:
        """The data alone: a copy, or another process, compiles or reads its own kernels."""
        return type(self), (self.model,)

    def __repr__(self) -> str:
        joints = ", ".join(f"{joint.name} ({joint.type})" for joint in self.model.moving)
        return f"<Robot {self.name!r}: {joints or 'no moving joint'}>"

    @property
    def name(self) -> str:
        """The robot's name in its file."""
        return self.model.name

    @property
    def joint_names(self) -> tuple[str, ...]:
        """The moving joints: the last axis of q, v, a and tau."""
        return self.model.joint_names

    @property
    def link_names(self) -> tuple[str, ...]:
        """The links axis of F, N, f, n: every link but the root, which no joint carries."""
        return self.model.link_names

    def inverse_dynamics(
        self, q: Coordinates, v: Coordinates, a: Coordinates, payload: Payloads = None
    ) -> LinkWrenches:
        """Driving forces and all joint loads for given motion, by the Newton-Euler recursion.

            F_i = M_i v_dot_Ci                              (paper, equations 16-22)
            N_i = I_i w_dot_i + w_i x I_i w_i               (23-30)
            f_i = F_i + sum over children c of R_ic f_c     (31-43)
            n_i = N_i + r_Ci x F_i + sum over c of (R_ic n_c + p_ic x R_ic f_c)
            tau_i = n_i (revolute) or f_i (prismatic) along the axis, plus tau_joint (see `JointEffects`)

        A joint that follows another (<mimic>) has no coordinate of its own; what drives it is part of the other's tau,
        times the multiplier.

        It is always compiled code that answers (`compile`), and a state has the same bits alone, in every batch and in
        every layout. The first call compiles, or reads what another process has compiled before.

        Returns:
            tau (..., nv) and F, N, f, n (..., links, 3), the latter in {i}, the frame of each link.
        """
        parts = self._kernel(RESULTS)(q, v, a, payload)
        return LinkWrenches.of(parts, self.link_names, self.model.v_names)

    def enclose(
        self,
        q: Coordinates,
        v: Coordinates,
        a: Coordinates,
        payload: Payloads = None,
        parameters: Parameters = "doubles",
    ) -> Enclosures:
        """Enclose the true tau, F, N, f, n between two doubles each, by interval arithmetic at rising precision.

        Every enclosure is proven, and as narrow as doubles allow: one double or two neighbours, except near zero (see
        `rttrr_pin.exact.enclose`). The coordinates are exact doubles. A floating joint's quaternion rotates by the
        matrix that the formula yields, also where its length is 1 only to rounding.

        What is true depends on whose numbers are meant, and the three lie apart: on Panda `"doubles"` and `"read"` do
        in 4 percent of the values, `"read"` and `"text"` in 15 percent. `parameters` names the choice, and the result
        repeats it:

        - `"doubles"`, the default: the numbers that `inverse_dynamics` computes with, rounded rotations and axes
          included. Right for what rounding in the recursion alone does.
        - `"read"`: the doubles nearest to the file's decimals, and everything computed from them exactly. Right where
          programs are judged that read the file themselves; `validate` does it so.
        - `"text"`: the same from the decimals themselves. Right for the robot that the file describes.

        Returns:
            `.tau` (..., nv) and `.F`, `.N`, `.f`, `.n` (..., links, 3), each with `.lower` and `.upper`, in the frames
            and units of `inverse_dynamics`.

        Raises:
            InputError: there are no such parameters: the robot has no file, or was altered since it was read.
        """
        from rttrr_pin.exact.enclosures import enclose

        q, v, a = (coordinates(name, x, self.model.moving) for name, x in (("q", q), ("v", v), ("a", a)))
        return enclose(self.model, q, v, a, loads_of(self.model, payload), parameters)

    @overload
    def compile(self, outputs: str = "tau", emitter: str | None = None) -> Kernel[Array]: ...

    @overload
    def compile(self, outputs: tuple[str, ...] | list[str], emitter: str | None = None) -> Kernel[dict[str, Array]]: ...

    def compile(self, outputs: str | Sequence[str] = "tau", emitter: str | None = None) -> Kernel[Any]:
        """Compile the robot's dynamics for this processor.

        Args:
            outputs: what to compute, one name or several: `"tau"`, `"F"`, `"N"`, `"f"`, `"n"`, `"tau_joint"`,
                `"mass_matrix"`, `"nonlinear_effects"`, `"gravity_torque"`, `"regressor"`, `"joint_regressor"` (of
                armature and friction), `"link_jacobians"` and `"link_placements"` (of every link: velocity of the
                origin over angular velocity, in {i}; R_0_i and p_0_i), `"dtau_dq"`, `"dtau_dv"`, `"dtau_da"`; and each
                of them with `"_bound"` behind, a bound on its rounding. The fewer, the faster.
            emitter: `"llvm"` (machine code), `"numpy"` (wherever NumPy runs) or `"c"` (by the C compiler);
                None for what is there.

        Returns:
            A kernel, `kernel(q, v, a, payload=None, out=None, threads=None)`.

        Raises:
            UnknownNameError: there is no such output, or no such emitter.
            InputError: no output, or one twice; or the emitter cannot be imported.
        """
        names = names_of("outputs", outputs)
        if emitter is not None and not isinstance(emitter, str):
            raise InputError(f"emitter is {emitter!r}: pass its name, such as 'llvm', or None")
        return self._kernel(outputs if isinstance(outputs, str) else names, emitter)

    def _kernel(self, outputs: str | tuple[str, ...], emitter: str | None = None) -> Kernel[Any]:
        kernel = self._kernels.get((outputs, emitter))
        if kernel is None:
            from rttrr_pin.compile import Kernel

            kernel = self._kernels[outputs, emitter] = Kernel(self.model, outputs, emitter)
        return kernel

    def mass_matrix(self, q: Coordinates) -> Array:
        """The mass matrix M(q), armature included, (..., nv, nv) [kg m^2, kg m or kg]; symmetric to the last bit.

        tau = M a + nonlinear effects.
        """
        return cast("Array", self._kernel("mass_matrix")(q))

    def nonlinear_effects(self, q: Coordinates, v: Coordinates) -> Array:
        """The driving forces without acceleration, (..., nv) [N m or N]: Coriolis, centrifugal, gravity, friction."""
        return cast("Array", self._kernel("nonlinear_effects")(q, v))

    def gravity_torque(self, q: Coordinates) -> Array:
        """The driving forces that hold the robot still, (..., nv) [N m or N]."""
        return cast("Array", self._kernel("gravity_torque")(q))

    def regressor(self, q: Coordinates, v: Coordinates, a: Coordinates, joint_effects: bool = False) -> Array:
        """Y(q, v, a), (..., nv, 10 links), by which the driving forces are linear: tau - tau_joint = Y pi.

        pi is `inertial_parameters()`: of each link m, m c_x, m c_y, m c_z, I_xx, I_xy, I_yy, I_xz, I_yz, I_zz with the
        tensor about the origin of {i} (Pinocchio's order). Fixed links have columns of their own. With `joint_effects`
        three columns follow for each joint that moves, those that follow others included: a, v and sign(v), which its
        armature, damping and Coulomb friction multiply; then tau = Y pi.
        """
        Y = cast("Array", self._kernel("regressor")(q, v, a))
        if not joint_effects:
            return Y
        return np.concatenate([Y, cast("Array", self._kernel("joint_regressor")(q, v, a))], axis=-1)

    def inertial_parameters(self, joint_effects: bool = False) -> Array:
        """The parameters that `regressor` multiplies, ten for each link, and three for each joint that moves."""
        parameters: list[Any] = []
        for body in bodies(self.model, FLOAT):
            link = SpatialInertia.of(body.M, body.r_C, body.I)
            x, y, z = link.J.rows
            parameters += [link.m, *link.h, x.x, x.y, y.y, x.z, y.z, z.z]
        if joint_effects:
            moving = (joint.effects for joint in self.model.joints if joint.nv)
            parameters += [getattr(own, name) for own in moving for name in EFFECTS]
        return np.array(parameters, dtype=np.float64)

    def base_parameters(self, joint_effects: bool = False, tolerance: float = 1e-9) -> BaseParameters:
        """The parameters that motion can tell: a basis of the regressor's columns, and the map to it from all.

            tau - tau_joint = Y pi = Y_b pi_b,   pi_b = B pi      (Gautier and Khalil, 1990; by QR, Gautier, 1991)

        A trajectory is judged by `base.condition(robot.regressor(q, v, a))`.

        Args:
            joint_effects: whether armature, damping and Coulomb friction are parameters too; then tau = Y_b pi_b.
            tolerance: how far a column may be from the span of those before it to depend on them, relative to the
                largest of its kind (`BaseParameters.tolerance`).
        """
        from rttrr_pin.core.exciting import as_forces, random_motion
        from rttrr_pin.core.identification import base_parameters, parameter_names

        names = parameter_names(self.model, joint_effects)
        Y = self.regressor(*random_motion(self.model, len(names)), joint_effects)
        return base_parameters(names, as_forces(self.model, Y), tolerance)

    def jacobian(
        self,
        q: Coordinates,
        link: str | None = None,
        point: ArrayLike = (0.0, 0.0, 0.0),
        expressed_in: Literal["link", "base"] = "link",
    ) -> Array:
        """J(q), (..., 6, nv), by which a point of a link moves: (velocity of the point, angular velocity) = J v.

        Args:
            q: coordinates.
            link: the link; None: the tool, that is the robot's only last link.
            point: from the origin of the link's frame, in the link's axes, (..., 3) [m].
            expressed_in: the axes of both velocities: `"link"` or `"base"`.

        Raises:
            InputError: there are no such axes; or several last links and no name.
        """
        from rttrr_pin.core import statics

        choice("expressed_in", expressed_in, "link", "base")
        i = payload_link(self.model, link)
        parts = self._kernel(("link_jacobians", "link_placements"))(q)
        J, r = parts["link_jacobians"][..., i, :, :], vectors("point", point)
        common_shape({"q": J.shape[:-2], "point": r.shape[:-1]})
        J = statics.at_point(J, r)
        return statics.turned(J, parts["link_placements"][..., i, :, :3]) if expressed_in == "base" else J

    def wrench_torque(self, q: Coordinates, wrench: Wrench, point: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
        """The driving forces that a wrench at a point of a link takes, to be added to tau: J^T w, (..., nv) [N m or N].

        A wrench is what the robot exerts on its surroundings, also here: of what acts on the robot, pass the opposite.

        Args:
            q: coordinates.
            wrench: force, and moment about the point.
            point: from the origin of the link's frame, in the link's axes, (..., 3) [m].
        """
        load = load_of(self.model, wrench)
        J = self.jacobian(q, wrench.link, point, wrench.expressed_in)
        common_shape({"q and point": J.shape[:-2], "force": load.f.shape[:-1], "moment": load.n.shape[:-1]})
        w = np.concatenate(np.broadcast_arrays(load.f, load.n), axis=-1)
        return np.asarray(np.einsum("...ij,...i->...j", J, w))

    def wrench_from_torque(
        self,
        q: Coordinates,
        tau: Coordinates,
        link: str | None = None,
        point: ArrayLike = (0.0, 0.0, 0.0),
        expressed_in: Literal["link", "base"] = "link",
        tolerance: float = 1e-9,
    ) -> WrenchEstimate:
        """The wrench at a point of a link that explains driving forces best, by least squares; its rank is told.

        Args:
            q: coordinates.
            tau: what the wrench adds to the driving forces, (..., nv) [N m or N]: measured ones less those of
                `inverse_dynamics`.
            link: as in `jacobian`.
            point: the same.
            expressed_in: the axes of force and moment.
            tolerance: singular values of J at most this part of the largest count as zero.

        Returns:
            What the robot exerts on its surroundings; where joints do not feel all six components, of the wrenches that
            explain tau the smallest.
        """
        from rttrr_pin.core import statics

        J = self.jacobian(q, link, point, expressed_in)
        driving = coordinates("tau", tau, self.model.moving)
        common_shape({"q and point": J.shape[:-2], "tau": driving.shape[:-1]})
        return statics.estimate(J, driving, tolerance)

    def derivatives(
        self, q: Coordinates, v: Coordinates, a: Coordinates, payload: Payloads = None
    ) -> tuple[Array, Array, Array]:
        """The exact derivatives of the driving forces, by dual numbers.

        Coordinates of planar and floating joints move as their rates say (the tangent, as Pinocchio has it); the
        payload stays as it is in the axes in which it was given; the jump of Coulomb friction at rest is left out.

        Returns:
            d tau / dq, d tau / dv, d tau / da, each (..., nv, nv), row i of tau_i.
        """
        parts = self._kernel(("dtau_dq", "dtau_dv", "dtau_da"))(q, v, a, payload)
        return parts["dtau_dq"], parts["dtau_dv"], parts["dtau_da"]

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
