"""A million states of the RTTRR arm in a blink: the robot as one compiled program."""

from __future__ import annotations

import time

import numpy as np

import rttrr_pin
from rttrr_pin import Wrench

robot = rttrr_pin.load("rttrr")
kernel = robot.compile(outputs="tau")
print(kernel.program.operations, "for each state")

q, v, a = np.random.default_rng(0).uniform(-1, 1, (3, 1_000_000, 5))
tau = np.empty_like(q)
kernel(q[:1], v[:1], a[:1])  # compiles, or reads what was compiled before

start = time.perf_counter()
kernel(q, v, a, out=tau)
print(f"{len(q):,} states in {time.perf_counter() - start:.3f} s")

# A state has the same bits alone, in a batch, in any layout.
assert (kernel(q[7], v[7], a[7]) == tau[7]).all()
assert (kernel(np.asfortranarray(q), v, a) == tau).all()

# With a load in the gripper; and what follows from the same recursion.
loaded = kernel(q[7], v[7], a[7], payload=Wrench(force=(0, 0, 2 * 9.81), expressed_in="base"))
print("a load of 2 kg adds", np.round(loaded - tau[7], 3))
residual = robot.mass_matrix(q[7]) @ a[7] + robot.nonlinear_effects(q[7], v[7]) - tau[7]
print("tau - (M a + h) =", np.abs(residual).max())
