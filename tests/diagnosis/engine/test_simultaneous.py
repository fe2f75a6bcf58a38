"""Errors that are computed beside each other give the numbers that each gives by itself."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.core.payload import Load
from rttrr_pin.diagnosis.catalogue.mechanics import mechanics
from rttrr_pin.diagnosis.catalogue.parameters import parameters
from rttrr_pin.diagnosis.engine import simultaneous
from rttrr_pin.diagnosis.engine.evidence import Evidence
from rttrr_pin.diagnosis.engine.predictions import predicted, raw_changes
from rttrr_pin.diagnosis.engine.simultaneous import together
from rttrr_pin.diagnosis.variants.mutations import Mutation, at, is_local, mutation, mutations
from rttrr_pin.diagnosis.variants.variant import Values, Variant, run
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import Sampler
from support.robots import driven
from support.trees import MUTATED, random_tree

PANDA = (11, 7, ("revolute",))
"""Seven joints that turn, in a row or nearly so."""


def load(name: str) -> Robot:
    if name == "rttrr":
        return rttrr_pin.load("rttrr")
    if name == "panda-like":
        return rttrr_pin.load(random_tree(*PANDA))
    if name == "mutated":
        return driven(rttrr_pin.load(random_tree(*MUTATED), gravity=(1.0, 2.0, -9.0)))
    seed = int(name)
    return driven(rttrr_pin.load(random_tree(seed, 3 + seed), base="floating" if seed % 2 else "fixed"))


def drawn(robot: Robot, states: int) -> Batch:
    """States with a payload of each state's own, and one that all share, in base axes."""
    rng, last = np.random.default_rng(0), len(robot.link_names) - 1
    loads = (
        Load(last, rng.uniform(-9, 9, (states, 3)), rng.uniform(-2, 2, (states, 3))),
        Load(last // 2, np.array([-4.0, 5.0, 2.5]), np.array([3.0, 1.0, -2.0]), in_base=True),
    )
    return replace(Sampler(robot.model).draw(0, states), loads=loads)


def listed(robot: Robot, most: int) -> list[Mutation]:
    """Some of the errors of the catalogue, in its order."""
    every = [own.mutation for own in mechanics(robot.model) if own.mutation is not None]
    chosen = set(random.Random(len(every)).sample(range(len(every)), min(most, len(every))))
    return [own for k, own in enumerate(every) if k in chosen]


def same(one: Values, other: Values) -> bool:
    """Bit by bit, but for the sign of a zero."""
    return all(np.array_equal(values, other[key], equal_nan=True) for key, values in one.items())


def check(errors: Sequence[Mutation], batch: Batch, base: Sequence[Mutation] = (), **rows: int) -> None:
    found = together(errors, batch.model, batch, base, **rows)
    for own, values in zip(errors, found, strict=True):
        assert same(values, run(batch.model, batch, [*base, own])), (own.id, own.link)


@pytest.mark.one_in(6)
@pytest.mark.parametrize("name", ["rttrr", "panda-like", "mutated", "1", "4", "5"])
def test_each_is_as_by_itself(name: str) -> None:
    robot = load(name)
    check(listed(robot, 100), drawn(robot, 2))


@pytest.mark.one_in(2)
@pytest.mark.parametrize("name", ["mutated", "rttrr"])
def test_every_error_at_all_links_is(name: str) -> None:
    """Also those that change nothing in this robot."""
    check(mutations(), drawn(load(name), 2))


def test_one_state_and_states_without_payload_are() -> None:
    robot = load("5")
    check(listed(robot, 60), drawn(robot, 1))
    check(listed(robot, 60), Sampler(robot.model).draw(0, 2))


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(3))
def test_so_it_is_on_top_of_other_errors(seed: int) -> None:
    """At all links, at one, at the same place, in functions that go through all links."""
    robot, draw = load("mutated"), random.Random(seed)
    links = range(len(robot.link_names))
    base = [
        at(own, draw.choice(links)) if is_local(own) and k else own for k, own in enumerate(draw.sample(mutations(), 3))
    ]
    base += [mutation("newton_euler: negate f[parents[i]] += R_f")] * (seed % 2)
    again = [at(own, i) for own in base if is_local(own) for i in links]
    others = [own for own in mutations() if own.function == "newton_euler"]
    check([*base, *again, *others, *listed(robot, 40)], drawn(robot, 2), base)


def test_results_do_not_depend_on_how_many_are_computed_at_once() -> None:
    robot = load("mutated")
    batch, errors = drawn(robot, 2), listed(robot, 60)
    first = list(together(errors, robot.model, batch))
    for rows in (1, 14, 46):
        assert all(map(same, together(errors, robot.model, batch, rows=rows), first))


@pytest.mark.slow
def test_what_overflows_is_as_by_itself() -> None:
    """A term that is dropped is not there, even where it is infinite: each joint accelerates so in a state of its own."""
    robot = load("mutated")
    batch = drawn(robot, robot.model.nv)
    huge = replace(batch, a=batch.a + 1e308 * np.eye(robot.model.nv))
    finite = np.isfinite(run(robot.model, huge)["f"]).all(axis=(1, 2))
    assert not finite.all() and finite.any()
    check(mutations(), huge)


def test_nearly_all_are_computed_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """One by one are the errors in gravity, in payloads and in sums over joints."""
    robot = load("rttrr")
    alone: list[Mutation] = []

    def counted(model: Any, batch: Any, errors: Sequence[Mutation] = (), *call: Any) -> Values:
        alone.extend(errors)
        return run(model, batch, errors, *call)

    monkeypatch.setattr(simultaneous, "run", counted)
    errors = listed(robot, 10000)
    assert len(list(together(errors, robot.model, drawn(robot, 1)))) > 500
    assert 0 < len(alone) < 10
    assert {own.function for own in alone} <= {"newton_euler", "dynamics"}


def test_changes_are_those_of_each_hypothesis_on_top_of_a_program() -> None:
    """In their order, through its numbers, inputs, outputs and errors."""
    robot = load("mutated")
    batch = drawn(robot, 2)
    outer = Variant(robot.model.with_gravity(np.array([0.0, 0.0, -5.0])))
    outer = outer.with_input(lambda own: replace(own, v=own.v * 1.5))
    outer = outer.with_output(lambda own, values: {**values, "tau": values["tau"] * own.a})
    outer = outer.with_mutation(mutation("outwards: drop joint.w"))
    values = np.zeros((2, robot.model.nv))
    evidence = Evidence(batch, ("tau",), values, values, values, values)
    one, other = parameters(robot.model)[:2]
    hypotheses = [one, *mechanics(robot.model)[::9], other]
    found = raw_changes(outer, hypotheses, evidence)
    assert [own for own, _ in found] == hypotheses
    base = predicted(outer, evidence)
    for own, change in found[1:-1]:
        assert np.array_equal(change, (predicted(own.apply(outer, ()), evidence) - base).ravel()), own.sentence
