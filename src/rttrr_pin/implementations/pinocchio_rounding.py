"""How far rounding may take Pinocchio's results: a formula over scalars, compiled for a robot.

Spatial accelerations and momenta about the joint's origin O contain terms that cancel in the result: w x v_O in `a_gf`,
v_O x m v_O and m |c|^2 (|w_dot| + |w|^2) in the moment. The recursion has none of them, so that its bound does not
cover what they round. Beside them:

- Rotations about an axis that is not x, y or z itself, -z for one, come from 1 - cos q, so that even what lies along
  the axis is rounded when it is carried over the joint, and over each further one once more. The recursion carries it
  over exactly, and its bound knows.
- Inertias of links fixed together were merged when the model was built, and are apart from the file's. Payloads go to
  the body's origin, in the joint's axes, where they may cancel.
- What crosses a fixed joint goes to the body's origin and back to the link's, in axes that are not quite orthogonal.

Sizes add up like the terms: outwards for velocities and accelerations, inwards for forces and moments.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rttrr_pin.compile.formula import Formula, Sizes
from rttrr_pin.compile.variant import fingerprint
from rttrr_pin.core.algebra import ZERO, Vector
from rttrr_pin.core.arrays import Array, flat, norm
from rttrr_pin.core.dynamics import bodies, joint_states
from rttrr_pin.core.energy import link_states
from rttrr_pin.core.joints.base import JointState
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import LinkMotion, outwards
from rttrr_pin.core.scalars import EPS
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.implementations.allowance import HANDOVER, of_carriers
from rttrr_pin.implementations.library import Scales, norms
from rttrr_pin.implementations.pinocchio_links import PinLinks, carriers, where_inertia_acts
from rttrr_pin.implementations.pinocchio_parallel import FEATHER
from rttrr_pin.implementations.protocol import Batch

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


class Rounding:
    """The allowance of Pinocchio's results with payloads at certain links."""

    def __init__(
        self,
        model: Model,
        pin_model: Any,
        links: PinLinks,
        apart: Mapping[int, Scales],
        loads: Sequence[tuple[int, bool]],
        compiled: bool,
    ) -> None:
        """Compile the formula.

        Args:
            model: the robot, with the axes that Pinocchio has.
            pin_model: Pinocchio's.
            links: where it has the links.
            apart: by Pinocchio's joint, how far the inertia of a merged body may be from the file's.
            loads: of each payload its link, and whether it was turned from base axes.
            compiled: whether the formula is to be compiled.
        """
        self._model, self._links = model, links
        self._parents = [int(parent) for parent in pin_model.parents]
        self._oblique = [_is_oblique(joint) for joint in pin_model.joints]
        counts: list[int] = []  # how many oblique joints there are from each one inward, itself included
        for own, parent in zip(self._oblique, self._parents, strict=True):
            counts.append(own + (counts[parent] if counts else 0))
        self._loads = [LoadAt(link, counts[links.joint[link]] if in_base else 0) for link, in_base in loads]
        self._lengths = norms(x.translation for x in pin_model.jointPlacements).tolist()
        self._inertias(pin_model, apart)
        self._carrier = carriers(model, links)
        self._acts = where_inertia_acts(links, self._carrier)
        n = len(model.links)
        widths = {"q": model.nq, "v": model.nv, "a": model.nv, "tau_joint": model.nv}
        widths |= {f"{kind}_{key}": 3 * n for key in LINK_QUANTITIES for kind in ("value", "bound")}
        widths |= {f"load_{k}_{name}": 3 for k in range(len(loads)) for name in "fn"}
        outputs = {"tau": model.nv} | dict.fromkeys(LINK_QUANTITIES, n)
        self._formula = Formula(self._allowance, widths, outputs, self._identity() if compiled else None)

    def __call__(self, batch: Batch, values: Mapping[str, Array], tau_joint: Array) -> dict[str, Array]:
        """At most how far Pinocchio's results are from the true values, by rounding: tau (N, nv), others (N, links)."""
        rows, bounds = len(batch), batch.bounds
        arrays = {"q": batch.q, "v": batch.v, "a": batch.a, "tau_joint": tau_joint}
        for key in LINK_QUANTITIES:
            arrays[f"value_{key}"] = flat(_finite(values[key]))
            arrays[f"bound_{key}"] = flat(getattr(bounds, key))
        for k, load in enumerate(batch.loads):
            arrays |= {f"load_{k}_f": np.atleast_2d(load.f), f"load_{k}_n": np.atleast_2d(load.n)}
        return {key: x.T for key, x in self._formula(rows, arrays).items()}

    def _identity(self) -> str:
        """All numbers that the formula depends on."""
        arrays = (self._mass, self._lever, self._tensor, self._off_lever, *self._links)
        own = (self._parents, self._oblique, self._loads, self._lengths, [x.tobytes() for x in arrays])
        return repr((fingerprint(self._model), own))

    def _inertias(self, pin_model: Any, apart: Mapping[int, Scales]) -> None:
        """Sizes of what Pinocchio has on each joint, and how far they may be off, in the unit of all sizes here."""
        inertias = pin_model.inertias
        self._mass = norms(inertia.mass for inertia in inertias)  # a size, also where a file has it negative
        self._lever, self._tensor = norms(x.lever for x in inertias), norms(x.inertia for x in inertias)
        off = np.array([apart.get(joint, (0.0, 0.0, 0.0)) for joint in range(len(inertias))]).reshape(-1, 3) / WAY
        for load in self._loads:  # a feather weighs something
            off[self._links.joint[load.link], [0, 2]] += FEATHER / WAY
        self._mass, self._tensor, self._off_lever = self._mass + off[:, 0], self._tensor + off[:, 2], off[:, 1]

    def _allowance(self, sizes: Sizes, x: Mapping[str, Sequence[Any]]) -> dict[str, Columns]:
        """The recursion's bound of the whole vector, handing over, and what rounds in Pinocchio's formulas."""
        values, bounds = (
            {
                key: [sizes.norm(x[f"{kind}_{key}"][3 * i : 3 * i + 3]) for i in range(len(self._model.links))]
                for key in LINK_QUANTITIES
            }
            for kind in ("value", "bound")
        )
        own = self._rounded(sizes, x, values)
        wide = {
            key: [
                bound + size + value * HANDOVER
                for bound, size, value in zip(bounds[key], own[key], values[key], strict=True)
            ]
            for key in LINK_QUANTITIES
        }
        handed = [sizes.size(force) * HANDOVER for force in x["tau_joint"]]
        return {"tau": [a + b for a, b in zip(of_carriers(self._model, wide), handed, strict=True)]} | wide

    def _rounded(
        self, sizes: Sizes, x: Mapping[str, Sequence[Any]], values: Mapping[str, Columns]
    ) -> dict[str, Columns]:
        """By quantity and link, what rounds in Pinocchio's formulas and not in the recursion's."""
        links, loads = (
            self._links,
            [(at, sizes.norm(x[f"load_{k}_f"]), sizes.norm(x[f"load_{k}_n"])) for k, at in enumerate(self._loads)],
        )
        states = joint_states(self._model, sizes.arithmetic, x["q"], x["v"], x["a"])
        reach = self._reach(sizes, states)
        speed, acceleration, turning = self._motion(sizes, states, reach)
        force, moment = self._forces(speed, acceleration, turning, loads, reach)
        crossing = self._crossing(values, loads, reach)
        joint, arm = links.joint.tolist(), links.arm.tolist()
        mass, lever, tensor = np.abs(links.mass).tolist(), norms(links.com).tolist(), norms(links.inertia).tolist()
        out: dict[str, Columns] = {key: [] for key in LINK_QUANTITIES}
        for i, j in enumerate(joint):
            out["F"].append((acceleration[j] + turning[j] * (arm[i] + lever[i])) * (WAY * mass[i]))
            out["N"].append(turning[j] * (WAY * tensor[i]))
            own = (force[j] * WAY, (moment[j] + force[j] * arm[i]) * WAY)
            if not self._acts[i]:
                own = self._of_feathers(i, acceleration[j], turning[j])
            out["f"].append(own[0] + crossing[i][0])
            out["n"].append(own[1] + crossing[i][1])
        return out

    def _of_feathers(self, link: int, acceleration: Any, turning: Any) -> tuple[Any, Any]:
        """What moves the feathers behind a link that carries nothing else, on one body with it."""
        sizes: tuple[Any, Any] = (0.0, 0.0)
        for load in self._loads:
            if self._links.joint[load.link] == self._links.joint[link]:
                arm = float(self._links.arm[load.link])
                weight = (acceleration + turning * arm) * FEATHER
                sizes = _plus(sizes, weight, turning * FEATHER, arm + float(self._links.arm[link]))
        return sizes

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
        loads: Sequence[tuple[LoadAt, Any, Any]],
        reach: Columns,
    ) -> tuple[Columns, Columns]:
        """What adds up to the force and the moment that cross each joint, at its origin."""
        n = len(self._parents)
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
        self._add_inwards(force, moment, reach)
        for j, is_oblique in enumerate(self._oblique):
            if is_oblique:
                p = self._parents[j]
                again_force[p] = again_force[p] + force[j]
                again_moment[p] = again_moment[p] + moment[j] + reach[j] * force[j]
        self._add_inwards(again_force, again_moment, reach)
        return [x + y for x, y in zip(force, again_force, strict=True)], [
            x + y for x, y in zip(moment, again_moment, strict=True)
        ]

    def _add_inwards(self, force: Columns, moment: Columns, reach: Columns) -> None:
        for j in reversed(range(1, len(force))):
            p = self._parents[j]
            force[p] = force[p] + force[j]
            moment[p] = moment[p] + moment[j] + reach[j] * force[j]

    def _crossing(
        self, values: Mapping[str, Columns], loads: Sequence[tuple[LoadAt, Any, Any]], reach: Columns
    ) -> list[tuple[Any, Any]]:
        """Of f and n across each fixed joint, what rounds on the way to the body's origin and back; else nothing.

        In axes that are not quite orthogonal, a vector does not come back as it was: as far as they are apart here,
        and what our own product rounds.
        """
        links, joints = self._links, self._links.joint.tolist()
        behind: list[tuple[Any, Any]] = [(0.0, 0.0)] * len(joints)  # sizes of force and moment at the body's origin
        for i, carrier in enumerate(self._carrier):
            if links.fixed[i]:
                force, lever = values["F"][i], float(norm(links.com[i]))
                behind[i] = _plus(behind[i], force, values["N"][i] + force * lever, float(links.arm[i]))
            elif carrier >= 0:
                behind[carrier] = _plus(behind[carrier], values["f"][i], values["n"][i], reach[joints[i]])
        for at, force, moment in loads:
            if links.fixed[at.link] and (carrier := self._carrier[at.link]) >= 0:
                times = 1 + at.turned
                behind[carrier] = _plus(behind[carrier], force * times, moment * times, float(links.arm[at.link]))
        for i, carrier in reversed(list(enumerate(self._carrier))):
            if links.fixed[i] and carrier >= 0:
                behind[carrier] = _plus(behind[carrier], *behind[i], 0.0)
        there_and_back = 2 * WAY + (links.stretch + WAY)
        out = [
            (force * share, (moment + force * arm) * share)
            for (force, moment), share, arm in zip(behind, there_and_back.tolist(), links.arm.tolist(), strict=True)
        ]
        for at, force, moment in loads:
            if links.fixed[at.link]:
                out[at.link] = _plus(out[at.link], force * (WAY * at.turned), moment * (WAY * at.turned), 0.0)
        return out


def _plus(sizes: tuple[Any, Any], force: Any, moment: Any, arm: Any) -> tuple[Any, Any]:
    """The sizes with those of a force and moment at the end of an arm."""
    return sizes[0] + force, sizes[1] + moment + force * arm


def _is_oblique(joint: Any) -> bool:
    """Whether a joint turns about an axis that is none of x, y, z: -z is one."""
    kind = joint.shortname()
    return "Revolute" in kind and "Unaligned" in kind


def _finite(values: Array) -> Array:
    """The values, and 0 for what is not finite: it excuses nothing."""
    return values if np.isfinite(values).all() else np.where(np.isfinite(values), values, 0.0)
