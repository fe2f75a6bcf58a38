"""States in, torques out: the two tables of `rttrr-pin sample` and `rttrr-pin diagnose`, with NumPy alone."""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
States = dict[str, Array]
"""By column, such as `q_lift`, one number for each state."""

Torques = Callable[[str, States], dict[str, Array]]
"""From the file of the robot and the states to the torques, by joint."""


def main(torques: Torques, form: str = ".17g") -> None:
    """Add `tau_` columns to a table: `python program.py ROBOT STATES RESULTS`."""
    robot, source, target = sys.argv[1:]
    with Path(source).open(newline="") as file:
        header, *rows = csv.reader(file)
    columns = zip(header, zip(*rows, strict=True), strict=True)
    states = {name: np.array(column, dtype=float) for name, column in columns if name[:2] in ("q_", "v_", "a_")}
    tau = torques(robot, states)
    results = np.column_stack([*tau.values()])
    with Path(target).open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([*header, *(f"tau_{joint}" for joint in tau)])
        writer.writerows([*row, *(f"{x:{form}}" for x in own)] for row, own in zip(rows, results, strict=True))
