"""Dynibo (Rust): `Robot.inverse_dynamics` in a Python loop.

Its gravity is 9.80665 m/s^2 for good. What is missing to the states' gravity is added afterwards, in proportion to
its own `gravity(q)`, and not timed.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from protocol import Array, Job, Work, serve

MOST = 20_000
ITS_GRAVITY = np.array([0.0, 0.0, -9.80665])


def prepare(job: Job) -> Work:
    from dynibo import Robot

    if job.gravity[:2].any():
        raise SystemExit(f"dynibo's gravity is vertical, the states have {job.gravity}")
    with job.bare_file() as path:
        robot = Robot.from_urdf(path)
    names = joint_order(robot, job.tree)
    q, v, a = job.columns(names)
    tau: Array = np.empty_like(v)

    def run() -> None:
        for k in range(len(q)):
            robot.inverse_dynamics(q[k], v[k], a[k], out=tau[k])

    def result() -> Array:
        missing = job.gravity[2] / ITS_GRAVITY[2] - 1
        return job.torques(names, tau + missing * np.array([robot.gravity(x) for x in q]))

    return Work(run, result, note=f"Python loop, first {len(q)} states; gravity mended after the timing")


def joint_order(robot: Any, tree: dict[str, tuple[str, str]]) -> list[str]:
    """The names of Dynibo's joints, which it does not tell: the coordinate that moves the child but not the parent."""
    count, order, moved = robot.joint_count, [""] * robot.joint_count, {}
    for link in {link for ends in tree.values() for link in ends}:
        jacobian = np.array(robot.jacobian(np.full(count, 0.1), robot.link_id(link)))
        moved[link] = set(np.flatnonzero(jacobian.reshape(count, 6).any(axis=1)))
    for joint, (parent, child) in tree.items():
        for k in moved[child] - moved[parent]:
            order[k] = joint
    return order


if __name__ == "__main__":
    serve(["dynibo"], prepare, MOST)
