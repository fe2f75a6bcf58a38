"""What adds up on each of Pinocchio's joints, in its formulas: sizes over scalars, outwards and inwards."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from rttrr_pin.compile.formula import Sizes
from rttrr_pin.compile.variant import fingerprint
from rttrr_pin.core.algebra import ZERO, Vector
from rttrr_pin.core.arrays import norm
from rttrr_pin.core.dynamics import bodies, joint_states
from rttrr_pin.core.energy import link_states
from rttrr_pin.core.joints.base import JointState
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import LinkMotion, outwards
from rttrr_pin.core.scalars import EPS
from rttrr_pin.implementations.allowance import add_inwards
from rttrr_pin.implementations.library import Scales, norms
from rttrr_pin.implementations.pinocchio_links import PinLinks
from rttrr_pin.implementations.pinocchio_parallel import FEATHER

OPERATIONS = 4
"""Roundings on the way of each term over one joint: a vector product, a sum, a change of frame."""

WAY = OPERATIONS * EPS

Columns = list[Any]
"""A scalar for each joint or link."""


@dataclass(frozen=True, slots=True)
class LoadAt:
    """Where a payload acts.

    Attributes:
        link: index of the link.
        turned: over how many oblique joints it was turned from base axes into the link's.
    """

    link: int
    turned: int


AppliedLoad = tuple[LoadAt, Any, Any]
"""Where a payload acts, and the sizes of its force and moment."""


class JointSizes(NamedTuple):
    """By Pinocchio's joint, the universe first.

    Attributes:
        acceleration: what adds up to that of the origin [m/s^2].
        turning: what adds up to |w_dot| + |w|^2 [1/s^2].
        force, moment: what adds up to what crosses it, at its origin [N, N m].
        reach: at most how far its origin is from that of the joint further in [m].
    """

    acceleration: Columns
    turning: Columns
    force: Columns
    moment: Columns
    reach: Columns


class PinSizes:
    """The sizes in Pinocchio's formulas, of a robot with payloads at certain links.

    Attributes:
        loads: where.
    """

    def __init__(
        self,
        model: Model,
        pin_model: Any,
        links: PinLinks,
        apart: Mapping[int, Scales],
        loads: Sequence[tuple[int, bool]],
    ) -> None:
        """Arguments as of `Rounding`."""
        self._model, self._links = model, links
        self._parents = [int(parent) for parent in pin_model.parents]
        self._oblique = [_is_oblique(joint) for joint in pin_model.joints]
        counts: list[int] = []  # how many oblique joints there are from each one inward, itself included
        for own, parent in zip(self._oblique, self._parents, strict=True):
            counts.append(own + (counts[parent] if counts else 0))
        self.loads = [LoadAt(link, counts[links.joint[link]] if in_base else 0) for link, in_base in loads]
        self._lengths = norms(x.translation for x in pin_model.jointPlacements).tolist()
        self._inertias(pin_model, apart)

    @property
    def identity(self) -> str:
        """All numbers that the sizes depend on."""
        arrays = (self._mass, self._lever, self._tensor, self._off_lever, *self._links)
        own = (self._parents, self._oblique, self.loads, self._lengths, [x.tobytes() for x in arrays])
        return repr((fingerprint(self._model), own))

    def at(self, sizes: Sizes, x: Mapping[str, Sequence[Any]], loads: Sequence[AppliedLoad]) -> JointSizes:
        """The sizes at a state: its q, v, a."""
        states = joint_states(self._model, sizes.arithmetic, x["q"], x["v"], x["a"])
        reach = self._reach(sizes, states)
        speed, acceleration, turning = self._motion(sizes, states, reach)
        force, moment = self._forces(speed, acceleration, turning, loads, reach)
        return JointSizes(acceleration, turning, force, moment, reach)

    def _inertias(self, pin_model: Any, apart: Mapping[int, Scales]) -> None:
        """Sizes of what Pinocchio has on each joint, and how far they may be off, in the unit of all sizes here."""
        inertias = pin_model.inertias
        self._mass = norms(inertia.mass for inertia in inertias)  # a size, also where a file has it negative
        self._lever, self._tensor = norms(x.lever for x in inertias), norms(x.inertia for x in inertias)
        off = np.array([apart.get(joint, (0.0, 0.0, 0.0)) for joint in range(len(inertias))]).reshape(-1, 3) / WAY
        for load in self.loads:  # a feather weighs something
            off[self._links.joint[load.link], [0, 2]] += FEATHER / WAY
        self._mass, self._tensor, self._off_lever = self._mass + off[:, 0], self._tensor + off[:, 2], off[:, 1]

    def _reach(self, sizes: Sizes, states: Sequence[JointState]) -> Columns:
        """At most how far each joint's origin is from that of the joint further in [m]."""
        reach: Columns = [*self._lengths]
        for i, (joint, state) in enumerate(zip(self._model.joints, states, strict=True)):
            lengths = sum(own.unit == "m" for own in joint.type.coordinates)  # they come first
            if lengths:
                at = int(self._links.joint[i])
                reach[at] = sizes.norm(state.q[:lengths]) + reach[at]
        return reach

    def _motion(self, sizes: Sizes, states: Sequence[JointState], reach: Columns) -> tuple[Columns, Columns, Columns]:
        """|v_O| of each joint, and what adds up to its acceleration and to |w_dot| + |w|^2; the universe first."""
        model, number = self._model, sizes.arithmetic.number
        links = bodies(model, sizes.arithmetic)
        gravity = Vector.of(model.gravity, lambda value: number(value, 0.0))
        base, motions = LinkMotion(ZERO, ZERO, -gravity), list[LinkMotion]()
        moving = link_states(model, links, states, sizes.arithmetic)
        n = len(self._parents)
        speed: Columns = [0.0] * n
        acceleration: Columns = [float(norm(model.gravity))] + [0.0] * (n - 1)
        turning: Columns = [0.0] * n
        for i, (joint, body, state) in enumerate(zip(model.joints, links, states, strict=True)):
            parent = motions[joint.parent] if joint.parent >= 0 else base
            motions.append(outwards(body, state, parent, sizes.arithmetic.sincos, lambda x: x)[1])
            if not self._links.fixed[i]:
                j = int(self._links.joint[i])
                p, w = self._parents[j], sizes.norm(motions[i].w)
                spatial = motions[i].v_dot - motions[i].w.cross(moving[i].v)
                speed[j] = sizes.norm(moving[i].v)
                turning[j] = sizes.norm(motions[i].w_dot) + w * w + turning[p]
                acceleration[j] = sizes.norm(spatial) + w * speed[j] + acceleration[p] + reach[j] * turning[p]
        return speed, acceleration, turning

    def _forces(
        self,
        speed: Columns,
        acceleration: Columns,
        turning: Columns,
        loads: Sequence[AppliedLoad],
        reach: Columns,
    ) -> tuple[Columns, Columns]:
        """What adds up to the force and the moment that cross each joint, at its origin."""
        n, inwards = len(self._parents), [-1, *self._parents[1:]]
        force, moment = list[Any](), list[Any]()
        for j in range(n):
            m, c, off, tensor = (float(x[j]) for x in (self._mass, self._lever, self._off_lever, self._tensor))
            force.append((acceleration[j] + turning[j] * (c + off)) * m)
            momentum = speed[j] * speed[j] + acceleration[j] * (c + off) + turning[j] * (c * (c + 2 * off))
            moment.append(momentum * m + turning[j] * tensor)
        again_force: Columns = [0.0] * n  # sizes of what rounds more than once
        again_moment: Columns = [0.0] * n
        for at, f, of_moment in loads:
            j = int(self._links.joint[at.link])
            about_origin = of_moment + f * float(self._links.arm[at.link])
            force[j], moment[j] = force[j] + f, moment[j] + about_origin
            again_force[j], again_moment[j] = again_force[j] + f * at.turned, again_moment[j] + about_origin * at.turned
        add_inwards(inwards, force, moment, reach)
        for j, is_oblique in enumerate(self._oblique):
            if is_oblique:
                p = self._parents[j]
                again_force[p] = again_force[p] + force[j]
                again_moment[p] = again_moment[p] + moment[j] + reach[j] * force[j]
        add_inwards(inwards, again_force, again_moment, reach)
        return [x + y for x, y in zip(force, again_force, strict=True)], [
            x + y for x, y in zip(moment, again_moment, strict=True)
        ]


def _is_oblique(joint: Any) -> bool:
    """Whether a joint turns about an axis that is none of x, y, z: -z is one."""
    kind = joint.shortname()
    return "Revolute" in kind and "Unaligned" in kind
