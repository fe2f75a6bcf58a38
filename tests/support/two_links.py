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

ARM = (
    LINKS
    + """[[symbol]]
name = "m_<i>"
dimension = "mass"
[[symbol]]
name = "l_<i>"
dimension = "length"
[[symbol]]
name = "g"
dimension = "acceleration"
"""
)
"""The links with the usual letters."""
