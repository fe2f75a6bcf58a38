"""iDynTree: `KinDynComputations.inverseDynamics` in a Python loop."""

from __future__ import annotations

import numpy as np
from protocol import Array, Job, Work, serve

MOST = 5_000


def prepare(job: Job) -> Work:
    import idyntree.bindings as idt

    loader = idt.ModelLoader()
    names = [*job.joints, *sorted(job.followers)]
    if not loader.loadReducedModelFromString(job.bare_urdf(), names):
        raise SystemExit("iDynTree refuses the URDF")
    robot = idt.KinDynComputations()
    robot.loadRobotModel(loader.model())
    robot.setFloatingBase(job.root_link)
    q, v, a = job.columns(names)
    tau: Array = np.empty_like(v)
    none = idt.LinkWrenches(robot.model())
    none.zero()
    generalized = idt.FreeFloatingGeneralizedTorques(robot.model())
    base, still = np.eye(4), np.zeros(6)

    def run() -> None:
        for k in range(len(q)):
            robot.setRobotState(base, q[k], still, v[k], job.gravity)
            robot.inverseDynamics(still, a[k], none, generalized)
            tau[k] = generalized.jointTorques().toNumPy()

    return Work(run, lambda: job.torques(names, tau), note=f"Python loop, first {len(q)} states")


if __name__ == "__main__":
    serve(["idyntree"], prepare, MOST)
