"""How far a computed number can be from the true one, what the true one is, and the laws that true ones keep."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.exact.adjudication import Adjudication as Adjudication
    from rttrr_pin.exact.adjudication import Assessment as Assessment
    from rttrr_pin.exact.adjudication import Deviation as Deviation
    from rttrr_pin.exact.enclosures import Enclosure as Enclosure
    from rttrr_pin.exact.enclosures import Enclosures as Enclosures
    from rttrr_pin.exact.enclosures import enclose as enclose
    from rttrr_pin.exact.rounding import BOUNDED as BOUNDED
    from rttrr_pin.exact.rounding import Bounded as Bounded
    from rttrr_pin.exact.rounding import bounded_dynamics as bounded_dynamics

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "adjudication": ("Adjudication", "Assessment", "Deviation"),
        "enclosures": ("Enclosure", "Enclosures", "enclose"),
        "rounding": ("BOUNDED", "Bounded", "bounded_dynamics"),
    },
)
