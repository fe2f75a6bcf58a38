"""Counts of errors by powers of two: each state once, whatever the blocks, the tolerance within the tolerance."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from rttrr_pin import Robot, validate
from rttrr_pin.validation.histogram import EDGES, Histogram
from rttrr_pin.validation.page import validation_page
from rttrr_pin.validation.state import compare_state


def test_each_value_is_in_its_bin() -> None:
    rng = np.random.default_rng(0)
    values = np.concatenate([10.0 ** rng.uniform(-11, 7, 2000), EDGES, [0.0, 0.0, np.inf, 1e-300, 1e300]])
    whole, parts = Histogram(), Histogram()
    whole.see(values)
    for part in np.array_split(values, 7):
        parts.see(part)
    assert np.array_equal(whole.counts, parts.counts) and whole.zero == parts.zero == 2
    assert whole.counts.sum() + whole.zero == len(values)
    inner = values[(values > EDGES[1]) & (values <= EDGES[-2])]
    wanted = [np.count_nonzero((inner > a) & (inner <= b)) for a, b in pairwise(EDGES[1:-1])]
    assert whole.counts[1:-1].tolist() == wanted


def test_all_that_rounding_explains_is_within() -> None:
    one = Histogram()
    one.see(np.array([1.0, np.nextafter(1.0, 2.0)]))
    assert one.counts[EDGES.index(1.0) - 1] == one.counts[EDGES.index(1.0)] == 1


def test_each_state_is_counted_once_for_each_quantity(rttrr: Robot) -> None:
    result = validate(rttrr, n_states=257)
    [reference] = result.references
    for own in reference.histograms.values():
        assert own.counts.sum() + own.zero == 257
    worst = result.worst
    largest = np.flatnonzero(reference.histograms[worst.quantity].counts)[-1]
    assert EDGES[largest] < worst.of_tolerance.value <= EDGES[largest + 1]


def test_the_page_has_every_row_and_the_worst_state(rttrr: Robot) -> None:
    result = validate(rttrr, "recursion", ["kernel", "pinocchio"], 20)
    worst = compare_state(rttrr, result.worst.of_tolerance.state, "recursion", ["kernel", "pinocchio"])
    page = validation_page(result, rttrr, worst, ("a command",))
    assert [chart.name for chart in page.charts] == ["errors-1", "errors-2", "worst-state"]
    tables = {block.title: block for block in page.blocks if hasattr(block, "rows")}
    assert sum(len(table.rows) for title, table in tables.items() if title.startswith("Every row")) == len(result.rows)
    assert len(tables["Error / tolerance, link by link"].rows) == len(rttrr.link_names)
    assert "Marked: " in page.charts[-1].text
