"""What the pages of all features are made from: the commands, and the files that they read."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from rttrr_pin import load

REPORTS = Path(__file__).parents[1] / "data/reports"

WRONG = """
from rttrr_pin import load
arm = load("trr")

def wrong(q, v, a):
    tau = arm.inverse_dynamics(q, v, a).tau.copy()
    tau[..., 2] *= 1.01
    return tau
"""

ROWS = 4000


def write_motion(path: Path, robot: str, rows: int = ROWS, noise: float = 1e-4) -> None:
    """Sines of q alone, so that v and a are derived and the loads have a band."""
    model, rng, t = load(robot).model, np.random.default_rng(1), np.arange(rows) / (rows / 12.0)
    columns = [t]
    for k, joint in enumerate(model.moving):
        low, high = max(joint.limits.lower, -1.5), min(joint.limits.upper, 1.5)
        columns.append(
            (low + high) / 2 + 0.3 * (high - low) * np.sin((1.2 + 0.3 * k) * t + k) + noise * rng.normal(size=rows)
        )
    header = ",".join(["time", *(f"q_{name}" for name in model.joint_names)])
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="", fmt="%.9g")


ODD = "</title></script><img src=x onerror=alert(1)>&'\"{{ 7 * 7 }}"
"""A name of a joint."""

COMMANDS: Mapping[str, tuple[int, list[str]]] = {
    "validate": (0, ["validate", "--states", "300"]),
    "validate-fails": (1, ["validate", "trr", "--subject", "wrong:wrong", "--reference", "kernel", "--states", "50"]),
    "validate-many": (0, ["validate", "robots", "--states", "20"]),
    "validate-odd": (0, ["validate", "odd.urdf", "--states", "20"]),
    "inspect-odd": (0, ["inspect", "odd.urdf"]),
    "diagnose": (1, ["diagnose", "trr", "--subject", "wrong:wrong", "--states", "100"]),
    "compare": (1, ["compare", "rttrr", "heavier.urdf", "--states", "20"]),
    "conform": (0, ["conform", "kernel", "--levels", "gravity", "--states", "4"]),
    "inspect": (1, ["inspect", str(REPORTS / "negative_mass_fixed.urdf")]),
    "inspect-many": (1, ["inspect", str(REPORTS)]),
    "laws": (0, ["laws", "--states", "20"]),
    "audit": (1, ["audit"]),
    "loads": (1, ["loads", "limited.urdf", "motion.csv"]),
}
"""By name, exit code and words."""
