"""A robot in the browser: frames, bodies, forces, along a trajectory."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.viewing.run import state_of as state_of
    from rttrr_pin.viewing.run import view as view

__getattr__, __dir__, __all__ = lazy(__name__, {"run": ("state_of", "view")})
