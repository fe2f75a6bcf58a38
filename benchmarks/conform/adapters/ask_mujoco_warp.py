"""MuJoCo Warp: `mjw.inverse`, on the processor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import mujoco_model
import numpy as np
from door import TREES, Adapter, Array, Robot, States, serve


class MujocoWarp(Adapter):
    packages = ("mujoco-warp", "mujoco", "warp-lang")
    offers = TREES | {"floating", "armature", "damping"}
    words: ClassVar[Mapping[str, str]] = {"friction": mujoco_model.FRICTION}
    call = "mjw.inverse(model, data); data.qfrc_inverse.numpy()"
    conventions = f"{mujoco_model.CONVENTIONS}; many states as worlds"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        import mujoco_warp
        import warp

        if real is not np.float32:
            raise ValueError("MuJoCo Warp computes in float32 alone")
        warp.config.quiet = True
        warp.set_device("cpu")
        self.library, self.warp = mujoco_warp, warp
        self.source, self.names = mujoco_model.load(robot)
        self.model, self.data = mujoco_warp.put_model(self.source), None

    def inputs(self, states: States) -> Any:
        if self.data is None or self.data.nworld != len(states):
            self.data = self.library.make_data(self.source, nworld=len(states))
        arrays = mujoco_model.inputs(self.robot, self.names, states)
        return tuple(self.warp.array(np.ascontiguousarray(x, np.float32), dtype=self.warp.float32) for x in arrays)

    def run(self, inputs: Any) -> Any:
        data = self.data
        for target, x in zip((data.qpos, data.qvel, data.qacc), inputs, strict=True):
            self.warp.copy(target, x)
        self.library.inverse(self.model, data)
        return data.qfrc_inverse.numpy()

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        return {"tau": self.torques(*mujoco_model.base(self.robot, np.asarray(raw, np.float64), states))}


if __name__ == "__main__":
    serve(MujocoWarp)
