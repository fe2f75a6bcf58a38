"""adam on CasADi symbols, as generated C code: tau = M(q) a + h(q, v), as it has no RNEA with accelerations."""

from __future__ import annotations

import numpy as np
from adam_model import load
from casadi_code import work
from protocol import Job, Work, serve


def prepare(job: Job) -> Work:
    import casadi
    from adam.casadi import KinDynComputations

    robot, names = load(job, KinDynComputations)
    base, still = np.eye(4), np.zeros(6)
    q, v, a = (casadi.SX.sym(x, len(names)) for x in "qva")
    inertia = robot.mass_matrix_fun()(base, q)[6:, 6:]
    bias = robot.bias_force_fun()(base, q, still, v)[6:]
    rnea = casadi.Function("rnea", [q, v, a], [casadi.cse(inertia @ a + bias)])
    return work(job, rnea, names, "mass matrix times a plus bias force")


if __name__ == "__main__":
    serve(["adam-robotics", "casadi"], prepare)
