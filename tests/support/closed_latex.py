"""Reads closed forms back from the LaTeX of the writers, with nothing but a table of how each symbol is spelled."""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np

ENVIRONMENT = re.compile(r"\\begin\{(?:align\*|aligned)\}\n(.*?)\\end\{(?:align\*|aligned)\}", re.DOTALL)


def printed_lines(text: str) -> list[str]:
    """The lines of all aligned environments."""
    lines = [line for body in ENVIRONMENT.findall(text) for line in body.rstrip().split("\n")]
    return [re.sub(r" \\\\(\[1ex\])?$", "", line) for line in lines]


def equations(text: str) -> list[tuple[str, str]]:
    """Name and right-hand side of each equation, in order."""
    found: list[list[str]] = []
    for line in printed_lines(text):
        name, equals, rest = line.replace(r"& \quad ", "& ").partition(" ={}& ")
        if equals:
            found.append([name, rest])
        else:
            assert re.match(r"& [+-] ", name), f"a line goes on without + or -: {line}"
            found[-1][1] += name.removeprefix("&")
    return [(name, side) for name, side in found]


def python(side: str, spelled: Mapping[str, str]) -> str:
    """A right-hand side as a Python expression; `spelled` gives the LaTeX of each name."""
    side = re.sub(r"\\frac\{(\d+)\}\{(\d+)\}", r"(\1/\2)", side)
    side = re.sub(r"(\d) \\cdot 10\^\{(-?\d+)\}", r"\1e\2", side)
    side = re.sub(r"([cs])\^(\d)(q_\w|q_\{\d+\}|\\varphi_\w|\\varphi_\{\d+\})", r"\1\3^\2", side)
    latex = {spelling: name for name, spelling in spelled.items()}
    any_symbol = "|".join(map(re.escape, sorted(latex, key=len, reverse=True)))
    side = re.sub(any_symbol, lambda found: f" {latex[found[0]]} ", side)
    for sign, written in ((r"\left(", "("), (r"\right)", ")"), (r"\cdot", "*"), ("^", "**")):
        side = side.replace(sign, written)
    side = re.sub(r"\s+", " ", side).strip()
    assert not re.search(r"[\\{}]|\w \w|\) \w|\w \(", side), f"not read: {side}"
    return side


def values(text: str, spelled: Mapping[str, str], given: Mapping[str, np.ndarray | float]) -> dict[str, np.ndarray]:
    """The value of each equation's name; later equations may use names of earlier ones."""
    known = dict(given)
    names = {spelling: name for name, spelling in spelled.items()}
    found: dict[str, np.ndarray] = {}
    for latex, side in equations(text):
        value = eval(compile(python(side, spelled), latex, "eval"), {"__builtins__": {}}, known)
        found[latex] = np.asarray(value)
        if latex in names:
            known[names[latex]] = found[latex]
    return found
