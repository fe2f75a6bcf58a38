"""MuJoCo's fastest route to tau: kinematics, centres of mass, velocities, `mj_rne`, in a C loop.

`mj_inverse` does more than inverse dynamics needs (mass matrix and its factors, tendons, sensors), and
`mujoco.rollout` and `mujoco.batch` step forward dynamics only.
"""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
from compiled import ROWS, build
from mujoco_model import load
from protocol import Array, Job, Work, serve

LOOP = """
#include <mujoco/mujoco.h>
#include <string.h>
void run(const mjModel* m, long states, int threads, const double* q, const double* v, const double* a, double* tau) {
  size_t row = m->nv * sizeof(double);
  #pragma omp parallel num_threads(threads)
  {
    mjData* d = mj_makeData(m);
    #pragma omp for schedule(static)
    for (long k = 0; k < states; k++) {
      memcpy(d->qpos, q + k * m->nv, row);
      memcpy(d->qvel, v + k * m->nv, row);
      memcpy(d->qacc, a + k * m->nv, row);
      mj_kinematics(m, d);
      mj_comPos(m, d);
      mj_comVel(m, d);
      mj_rne(m, d, 1, tau + k * m->nv);
    }
    mj_deleteData(d);
  }
}
"""


def prepare(job: Job) -> Work:
    import mujoco

    model, names = load(job)
    root = Path(mujoco.__file__).parent
    shared = next(root.glob("libmujoco.so.*"))
    library = build(LOOP, [f"-I{root / 'include'}", f"-L{root}", f"-l:{shared.name}", f"-Wl,-rpath,{root}"])
    library.run.argtypes = [ctypes.c_void_p, ctypes.c_long, ctypes.c_int, ROWS, ROWS, ROWS, ROWS]
    q, v, a = job.columns(names)
    tau: Array = np.empty_like(v)
    return Work(
        run=lambda: library.run(model._address, len(q), job.threads, q, v, a, tau),
        result=lambda: job.torques(names, tau),
        note="mj_kinematics, mj_comPos, mj_comVel, mj_rne in a C loop, OpenMP",
    )


if __name__ == "__main__":
    serve(["mujoco"], prepare)
