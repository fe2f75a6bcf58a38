"""Robotics Toolbox: `Robot.rne`, whose loop over states is in Python."""

from __future__ import annotations

import numpy as np
from protocol import Job, Work, serve

MOST = 100


def prepare(job: Job) -> Work:
    from roboticstoolbox import Robot

    with job.bare_file() as path:
        robot = Robot.URDF(path)
    joint_of = {child: joint for joint, (_, child) in job.tree.items()}
    links = sorted((link for link in robot.links if link.isjoint), key=lambda link: link.jindex)
    names = [joint_of[link.name] for link in links]
    q, v, a = job.columns(names)
    tau = np.empty_like(v)

    def run() -> None:
        tau[:] = robot.rne(q, v, a, gravity=job.gravity)

    return Work(run, lambda: job.torques(names, tau), note=f"Robot.rne, first {len(q)} states")


if __name__ == "__main__":
    serve(["roboticstoolbox-python"], prepare, MOST)
