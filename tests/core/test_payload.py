"""Payloads as the user gives them."""

from __future__ import annotations

import math

import pytest

from rttrr_pin.core.payload import RandomPayload
from rttrr_pin.errors import InputError


@pytest.mark.parametrize("name", ["force", "moment"])
@pytest.mark.parametrize("bad", [-1.0, math.nan, math.inf])
def test_half_ranges_are_finite_and_not_negative(name: str, bad: float) -> None:
    with pytest.raises(InputError, match=f"{name} of RandomPayload is"):
        RandomPayload(**{name: bad})
