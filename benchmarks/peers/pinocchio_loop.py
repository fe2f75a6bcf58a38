"""Pinocchio as most people call it: `pin.rnea` in a Python loop."""

from __future__ import annotations

import numpy as np
from protocol import Array, Job, Work, serve

MOST = 20_000


def prepare(job: Job) -> Work:
    import pinocchio as pin

    model = pin.buildModelFromXML(job.bare_urdf())
    model.gravity.linear = job.gravity
    data, names = model.createData(), list(model.names)[1:]
    q, v, a = job.columns(names)
    if model.nq != model.nv:
        raise SystemExit("continuous joints have two coordinates in Pinocchio: not measured here")
    tau: Array = np.empty_like(v)

    def run() -> None:
        for k in range(len(q)):
            tau[k] = pin.rnea(model, data, q[k], v[k], a[k])

    return Work(run, lambda: job.torques(names, tau), note=f"Python loop, first {len(q)} states")


if __name__ == "__main__":
    serve(["pin"], prepare, MOST)
