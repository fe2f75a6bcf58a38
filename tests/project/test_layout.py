"""Tests mirror the source tree, and import neither each other nor a benchmark."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

TESTS = Path(__file__).parents[1]
PACKAGES = {path.parent.name for path in (TESTS.parent / "src/rttrr_pin").glob("*/__init__.py")}
BENCHMARKS = {path.stem for path in (TESTS.parent / "benchmarks").glob("*.py")} | {"benchmarks"}

BESIDE = {"data", "fuzz", "project", "support"}
"""Folders that stand for no package."""


def test_each_package_has_its_folder_of_tests() -> None:
    folders = {path.parent.name for path in TESTS.glob("*/test_*.py")}
    assert folders - BESIDE == PACKAGES


@pytest.mark.parametrize("path", sorted(TESTS.rglob("*.py")), ids=lambda path: str(path.relative_to(TESTS)))
def test_what_tests_share_stands_in_support(path: Path) -> None:
    """Only the command of a campaign, in its main, writes results as benchmarks do."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom | ast.Import):
            names = [node.module or ""] if isinstance(node, ast.ImportFrom) else [alias.name for alias in node.names]
            for name in names:
                parts = name.split(".")
                assert not any(part.startswith("test_") or part == "tests" for part in parts), name
                own = isinstance(node, ast.ImportFrom) and node.level > 0
                assert own or parts[0] not in BENCHMARKS or "campaign" in path.stem, name


@pytest.mark.parametrize("path", sorted(TESTS.rglob("*.py")), ids=lambda path: str(path.relative_to(TESTS)))
def test_no_test_is_skipped_where_a_library_is_missing(path: Path) -> None:
    """The extra of the tests has what they need: a missing library is a failure."""
    names = {node.attr for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Attribute)}
    assert not names & {"importorskip", "skipif", "skip"}
