"""The colours of pages, by what they mean; in the light and in the dark, and in files of pictures."""

from __future__ import annotations

import re
from collections.abc import Mapping

COLOURS: Mapping[str, tuple[str, str]] = {
    "ink": ("#1b2127", "#e6eaee"),
    "paper": ("#ffffff", "#14181c"),
    "dim": ("#56616b", "#a1acb6"),
    "rule": ("#d7dde3", "#353e47"),
    "box": ("#f4f6f8", "#1d2329"),
    "good": ("#17713b", "#63cf93"),
    "warn": ("#8a5b00", "#e3b657"),
    "bad": ("#b3261e", "#f4897f"),
    "mark": ("#ffe58a", "#5f4c00"),
    "s1": ("#2166ac", "#79b4ee"),
    "s2": ("#c2500a", "#f19a5f"),
    "s3": ("#1b7837", "#6fcf8e"),
    "s4": ("#762a83", "#cf9be0"),
    "s5": ("#0e7480", "#5fc9d6"),
    "s6": ("#8a6d00", "#e0c34c"),
    "bone": ("#7d8995", "#8d99a5"),
    "x": ("#c62828", "#f47c7c"),
    "y": ("#2e7d32", "#74c77a"),
    "z": ("#1565c0", "#7ab4f5"),
}
"""By name: light, dark. Texts and lines have a contrast of at least 4.5 and 3 to the paper."""

VARIABLE = re.compile(r"var\(--(\w+)\)")


def variables(dark: bool) -> str:
    """The colours as variables of CSS."""
    return " ".join(f"--{name}: {pair[dark]};" for name, pair in COLOURS.items())


def inlined(style: str) -> str:
    """A style with the light colours themselves, for programs that know no variables."""
    return VARIABLE.sub(lambda found: COLOURS[found[1]][0], style)
