"""The table of libraries (docs/table.md): what was saved of it, and two of its adapters."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from rttrr_pin.conformance import LEVELS, conform

ROOT = Path(__file__).parents[2]

SAVED = json.loads((ROOT / "benchmarks/results/conform.json").read_text())

OWN = {"recursion", "kernel"}

ENTRIES = {(entry["name"], entry["float"]): entry for entry in SAVED["entries"]}


def test_twelve_libraries_go_through_all_levels() -> None:
    assert len({name for name, _ in ENTRIES} - OWN) >= 12
    for entry in ENTRIES.values():
        assert {case["level"] for case in entry["cases"]} == {level.id for level in LEVELS}


def test_our_own_two_programs_pass_all_levels() -> None:
    assert [ENTRIES[name, "float64"]["reached"] for name in sorted(OWN)] == [len(LEVELS)] * 2


def test_each_failure_has_a_cause_and_each_refusal_its_words() -> None:
    for entry in ENTRIES.values():
        for case in entry["cases"]:
            if case["outcome"] == "pass":
                continue
            assert case["message"] if case["outcome"] == "not offered" else case["cause"], case
        failed = {case["id"] for case in entry["cases"] if case["outcome"] == "fail"}
        assert {own["id"] for own in entry["failures"]} == failed
        assert all(own["cause"] for own in entry["failures"])


def test_enclosures_of_failures_lie_apart_from_what_was_given() -> None:
    """The page shows numbers that anybody can tell apart."""
    for entry in ENTRIES.values():
        for own in entry["failures"]:
            given, lower, upper = (json.loads(own[key].replace("nan", "NaN")) for key in ("given", "lower", "upper"))
            assert any(not a <= x <= b for x, a, b in zip(given, lower, upper, strict=True)), own


def test_times_are_of_three_batches() -> None:
    for entry in ENTRIES.values():
        assert "error" in entry["ns"] or list(entry["ns"]) == [str(count) for count in SAVED["counts"]]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("adapter", "failed", "not_offered"),
    [("ask_pinocchio", ("fixed",), ("effects",)), ("ask_mujoco", (), ("mimic", "effects"))],
)
def test_an_adapter_answers_as_the_table_says(adapter: str, failed: tuple[str], not_offered: tuple[str]) -> None:
    """Order of joints, base, gravity, payload, effects: each level that is offered is passed, or saved as failed."""
    script = ROOT / f"benchmarks/conform/adapters/{adapter}.py"
    command = f"{sys.executable} {script} {{urdf}} {{base}} {{gravity}} {{effects}}"
    standing = conform(command, n_states=2, diagnose=False).standing
    assert (standing.failed, standing.not_offered) == (failed, not_offered)
