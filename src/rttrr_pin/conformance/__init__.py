"""How far a program gets through a graded, proven set of cases."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.conformance.levels import LEVELS as LEVELS
    from rttrr_pin.conformance.levels import Case as Case
    from rttrr_pin.conformance.levels import Level as Level
    from rttrr_pin.conformance.levels import cases as cases
    from rttrr_pin.conformance.robots import level_robot as level_robot
    from rttrr_pin.conformance.robots import level_robots as level_robots

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {"levels": ("LEVELS", "Case", "Level", "cases"), "robots": ("level_robot", "level_robots")},
)
