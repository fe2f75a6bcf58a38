"""The peers as kernel_speed.py sees them, and where they and the libraries of conform/run.py are installed."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PEERS = Path(__file__).parent / "peers"
ENVIRONMENTS = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "rttrr-pin", "peers")
"""Unless another folder is named by --envs."""

OWN = "own"
"""The environment of peers that run in the interpreter of kernel_speed.py."""


@dataclass(frozen=True)
class PeerRun:
    """What a peer said.

    Attributes:
        seconds: for one state, in each repeat.
        tau: of the states that it computed, (K, n).
        problem: why there is nothing else, or "".
    """

    version: str = ""
    note: str = ""
    seconds: tuple[float, ...] = ()
    tau: Array | None = None
    problem: str = ""


def requirements() -> dict[str, Any]:
    """The table of peers and environments."""
    return tomllib.loads((PEERS / "requirements.toml").read_text())


def environments() -> dict[str, list[str]]:
    """What to install, by environment."""
    found: dict[str, list[str]] = requirements()["environments"]
    return found


def python_of(environment: Path) -> Path:
    """The interpreter of an environment."""
    return environment / "bin" / "python"


def interpreter(peer: str, folder: Path) -> Path | None:
    """The interpreter that runs a peer, or None if its environment is not there."""
    name = requirements()["peers"][peer]
    python = Path(sys.executable) if name == OWN else python_of(folder / name)
    return python if python.exists() else None


def run_peer(peer: str, python: Path, states: Path, urdf: Path, threads: int, repeats: int, patience: float) -> PeerRun:
    """Run a peer's script once.

    Args:
        peer: name of the script.
        python: the interpreter of its environment.
        states: STATES.npz.
        urdf: the robot.
        threads: how many the peer may use.
        repeats: timed runs.
        patience: seconds until it is given up.
    """
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder, "out.npz")
        command = [str(python), str(PEERS / f"{peer}.py"), str(states), str(urdf), str(out)]
        command += ["--threads", str(threads), "--repeats", str(repeats)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=patience)
        except subprocess.TimeoutExpired:
            return PeerRun(problem=f"not done after {patience:.0f} s (see --patience)")
        if done.returncode:
            said = [line.strip() for line in done.stderr.splitlines() if line.strip()]
            return PeerRun(problem=said[-1][:300] if said else f"exit {done.returncode}")
        line = json.loads(done.stdout.splitlines()[-1])
        with np.load(out) as file:
            tau = file["tau"]
    return PeerRun(line["version"], line["note"], tuple(x / line["states"] for x in line["seconds"]), tau)
