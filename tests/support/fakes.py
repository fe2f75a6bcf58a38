"""Implementations made to be wrong."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rttrr_pin.core.payload import Load
from rttrr_pin.implementations import Evaluation
from rttrr_pin.implementations.pinocchio import PinocchioOracle


class Liar(PinocchioOracle):
    """An oracle with one number changed; what is changed is set by the test."""

    spoil: Any = None

    def evaluate(self, q: np.ndarray, v: np.ndarray, a: np.ndarray, loads: Sequence[Load] = ()) -> Evaluation:
        result = super().evaluate(q, v, a, loads)
        type(self).spoil(result.wrenches, q)
        return result
