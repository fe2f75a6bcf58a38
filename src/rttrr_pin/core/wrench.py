"""A force with a moment: what a payload is, and what the recursion returns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arguments import choice
from rttrr_pin.core.arrays import Array, Rebuilt
from rttrr_pin.core.inputs import Coordinates, coordinates, vectors
from rttrr_pin.errors import InputError, ShapeError, UnknownNameError

if TYPE_CHECKING:
    from rttrr_pin.core.joint_wrenches import JointWrenches
    from rttrr_pin.core.model import Model

LINK_QUANTITIES = ("F", "N", "f", "n")
"""One vector for each link."""

QUANTITIES = ("tau", *LINK_QUANTITIES)
"""What is compared, in the order of reports."""

RESULTS = (*QUANTITIES, "tau_joint")
"""The arrays of `LinkWrenches`."""


@dataclass(frozen=True, eq=False)
class Wrench(Rebuilt):
    """What the robot exerts on its surroundings at a link: the paper's payload 6f6, 6n6, equation (8).

    A gripper that carries a weight W presses it *up* with W, so the payload's force points up; it is minus what the
    surroundings exert on the robot (Pinocchio's fext).

    Attributes:
        force: f_tool, (..., 3) [N].
        moment: n_tool about the origin of the link frame, (..., 3) [N m].
        link: the link whose frame it acts at; None: the tool, that is the robot's only last link.
        expressed_in: the axes of force and moment: `"link"` (that link's frame) or `"base"`.

    Force and moment are kept as read-only copies, float64, so that a wrench never changes.

    Raises:
        InputError: there are no such axes.
        ShapeError, NumberError: force or moment is no vector of finite numbers.
    """

    force: ArrayLike
    moment: ArrayLike = (0.0, 0.0, 0.0)
    link: str | None = None
    expressed_in: Literal["link", "base"] = "link"

    def __post_init__(self) -> None:
        choice("payload expressed_in", self.expressed_in, "link", "base")
        for name in ("force", "moment"):
            own = np.array(vectors(f"payload {name}", getattr(self, name)))
            own.setflags(write=False)
            object.__setattr__(self, name, own)


@dataclass(frozen=True, eq=False, slots=True)
class LinkWrenches:
    """The result of inverse dynamics, joint by joint and link by link.

    Everything but `tau` is expressed in {i}, the frame of the link that it belongs to.

    Attributes:
        tau: generalised driving forces, the component of n (revolute) or f (prismatic) along the axis, plus
            tau_joint, (..., nv) [N m or N].
        F: net force on the link, mass times acceleration of its centre of mass with gravity as an upward
            acceleration of the base, (..., links, 3) [N]. Not f, the force that crosses the joint.
        N: net moment on the link about its centre of mass, (..., links, 3) [N m].
        f: force that the parent link exerts on the link, (..., links, 3) [N].
        n: moment that the parent link exerts on the link, about the origin of {i}, (..., links, 3) [N m].
        tau_joint: the part of tau that the joint itself takes (armature, friction), which its bearing does not carry.
        links: the names along the links axis.
        joints: the names along the last axis of tau.
        model: the robot; None where that is not known.
        q: a copy of the coordinates that were passed; None likewise.
    """

    tau: Array
    F: Array
    N: Array
    f: Array
    n: Array
    tau_joint: Array
    links: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()
    model: Model | None = None
    q: Coordinates | None = None

    @classmethod
    def of(
        cls,
        parts: Mapping[str, Array],
        links: tuple[str, ...],
        joints: tuple[str, ...],
        model: Model | None = None,
        q: Coordinates | None = None,
    ) -> LinkWrenches:
        """The five quantities by name, with the names along their axes."""
        return cls(**{key: parts[key] for key in RESULTS}, links=links, joints=joints, model=model, q=q)

    def in_convention(self, name: str) -> JointWrenches:
        """The wrenches of the joints as another program says them: its axes, point, sign and order.

        The table of programs is docs/wrenches.md. Links that a program merges into others have no number there; here
        they have what would cross their joint.

        Args:
            name: `"pinocchio"`, `"mujoco"`, `"drake"`, `"isaaclab"`, `"gazebo"`, `"newton"` or `"featherstone"`.

        Raises:
            UnknownNameError: there is no such convention.
            InputError: the result is of no robot: it was not made by `Robot.inverse_dynamics`.
        """
        from rttrr_pin.core.conventions import convention
        from rttrr_pin.core.joint_wrenches import joint_wrenches

        row = convention(name)
        if self.model is None or self.q is None:
            raise InputError("this result does not say where its links are: ask that of Robot.inverse_dynamics")
        return joint_wrenches(row, self.model, self._whole(self.q, self.model), self.f, self.n)

    def _whole(self, q: Coordinates, model: Model) -> Array:
        """The coordinates of each state of the batch, (..., nq)."""
        return np.broadcast_to(coordinates("q", q, model.moving), (*self.tau.shape[:-1], model.nq))

    def at(self, name: str) -> dict[str, Array]:
        """What acts at one link, by quantity; for the name of a moving joint that no link has too, `{"tau": ...}`.

        Of a joint with several rates, tau has an axis of them; each also has a name, such as `"root_joint.rz"`.

        Raises:
            UnknownNameError: neither a link nor a moving joint is called so.
        """
        if not isinstance(name, str):
            raise UnknownNameError("link or moving joint", name, (*self.links, *self.joints))
        if name in self.links:
            i = self.links.index(name)
            return {key: getattr(self, key)[..., i, :] for key in LINK_QUANTITIES}
        if name in self.joints:
            return {"tau": self.tau[..., self.joints.index(name)]}
        own = [k for k, label in enumerate(self.joints) if label.rpartition(".")[0] == name]
        if own:
            return {"tau": self.tau[..., own]}
        raise UnknownNameError("link or moving joint", name, (*self.links, *self.joints))

    def items(self) -> Iterator[tuple[str, Array]]:
        """The five quantities with their names, in the order of reports."""
        return ((key, getattr(self, key)) for key in QUANTITIES)

    def __getitem__(self, index: int | slice) -> LinkWrenches:
        """The same for one state or some states of a batch.

        Raises:
            ShapeError: there is no batch axis.
        """
        if self.tau.ndim == 1:
            raise ShapeError(
                "the result is of one state and has no batch axis: read .tau, .f, ... or .at(name)",
                name="result",
                got=self.tau.shape,
                wanted="(..., nv) with a batch axis in front",
            )
        parts = {key: getattr(self, key)[index] for key in RESULTS}
        q = self.q
        if self.model is not None and q is not None:
            q = (q if isinstance(q, np.ndarray) and q.ndim == self.tau.ndim else self._whole(q, self.model))[index]
        return LinkWrenches.of(parts, self.links, self.joints, self.model, q)
