"""A JAX function of one state (q, v, a) -> tau as a batch on the processor: jit of vmap, in double precision."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from protocol import Array, Job, Work

MOST = 20_000
"""States timed: enough for full speed, and few enough for the intermediate results of a large robot."""


def start(flags: str = "") -> None:
    """Set JAX up; call this before the first import of it."""
    os.environ["JAX_PLATFORMS"] = "cpu"
    os.environ["JAX_ENABLE_X64"] = "1"
    os.environ["XLA_FLAGS"] = flags


def work(job: Job, rnea: Callable[..., Any], names: Sequence[str], note: str) -> Work:
    """The work of a peer whose function is JAX's; `names` are its joints in order."""
    import jax

    note = f"{note}; jit of vmap, jax {jax.__version__}, first {len(job.q)} states"
    batch = jax.jit(jax.vmap(rnea))
    inputs = [jax.device_put(x) for x in job.columns(names)]
    last: list[Array] = []

    def run() -> None:
        last[:] = [batch(*inputs).block_until_ready()]

    return Work(run, lambda: job.torques(names, np.asarray(last[0])), note=note)
