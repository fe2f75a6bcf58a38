"""Every error of the recursion is told in words, at each link where it can show, and at no other."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import RandomPayload, Robot
from rttrr_pin.diagnosis.catalogue.mechanics import mechanics, sentences, term_of
from rttrr_pin.diagnosis.catalogue.relevance import concerned
from rttrr_pin.diagnosis.variants.mutations import at, is_local, mutations
from rttrr_pin.diagnosis.variants.variant import Values, Variant, run
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import Sampler
from support.robots import driven
from support.trees import MUTATED, random_tree

TREES = (*((seed, 3 + seed) for seed in range(5)), MUTATED)


def load(number: int) -> Robot:
    return driven(rttrr_pin.load(random_tree(*TREES[number]))) if number >= 0 else rttrr_pin.load("rttrr")


def drawn(robot: Robot) -> Batch:
    return Sampler(robot.model, payload=RandomPayload(robot.link_names[-1])).draw(0, 1)


def same(one: Values, other: Values) -> bool:
    return all(np.array_equal(values, other[key]) for key, values in one.items())


def test_every_term_and_every_operator_has_words(rttrr: Robot) -> None:
    """Code, in backticks, stands behind the colon alone."""
    for error in mutations():
        does, repair = sentences(error, rttrr.model, None)
        assert "`" not in does + repair.partition(": `")[0], error.id


def test_what_the_table_does_not_know_is_told_by_its_code(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    term_of.cache_clear()
    monkeypatch.setattr("rttrr_pin.diagnosis.catalogue.terms.TERMS", {})
    monkeypatch.setattr("rttrr_pin.diagnosis.catalogue.mechanics.SENTENCES", {})
    found = [one for one in mechanics(rttrr.model) if one.id == "outwards: drop w.cross(body.I @ w)"]
    term_of.cache_clear()
    assert {one.sentence for one in found} >= {"`N = keep(body.I @ w_dot)` is computed at link_3"}


@pytest.mark.parametrize("number", [-1, 0, len(TREES) - 1])
def test_sentences_tell_all_errors_apart(number: int) -> None:
    found = mechanics(load(number).model)
    assert [x for x, k in Counter(one.sentence for one in found).items() if k > 1] == []
    assert len({(one.id, one.link) for one in found}) == len(found)


def test_a_sentence_names_term_and_place(rttrr: Robot) -> None:
    by_name = {(one.id, one.link): one for one in mechanics(rttrr.model)}
    one = by_name["outwards: drop w.cross(body.I @ w)", "link_3"]
    assert one.sentence == "the gyroscopic moment w x I w is left out at link_3"
    assert (one.link, one.joint, one.equation) == ("link_3", "joint_3", "(23)-(30)")
    assert one.line.startswith("core/newton_euler.py:") and one.line.endswith("w.cross(body.I @ w))")
    assert by_name["outwards: drop w.cross(body.I @ w)", None].sentence.endswith("at every link")
    assert by_name["Prismatic.motion: drop v=u * v", "link_3"].sentence.endswith("at joint_3")
    payload = by_name[
        "newton_euler: drop " + next(x.expression for x in mutations() if "payload.f" in x.expression), None
    ]
    assert (payload.sentence, payload.equation) == ("the force of the payload is left out", "(8)")


@pytest.mark.one_in(7)
@pytest.mark.parametrize("number", range(-1, len(TREES)))
def test_an_error_is_left_out_only_where_it_changes_nothing(number: int) -> None:
    robot = load(number)
    batch = drawn(robot)
    plain = run(robot.model, batch)
    for error in mutations():
        links = concerned(error, robot.model)
        if links is not None:
            if not links:
                assert same(run(robot.model, batch, [error]), plain), error
            for i in set(range(len(robot.link_names))) - set(links):
                if is_local(error):
                    assert same(run(robot.model, batch, [at(error, i)]), plain), (error, i)


@pytest.mark.slow
def test_few_are_listed_where_they_change_nothing() -> None:
    """Gravity alone sees how the root is turned, and a leaf gets a force from a payload alone."""
    robot = load(len(TREES) - 1)
    batch = drawn(robot)
    plain = run(robot.model, batch)
    variant = Variant(robot.model)
    found = [one for one in mechanics(robot.model) if one.link != robot.link_names[0]]
    silent = [one for one in found if same(one.apply(variant, ()).evaluate(batch), plain)]
    assert len(silent) < 0.02 * len(found), [one.sentence for one in silent]


def test_every_error_of_the_recursion_is_in_the_catalogue_of_some_robot() -> None:
    listed = {one.id for number in range(len(TREES)) for one in mechanics(load(number).model)}
    tilted = mechanics(rttrr_pin.load(random_tree(*MUTATED), gravity=(1.0, 2.0, -9.0)).model)
    assert listed | {one.id for one in tilted} == {one.id for one in mutations()}
