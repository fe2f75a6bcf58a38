"""Motion over time: read from files, differentiated, or made; in blocks, so that it may be larger than memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.trajectories.arrays import trajectory as trajectory
    from rttrr_pin.trajectories.block import Block as Block
    from rttrr_pin.trajectories.block import Differentiation as Differentiation
    from rttrr_pin.trajectories.built_in import pick_and_place as pick_and_place
    from rttrr_pin.trajectories.built_in import rest_to_rest as rest_to_rest
    from rttrr_pin.trajectories.findings import Finding as Finding
    from rttrr_pin.trajectories.read import named as named
    from rttrr_pin.trajectories.read import read_trajectory as read_trajectory
    from rttrr_pin.trajectories.stream import Trajectory as Trajectory

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "arrays": ("trajectory",),
        "block": ("Block", "Differentiation"),
        "built_in": ("pick_and_place", "rest_to_rest"),
        "findings": ("Finding",),
        "read": ("named", "read_trajectory"),
        "stream": ("Trajectory",),
    },
)
