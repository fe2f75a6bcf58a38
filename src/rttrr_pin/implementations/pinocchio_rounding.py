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
from typing import Any

import numpy as np

from rttrr_pin.compile.formula import Formula, Sizes
from rttrr_pin.core.arrays import Array, flat, norm
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.implementations.allowance import HANDOVER, of_carriers
from rttrr_pin.implementations.library import Scales, norms
from rttrr_pin.implementations.pinocchio_links import PinLinks, acting, carriers
from rttrr_pin.implementations.pinocchio_parallel import FEATHER
from rttrr_pin.implementations.pinocchio_sizes import WAY, AppliedLoad, Columns, PinSizes
from rttrr_pin.implementations.protocol import Batch


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
        self._sizes = PinSizes(model, pin_model, links, apart, loads)
        self._carrier, self._acts = carriers(model, links), acting(model, links)
        n = len(model.links)
        widths = {"q": model.nq, "v": model.nv, "a": model.nv, "tau_joint": model.nv}
        widths |= {f"{kind}_{key}": 3 * n for key in LINK_QUANTITIES for kind in ("value", "bound")}
        widths |= {f"load_{k}_{name}": 3 for k in range(len(loads)) for name in "fn"}
        outputs = {"tau": model.nv} | dict.fromkeys(LINK_QUANTITIES, n)
        self._formula = Formula(self._allowance, widths, outputs, self._sizes.identity if compiled else None)

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
        links = self._links
        loads = [
            (at, sizes.norm(x[f"load_{k}_f"]), sizes.norm(x[f"load_{k}_n"])) for k, at in enumerate(self._sizes.loads)
        ]
        acceleration, turning, force, moment, reach = self._sizes.at(sizes, x, loads)
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
        for load in self._sizes.loads:
            if self._links.joint[load.link] == self._links.joint[link]:
                arm = float(self._links.arm[load.link])
                weight = (acceleration + turning * arm) * FEATHER
                sizes = _plus(sizes, weight, turning * FEATHER, arm + float(self._links.arm[link]))
        return sizes

    def _crossing(
        self, values: Mapping[str, Columns], loads: Sequence[AppliedLoad], reach: Columns
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


def _finite(values: Array) -> Array:
    """The values, and 0 for what is not finite: it excuses nothing."""
    return values if np.isfinite(values).all() else np.where(np.isfinite(values), values, 0.0)
