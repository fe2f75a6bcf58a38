"""Whatever computes inverse dynamics: this package, other libraries, a user's function, table or program.

The only place that imports other dynamics libraries; each in one module, loaded when it is named.
"""

from __future__ import annotations

from rttrr_pin.implementations.allowance import default_allowance
from rttrr_pin.implementations.protocol import Batch, Evaluation, Implementation, label
from rttrr_pin.implementations.registry import make_implementation, make_references, names

__all__ = [
    "Batch",
    "Evaluation",
    "Implementation",
    "default_allowance",
    "label",
    "make_implementation",
    "make_references",
    "names",
]
