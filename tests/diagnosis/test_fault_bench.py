"""Faults from the whole catalogue, planted in random robots, are named; clean results have none.

`benchmarks/fault_bench.py` runs more of it, and counts.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from support.faults import Bench, bench_robot, clean_results


@lru_cache(maxsize=2)
def bench(seed: int) -> Bench:
    return Bench(bench_robot(seed))


@pytest.mark.one_in(32)
@pytest.mark.parametrize("part", range(4))
@pytest.mark.parametrize("seed", range(8))
def test_single_faults_are_named(seed: int, part: int) -> None:
    own, rng = bench(seed), np.random.default_rng([seed, part])
    for _ in range(10):
        faults = own.visible(1, rng)
        judged = own.judged(faults, rng)
        assert judged.detected
        assert judged.first or judged.same, [(fault.id, fault.link, fault.joint, x) for fault, x in faults]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_pairs_of_faults_are_detected_and_mostly_named(seed: int) -> None:
    own, rng = bench(seed), np.random.default_rng([seed, 99])
    judged = [own.judged(own.visible(2, rng), rng) for _ in range(3)]
    assert all(one.detected for one in judged)
    assert sum(one.first or one.same for one in judged) >= 2


@pytest.mark.one_in(8)
@pytest.mark.parametrize("seed", range(8))
def test_clean_results_agree(seed: int) -> None:
    judged, false = clean_results(bench_robot(seed), 100, seed)
    assert (judged, false) == (400, 0)


@pytest.mark.slow
def test_a_part_of_the_states_is_not_enough() -> None:
    """Faults of a payload at another link look alike where none is loaded; all states decide."""
    own, rng = bench(6), np.random.default_rng(0)
    fault = next(one for one in own.hypotheses if (one.id, one.link) == ("inwards: drop n_on", "link_1"))
    assert own.judged([(fault, ())], rng).first
