"""How far a program gets through a graded, proven set of cases."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rttrr_pin.lazy import lazy

if TYPE_CHECKING:
    from rttrr_pin.conformance.judging import judge as judge
    from rttrr_pin.conformance.kit.assertions import assert_inverse_dynamics as assert_inverse_dynamics
    from rttrr_pin.conformance.kit.pytest_plugin import parametrize_with_checks as parametrize_with_checks
    from rttrr_pin.conformance.levels import LEVELS as LEVELS
    from rttrr_pin.conformance.levels import Case as Case
    from rttrr_pin.conformance.levels import Level as Level
    from rttrr_pin.conformance.levels import ProvenCase as ProvenCase
    from rttrr_pin.conformance.levels import cases as cases
    from rttrr_pin.conformance.mutation.mutants import Mutant as Mutant
    from rttrr_pin.conformance.mutation.mutation import MutationScore as MutationScore
    from rttrr_pin.conformance.mutation.mutation import mutate as mutate
    from rttrr_pin.conformance.mutation.pytest_suite import PytestSuite as PytestSuite
    from rttrr_pin.conformance.mutation.suites import Tolerances as Tolerances
    from rttrr_pin.conformance.results import Conformance as Conformance
    from rttrr_pin.conformance.results import LevelResult as LevelResult
    from rttrr_pin.conformance.results import QuantityResult as QuantityResult
    from rttrr_pin.conformance.results import Standing as Standing
    from rttrr_pin.conformance.results import Value as Value
    from rttrr_pin.conformance.robots import level_robot as level_robot
    from rttrr_pin.conformance.robots import level_robots as level_robots
    from rttrr_pin.conformance.run import conform as conform
    from rttrr_pin.conformance.vectors.vectors import Vectors as Vectors
    from rttrr_pin.conformance.vectors.vectors import read_vectors as read_vectors
    from rttrr_pin.conformance.vectors.vectors import write_vectors as write_vectors

__getattr__, __dir__, __all__ = lazy(
    __name__,
    {
        "kit.assertions": ("assert_inverse_dynamics",),
        "judging": ("judge",),
        "levels": ("LEVELS", "Case", "Level", "ProvenCase", "cases"),
        "mutation.mutants": ("Mutant",),
        "mutation.mutation": ("MutationScore", "mutate"),
        "kit.pytest_plugin": ("parametrize_with_checks",),
        "mutation.pytest_suite": ("PytestSuite",),
        "results": ("Conformance", "LevelResult", "QuantityResult", "Standing", "Value"),
        "robots": ("level_robot", "level_robots"),
        "run": ("conform",),
        "mutation.suites": ("Tolerances",),
        "vectors.vectors": ("Vectors", "read_vectors", "write_vectors"),
    },
)
