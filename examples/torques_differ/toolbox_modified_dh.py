"""Robotics Toolbox for Python, `DHRobot.rne_python` with modified parameters: wrong up to 1.3.1, for two reasons.

    pip install roboticstoolbox-python==1.3.1 "spatialmath-python<1.1.18"

Threads: petercorke/robotics-toolbox-python#266, #268, #326, #404. `rne`, written in C, is right: `WRITTEN = "rne"`.
"""

from __future__ import annotations

from math import pi

import numpy as np
from roboticstoolbox import DHRobot, RevoluteMDH
from table import Array, States, main

WRITTEN = "rne_python"


def link(m: float, r: list[float], I: list[float], **geometry: float) -> RevoluteMDH:
    """A link of the arm; I is xx, yy, zz, xy, yz, xz about the centre of mass."""
    return RevoluteMDH(m=m, r=r, I=I, Jm=0.0, G=1.0, B=0.0, Tc=[0.0, 0.0], **geometry)


ARM = DHRobot(  # modified_dh.urdf
    [
        link(4.0, [0.02, -0.03, -0.08], [0.03, 0.028, 0.015, 0.002, 0.003, -0.001], d=0.3),
        link(2.5, [0.2, 0.01, 0.04], [0.005, 0.03, 0.029, 0.001, -0.0004, 0.0006], a=0.05, alpha=-pi / 2),
        link(1.2, [0.11, -0.02, 0.03], [0.002, 0.008, 0.0075, -0.0003, 0.0001, 0.0002], a=0.42, alpha=0.4, d=0.07),
    ],
)


def torques(file: str, states: States) -> dict[str, Array]:
    del file  # the toolbox has the parameters, not the file
    joints = [f"joint_{k + 1}" for k in range(ARM.n)]
    q, v, a = (np.column_stack([states[f"{letter}_{joint}"] for joint in joints]) for letter in "qva")
    tau = getattr(ARM, WRITTEN)(q, v, a, gravity=[0.0, 0.0, -9.81])
    return dict(zip(joints, np.atleast_2d(tau).T, strict=True))


if __name__ == "__main__":
    main(torques)
