"""The planar arm of two links with point masses, as a file of equations has it; the textbooks' first example."""

from __future__ import annotations

LINKS = """
[robot]
gravity = ["0", "-g", "0"]
[[link]]
joint = "revolute about z"
mass = "m_1"
com = ["l_1", "0", "0"]
[[link]]
joint = "revolute about z"
origin = ["l_1", "0", "0"]
mass = "m_2"
com = ["l_2", "0", "0"]
"""


def declared(**dimensions: str) -> str:
    """Tables of symbols, by name; `m_i` stands for `m_<i>`, that of every link."""
    names = {name: name.replace("_i", "_<i>") for name in dimensions}
    return "".join(f'[[symbol]]\nname = "{names[x]}"\ndimension = "{dimensions[x]}"\n' for x in dimensions)


ARM = LINKS + declared(m_i="mass", l_i="length", g="acceleration")
"""The links with the usual letters."""
