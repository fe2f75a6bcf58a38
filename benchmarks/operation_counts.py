"""Claim: the traced program of a robot needs about as few operations as the best published customised Newton-Euler.

Run: python benchmarks/operation_counts.py [--save]. Of the driving forces, for one state; sines and cosines apart.

The published rows are of programs with symbols for lengths, inertial parameters and gravity, inertia about the link
origin, and count as we do: a product is a multiplication, a sum or difference an addition, x^2 a multiplication; sign
changes are not counted there, and stand apart here. They were generated from the same two Puma 560 models with

- OpenSYMORO (the open successor of SYMORO+; W. Khalil, D. Creusot, "SYMORO+: a system for the symbolic modelling of
  robots", Robotica 15 (1997) 153-161), github.com/xu-yang16/symoro-python3 at bb86bca21be4;
- SymPyBotics (C. D. Sousa), github.com/cdsousa/SymPyBotics at 5d4613abd9ca,

both on SymPy 1.11.1, after dropping intermediate results that no torque needs.
"""

from __future__ import annotations

from rich.console import Console
from rich.table import Table

import rttrr_pin
from common import arguments, finish
from puma560 import armstrong, general
from rttrr_pin.compile.program import Program
from rttrr_pin.compile.trace import trace
from rttrr_pin.core.model import Model

PUBLISHED = {
    "Puma 560, all parameters": {"OpenSYMORO": (345, 296), "SymPyBotics": (345, 296)},
    "Puma 560, base parameters": {"OpenSYMORO": (301, 240), "SymPyBotics": (311, 250)},
    "Puma 560 as measured": {"OpenSYMORO": (269, 208), "SymPyBotics": (312, 252)},
    "Puma 560 as measured, base parameters": {"OpenSYMORO": (210, 158)},
    "any arm of 6 revolute joints, not customised": {"Hollerbach 1980, in the Robotics Toolbox manual": (852, 738)},
}
"""Multiplications and additions by program."""

ROBOTS = ("rttrr", "example:ur5_robot", "example:panda", "example:talos_reduced")


def counts(model: Model) -> dict[str, dict[str, int]]:
    """Operations as traced, and as compiled: with inertia regrouped."""
    programs = {"traced": trace(model, ["tau"], regrouped=False), "compiled": trace(model, ["tau"])}
    return {name: _of(program) for name, program in programs.items()}


def _of(program: Program) -> dict[str, int]:
    operations = program.operations
    return {
        "multiplications": operations.multiplications,
        "additions": operations.additions,
        "negations": operations.negations,
        "sincos": operations.sincos,
    }


def shown(figures: dict[str, dict[str, dict[str, int]]]) -> Table:
    """The counts as multiplications / additions."""
    table = Table("robot", "traced", "compiled", "angles", title="multiplications / additions")
    for robot, steps in figures.items():
        cells = [f"{step['multiplications']} / {step['additions']}" for step in steps.values()]
        table.add_row(robot, *cells, str(steps["compiled"]["sincos"]))
    return table


def main() -> None:
    options = arguments(__doc__ or "").parse_args()
    models = {"Puma 560": general(), "Puma 560 as measured": armstrong()}
    models |= {name: rttrr_pin.load(name).model for name in ROBOTS}
    figures = {name: counts(model) for name, model in models.items()}
    Console(stderr=True).print(shown(figures))
    finish("operation_counts", {"ours": figures, "published": PUBLISHED}, options.save)


if __name__ == "__main__":
    main()
