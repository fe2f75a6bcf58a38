"""Drake: `MultibodyPlant.CalcInverseDynamics` in a Python loop."""

from __future__ import annotations

import numpy as np
from protocol import Array, Job, Work, serve

MOST = 5_000


def prepare(job: Job) -> Work:
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import MultibodyForces

    plant = MultibodyPlant(0.0)
    (robot,) = Parser(plant).AddModelsFromString(job.bare_urdf(), "urdf")
    if job.root_link != "world":  # which Drake takes for its own
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(job.root_link))
    plant.mutable_gravity_field().set_gravity_vector(job.gravity)
    plant.Finalize()
    context, forces = plant.CreateDefaultContext(), MultibodyForces(plant)
    joints = [plant.get_joint(k) for k in plant.GetJointIndices(robot)]
    moving = sorted((joint for joint in joints if joint.num_velocities()), key=lambda joint: joint.velocity_start())
    names = [joint.name() for joint in moving]
    q, v, a = job.columns(names)
    both = np.hstack([q, v])
    tau: Array = np.empty_like(v)

    def run() -> None:
        for k in range(len(q)):
            plant.SetPositionsAndVelocities(context, both[k])
            plant.CalcForceElementsContribution(context, forces)  # gravity
            tau[k] = plant.CalcInverseDynamics(context, a[k], forces)

    return Work(run, lambda: job.torques(names, tau), note=f"Python loop, first {len(q)} states")


if __name__ == "__main__":
    serve(["drake"], prepare, MOST)
