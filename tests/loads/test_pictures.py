"""Pictures of loads: fewer buckets lose no peak."""

from __future__ import annotations

import numpy as np
import pytest

from rttrr_pin.loads.pictures import BUCKETS, _merged
from rttrr_pin.loads.results import History


@pytest.mark.parametrize(("count", "joints"), [(1000, 5), (1000, 30), (997, 80), (1, 3), (333, 60)])
def test_merged_histories_keep_every_extreme(count: int, joints: int) -> None:
    rng = np.random.default_rng(0)
    low = rng.normal(size=(count, joints))
    high = low + rng.random((count, joints))
    own = History(np.arange(count) * 0.5, low, high, low - 1, high + 1, 100)
    merged = _merged(own, joints)
    assert len(merged.time) * joints <= max(BUCKETS, 200 * joints)
    for name, of in (("low", np.min), ("band_low", np.min), ("high", np.max), ("band_high", np.max)):
        np.testing.assert_array_equal(of(getattr(merged, name), axis=0), of(getattr(own, name), axis=0))
    assert (np.diff(merged.time) > 0).all() and merged.time[0] >= own.time[0] and merged.time[-1] <= own.time[-1]
    assert merged.rows * len(merged.time) >= own.rows * count
