"""Compiling in a process that lives long, and in one that forks."""

from __future__ import annotations

import gc
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin.compile import Kernel, cache

FORKS = """
import os, signal, threading, time
import numpy as np
import rttrr_pin
from rttrr_pin.compile import Kernel

model, zero = rttrr_pin.load("rttrr").model, np.zeros(5)
kernel = Kernel(model, "tau")
threads = [threading.Thread(target=compiled, args=(zero, zero, zero)) for compiled in (kernel, Kernel(model, "n"))]
for thread in threads:
    thread.start()
for delay in range(10):
    time.sleep(delay / 40)
    child = os.fork()
    if child == 0:
        signal.alarm(60)  # ends a child that waits for a lock that nobody holds
        kernel(zero, zero, zero)
        Kernel(model, "f")(zero, zero, zero)
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0
for thread in threads:
    thread.join()
"""


@pytest.mark.slow
def test_a_fork_while_a_kernel_compiles_leaves_a_child_that_can_compile() -> None:
    environment = os.environ | {cache.VARIABLE: ""}
    done = subprocess.run([sys.executable, "-W", "ignore", "-c", FORKS], env=environment, timeout=600, check=False)
    assert done.returncode == 0


@pytest.fixture
def no_cache(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv(cache.VARIABLE, "")
    yield
    gc.collect()


def resident() -> float:
    """Memory of this process [MB]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


@pytest.mark.slow
@pytest.mark.usefixtures("no_cache")
def test_kernels_that_are_given_up_leave_no_memory_taken() -> None:
    model, zero = rttrr_pin.load("rttrr").model, np.zeros(5)
    sizes = []
    for k in range(60):
        Kernel(model, "gravity_torque")(zero)
        if k % 20 == 19:
            gc.collect()
            sizes.append(resident())
    assert sizes[2] - sizes[1] < 1.0  # of 20 kernels; it was 2.5
