"""Pinocchio's own batch: `rneaInParallel` over a pool of models, on Fortran-ordered (nv, N) arrays."""

from __future__ import annotations

import numpy as np
from protocol import Job, Work, serve


def prepare(job: Job) -> Work:
    import pinocchio as pin

    model = pin.buildModelFromXML(job.bare_urdf())
    model.gravity.linear = job.gravity
    names = list(model.names)[1:]
    continuous = [joint.nq == 2 for joint in list(model.joints)[1:]]
    q, v, a = job.columns(names)
    columns = [(np.cos(x), np.sin(x)) if turns else (x,) for x, turns in zip(q.T, continuous, strict=True)]
    q = np.asfortranarray(np.stack([x for part in columns for x in part]))
    v, a = v.T, a.T  # of C-ordered (N, n): Fortran-ordered (n, N)
    tau = np.zeros_like(v, order="F")
    pool = pin.ModelPool(model, job.threads)
    return Work(
        run=lambda: pin.rneaInParallel(job.threads, pool, q, v, a, tau),
        result=lambda: job.torques(names, tau.T),
        note="rneaInParallel; the wheel is built for any x86-64",
    )


if __name__ == "__main__":
    serve(["pin"], prepare)
