"""Robotics Toolbox for Python, `Robot.rne` of a URDF: up to 1.4.0 it drops links that are fixed behind the last joint.

    pip install roboticstoolbox-python==1.4.0 "spatialmath-python<1.1.18"

Thread: petercorke/robotics-toolbox-python#636.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import roboticstoolbox
from table import Array, States, main


def torques(file: str, states: States) -> dict[str, Array]:
    robot = roboticstoolbox.Robot.URDF(Path(file).resolve())
    joints = [column[2:] for column in states if column.startswith("q_")]  # in URDF's order, here the toolbox's too
    q, v, a = (np.column_stack([states[f"{letter}_{joint}"] for joint in joints]) for letter in "qva")
    tau = robot.rne(q, v, a, gravity=[0.0, 0.0, -9.81])
    return dict(zip(joints, tau.T, strict=True))


if __name__ == "__main__":
    main(torques)
