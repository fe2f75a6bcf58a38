"""adam on JAX: tau = M(q) a + h(q, v), as it has no RNEA with accelerations."""

from __future__ import annotations

from typing import Any

import jax_batch
import numpy as np
from adam_model import load
from protocol import Job, Work, serve


def prepare(job: Job) -> Work:
    jax_batch.start()
    from adam.jax import KinDynComputations

    robot, names = load(job, KinDynComputations)
    base, still = np.eye(4), np.zeros(6)

    def rnea(q: Any, v: Any, a: Any) -> Any:
        return robot.mass_matrix(base, q)[6:, 6:] @ a + robot.bias_force(base, q, still, v)[6:]

    return jax_batch.work(job, rnea, names, "mass matrix times a plus bias force")


if __name__ == "__main__":
    serve(["adam-robotics"], prepare, jax_batch.MOST)
