"""A CasADi function (q, v, a) -> tau as generated C code, called in a C loop over all states."""

from __future__ import annotations

import ctypes
import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from compiled import ROWS, build
from protocol import Array, Job, Work

LOOP = """
#include <stdlib.h>
void run(long states, int nv, int threads, const double* q, const double* v, const double* a, double* tau) {
  casadi_int n_arg, n_res, n_iw, n_w;
  rnea_work(&n_arg, &n_res, &n_iw, &n_w);
  #pragma omp parallel num_threads(threads)
  {
    const double** arg = malloc(n_arg * sizeof *arg);
    double** res = malloc(n_res * sizeof *res);
    casadi_int* iw = malloc((n_iw + 1) * sizeof *iw);
    double* w = malloc((n_w + 1) * sizeof *w);
    #pragma omp for schedule(static)
    for (long k = 0; k < states; k++) {
      arg[0] = q + k * nv; arg[1] = v + k * nv; arg[2] = a + k * nv; res[0] = tau + k * nv;
      rnea(arg, res, iw, w, 0);
    }
    free(arg); free(res); free(iw); free(w);
  }
}
"""


def work(job: Job, rnea: Any, names: Sequence[str], note: str) -> Work:
    """The work of a peer whose function is CasADi's; `names` are its joints in order."""
    library = build(_generated(rnea) + LOOP)
    library.run.argtypes = [ctypes.c_long, ctypes.c_int, ctypes.c_int, ROWS, ROWS, ROWS, ROWS]
    q, v, a = job.columns(names)
    tau: Array = np.empty_like(v)
    return Work(
        run=lambda: library.run(len(q), len(names), job.threads, q, v, a, tau),
        result=lambda: job.torques(names, tau),
        note=f"{note}; C of {rnea.n_instructions()} instructions, gcc, OpenMP",
    )


def _generated(rnea: Any) -> str:
    """CasADi's C code of a function, under the name `rnea`."""
    import casadi

    inputs = rnea.sx_in() if rnea.is_a("SXFunction") else rnea.mx_in()
    named = casadi.Function("rnea", inputs, [rnea(*inputs)]).expand("rnea")
    here = Path.cwd()
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)  # the generator takes a file name, no path
        try:
            named.generate("rnea.c")
        finally:
            os.chdir(here)
        return Path(folder, "rnea.c").read_text()
