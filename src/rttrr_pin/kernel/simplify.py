"""Passes that make a program shorter."""

from __future__ import annotations

from rttrr_pin.kernel.program import Program


def simplify(program: Program) -> Program:
    """All passes."""
    return program
