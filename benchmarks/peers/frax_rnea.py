"""frax: its vectorized RNEA in JAX."""

from __future__ import annotations

import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import jax_batch
import numpy as np
from protocol import Job, Work, serve


def prepare(job: Job) -> Work:
    jax_batch.start()
    from frax.core.robot import Robot

    names = [*job.joints, *sorted(job.followers)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "robot.urdf")
        path.write_text(with_root_inertia(job))
        robot = Robot(str(path), joint_ordering=names)
    if list(robot.joint_names) != names:
        raise SystemExit(f"frax orders the joints as {robot.joint_names}")
    upwards = np.array([*-job.gravity, 0.0, 0.0, 0.0])  # linear before angular

    def rnea(q: Any, v: Any, a: Any) -> Any:
        return robot.rnea(q, v, a, upwards, None)

    return jax_batch.work(job, rnea, names, "Robot.rnea")


def with_root_inertia(job: Job) -> str:
    """The robot's text; frax wants an inertia of the root link too, which has no part in tau."""
    urdf = ET.fromstring(job.bare_urdf())
    (root,) = (link for link in urdf.findall("link") if link.get("name") == job.root_link)
    if root.find("inertial") is None:
        inertial = ET.SubElement(root, "inertial")
        ET.SubElement(inertial, "origin", xyz="0 0 0", rpy="0 0 0")
        ET.SubElement(inertial, "mass", value="1")
        ET.SubElement(inertial, "inertia", ixx="1", ixy="0", ixz="0", iyy="1", iyz="0", izz="1")
    return ET.tostring(urdf, encoding="unicode")


if __name__ == "__main__":
    serve(["frax"], prepare, jax_batch.MOST)
