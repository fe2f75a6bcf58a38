"""Pinocchio, `rnea` of a URDF with `<mimic>`: without `mimic=True` the follower is a joint of its own.

    pip install pin==4.1.0

Who fills the joints of the states in by their names, as here, leaves the follower at rest and its force out.
Threads: stack-of-tasks/pinocchio#2725 has the question; `buildModelFromUrdf` documents the option.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from table import Array, States, main


def torques(file: str, states: States) -> dict[str, Array]:
    model = pin.buildModelFromUrdf(file)
    data = model.createData()
    joints = {column[2:]: model.joints[model.getJointId(column[2:])] for column in states if column.startswith("q_")}
    count = len(states[f"q_{next(iter(joints))}"])
    tau = {name: np.empty(count) for name in joints}
    for k in range(count):
        q, v, a = pin.neutral(model), np.zeros(model.nv), np.zeros(model.nv)
        for name, joint in joints.items():
            q[joint.idx_q], v[joint.idx_v], a[joint.idx_v] = (states[f"{letter}_{name}"][k] for letter in "qva")
        pin.rnea(model, data, q, v, a)
        for name, joint in joints.items():
            tau[name][k] = data.tau[joint.idx_v]
    return tau


if __name__ == "__main__":
    main(torques)
