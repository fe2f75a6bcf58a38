"""What every joint and bearing carries along a trajectory: tables, envelopes, lives of gears."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.loads.parts import BearingLoad as BearingLoad
    from rttrr_pin.loads.parts import GearLife as GearLife
    from rttrr_pin.loads.parts import JointLoad as JointLoad
    from rttrr_pin.loads.parts import Level as Level
    from rttrr_pin.loads.parts import Peak as Peak
    from rttrr_pin.loads.ratings import GearRating as GearRating
    from rttrr_pin.loads.ratings import read_ratings as read_ratings
    from rttrr_pin.loads.results import History as History
    from rttrr_pin.loads.results import LoadReport as LoadReport
    from rttrr_pin.loads.results import NamedState as NamedState
    from rttrr_pin.loads.results import Samples as Samples
    from rttrr_pin.loads.run import compute_loads as compute_loads

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "parts": ("BearingLoad", "GearLife", "JointLoad", "Level", "Peak"),
        "ratings": ("GearRating", "read_ratings"),
        "results": ("History", "LoadReport", "NamedState", "Samples"),
        "run": ("compute_loads",),
    },
)
