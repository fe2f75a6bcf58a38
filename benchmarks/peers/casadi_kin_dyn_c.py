"""casadi-kin-dyn: Pinocchio's RNEA on CasADi symbols, as generated C code."""

from __future__ import annotations

import numpy as np
from casadi_code import work
from protocol import Job, Work, serve

ITS_GRAVITY = (0.0, 0.0, -9.81)
"""Pinocchio's default, which casadi-kin-dyn gives no way to change."""


def prepare(job: Job) -> Work:
    from casadi_kin_dyn import CasadiKinDyn

    if not np.array_equal(job.gravity, ITS_GRAVITY):
        raise SystemExit(f"casadi-kin-dyn knows gravity {ITS_GRAVITY} only, the states have {job.gravity}")
    robot = CasadiKinDyn(job.bare_urdf())
    names = robot.joint_names()[1:]
    if robot.nq() != robot.nv():
        raise SystemExit("continuous joints have two coordinates in casadi-kin-dyn: not measured here")
    return work(job, robot.rnea(), names, "Pinocchio's RNEA on CasADi's SX")


if __name__ == "__main__":
    serve(["cmeel-casadi-kin-dyn", "pin", "cmeel-casadi"], prepare)
