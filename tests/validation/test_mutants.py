"""A comparison with Pinocchio finds every error that the syntax tree of the recursion offers, whoever would make it.

Other libraries shipped some of them: see docs/references.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import LinkWrenches, Robot
from rttrr_pin.core.payload import Load
from rttrr_pin.exact import bounded_dynamics
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import Sampler
from support.implementations import evaluated
from support.mutants import EQUIVALENT, Mutant, mutants, planted
from support.robots import driven
from support.tolerances import ROUNDING, norm_error
from support.trees import MUTATED, random_tree

STEPS_LINK = 4
"""The link whose steps alone have an error: it floats on a link that moves and carries another, so every term matters."""


@dataclass(frozen=True)
class Case:
    """One state with payloads in both kinds of axes, and what is right for it."""

    robot: Robot
    states: Batch
    loads: tuple[Load, ...]
    right: LinkWrenches
    reference: Mapping[str, Any]

    def computed(self) -> LinkWrenches:
        return bounded_dynamics(self.robot.model, self.states.q, self.states.v, self.states.a, self.loads)[0]

    def changed(self, wrong: LinkWrenches) -> bool:
        return any(not np.array_equal(x, getattr(self.right, key)) for key, x in wrong.items())

    def differs(self, wrong: LinkWrenches) -> bool:
        return any(norm_error(x, self.reference[key]) > ROUNDING for key, x in wrong.items())


@pytest.fixture(scope="module")
def case() -> Case:
    robot = driven(rttrr_pin.load(random_tree(*MUTATED), gravity=(1.0, 2.0, -9.0)))
    states = Sampler(robot.model).draw(0, 1)
    last = len(robot.link_names) - 1
    loads = (
        Load(last, np.array([1.0, -2.0, 3.0]), np.array([0.5, 2.0, -1.5])),
        Load(last // 2, np.array([-4.0, 5.0, 2.5]), np.array([3.0, 1.0, -2.0]), in_base=True),
    )
    right = bounded_dynamics(robot.model, states.q, states.v, states.a, loads)[0]
    reference = evaluated("pinocchio", robot.model, states.q, states.v, states.a, loads).values
    return Case(robot, states, loads, right, reference)


def outcomes(case: Case, errors: list[Mutant]) -> tuple[list[str], list[str]]:
    """The errors that change no number, and those that do and are not found."""
    unchanged, missed = [], []
    for mutant in errors:
        with planted(mutant):
            wrong = case.computed()
        if not case.changed(wrong):
            unchanged.append(mutant.id)
        elif not case.differs(wrong):
            missed.append(mutant.id)
    return unchanged, missed


def test_without_an_error_there_is_no_difference(case: Case) -> None:
    assert not case.differs(case.right)
    with planted(mutants()[0]):
        assert case.changed(case.computed())
    assert not case.changed(case.computed())


def test_every_error_is_found(case: Case) -> None:
    unchanged, missed = outcomes(case, mutants())
    assert missed == []
    assert unchanged == list(EQUIVALENT)


def test_every_error_at_one_link_is_found(case: Case) -> None:
    unchanged, missed = outcomes(case, mutants(STEPS_LINK))
    assert missed == []
    assert set(unchanged) <= set(EQUIVALENT)


def test_the_errors_that_others_shipped_are_among_them() -> None:
    ids = {mutant.id for mutant in mutants()}
    assert ids >= {
        "inwards: take joint.p for body.r_C",
        "inwards: take body.r_C for joint.p",
        "inwards: drop joint.p.cross(R_f)",
        "outwards: transpose R.T in R.T @ w_p",
        "outwards: drop w.cross(body.I @ w)",
        "outwards: forget the factor of carried.cross(joint.v) * 2",
        "outwards: drop joint.w.cross(joint.v)",
    }
