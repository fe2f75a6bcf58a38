"""MuJoCo: `mj_inverse`, and `mj_rnePostConstraint` for what joints carry."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import mujoco_model
import numpy as np
from door import TREES, Adapter, Array, Robot, States, serve


class Mujoco(Adapter):
    packages = ("mujoco",)
    offers = TREES | {"floating", "payload", "armature", "damping"}
    words: ClassVar[Mapping[str, str]] = {"friction": mujoco_model.FRICTION}
    call = "mujoco.mj_inverse(model, data); data.qfrc_inverse"
    conventions = (
        f"{mujoco_model.CONVENTIONS}; payload by mj_applyFT, as mj_inverse leaves xfrc_applied out; f, n from "
        "cfrc_int, which is about the centre of mass of the tree"
    )

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import mujoco

        self.mujoco = mujoco
        self.model, self.names = mujoco_model.load(robot)
        self.data = mujoco.MjData(self.model)

    def inputs(self, states: States) -> Any:
        return (*mujoco_model.inputs(self.robot, self.names, states), states.payload)

    def run(self, inputs: Any) -> Any:
        q, v, a, payload = inputs
        model, data, out = self.model, self.data, np.empty((len(q), self.model.nv))
        data.xfrc_applied[:] = 0.0
        for k in range(len(q)):
            data.qpos, data.qvel, data.qacc = q[k], v[k], a[k]
            self.mujoco.mj_inverse(model, data)
            out[k] = data.qfrc_inverse
            for load in payload:
                self._apply(load, out[k])
        return out

    def _apply(self, load: Any, tau: Array) -> None:
        body = self.model.body(load.link).id
        R, at = self.data.xmat[body].reshape(3, 3), self.data.xpos[body]
        f, n = R @ load.f[0], R @ load.n[0]
        self.mujoco.mj_applyFT(self.model, self.data, f, n, at, body, tau)
        self.data.xfrc_applied[body] = [*-f, *-(n + np.cross(at - self.data.xipos[body], f))]

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        out = {"tau": self.torques(*mujoco_model.base(self.robot, raw, states))}
        if len(states) > 1:
            return out
        model, data = self.model, self.data
        self.mujoco.mj_rnePostConstraint(model, data)
        f, n = np.zeros((2, 1, len(self.robot.links), 3))
        for i, link in enumerate(self.robot.links):
            body = model.body(link).id
            R, (moment, force) = data.xmat[body].reshape(3, 3), np.split(data.cfrc_int[body], 2)
            lever = data.subtree_com[model.body_rootid[body]] - data.xpos[body]
            f[0, i], n[0, i] = R.T @ force, R.T @ (moment + np.cross(lever, force))
        return out | {"f": f, "n": n}


if __name__ == "__main__":
    serve(Mujoco)
