"""Errors in the recursion change it where they are run, and nowhere else."""

from __future__ import annotations

import ast
import random
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin.core import dynamics
from rttrr_pin.core.payload import Load
from rttrr_pin.diagnosis.variants.mutations import (
    EQUIVALENT,
    STEPS,
    Mutation,
    at,
    compiled,
    functions,
    generated,
    is_local,
    mutated,
    mutation,
    mutations,
    place_of,
)
from rttrr_pin.diagnosis.variants.operators import Syntax, rewritten
from rttrr_pin.diagnosis.variants.variant import Values, run
from rttrr_pin.exact.intervals import INTERVAL, interval
from rttrr_pin.implementations import Batch
from rttrr_pin.validation import Sampler
from support.mutants import planted
from support.robots import driven
from support.trees import MUTATED, random_tree

LINK = 4
"""It floats on a link that moves, and carries another."""

IDS = [one.id for one in mutations()]

AT_LINK = [at(one, LINK) for one in mutations() if is_local(one)]


@pytest.fixture(scope="module")
def robot() -> Robot:
    return driven(rttrr_pin.load(random_tree(*MUTATED), gravity=(1.0, 2.0, -9.0)))


@pytest.fixture(scope="module")
def batch(robot: Robot) -> Batch:
    """A state with payloads in both kinds of axes."""
    loads = (
        Load(len(robot.link_names) - 1, np.array([1.0, -2.0, 3.0]), np.array([0.5, 2.0, -1.5])),
        Load(LINK, np.array([-4.0, 5.0, 2.5]), np.array([3.0, 1.0, -2.0]), in_base=True),
    )
    return replace(Sampler(robot.model).draw(0, 1), loads=loads)


def same(one: Values, other: Values) -> bool:
    return all(np.array_equal(values, other[key]) for key, values in one.items())


def values(batch: Batch, *errors: Mutation) -> Values:
    return run(batch.model, batch, errors)


def test_what_runs_is_what_planting_runs_and_differs(batch: Batch) -> None:
    plain = values(batch)
    for error in (*mutations(), *(one for one in AT_LINK if one.function in STEPS)):
        with planted(error):
            expected = values(batch)
        assert same(values(batch, error), expected), error
        if error.link is None:
            assert not same(expected, plain), error
    assert same(values(batch), plain)


def test_errors_that_change_no_number_are_left_out(batch: Batch) -> None:
    every = {one.id: one for function in functions().values() for one in generated(function)}
    assert set(every) - set(IDS) == set(EQUIVALENT)
    assert all(same(values(batch, every[name]), values(batch)) for name in EQUIVALENT)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("part", range(4))
def test_an_error_at_each_link_is_the_error_at_all(robot: Robot, batch: Batch, part: int) -> None:
    links = range(len(robot.link_names))
    for error in mutations()[part::4]:
        if is_local(error):
            assert same(values(batch, *(at(error, i) for i in links)), values(batch, error)), error


def test_an_error_at_a_link_changes_the_motion_of_no_link_before_it(robot: Robot, batch: Batch) -> None:
    """Forces and moments of links that it does not carry, and that do not carry it, stay the same."""
    others = [i for i in range(len(robot.link_names)) if LINK not in robot.model.path(i)]
    plain = values(batch)
    for error in AT_LINK:
        wrong = values(batch, error)
        assert all(np.array_equal(wrong[key][:, others], plain[key][:, others]) for key in "FN"), error


def test_two_at_once_are_both(batch: Batch) -> None:
    draw = random.Random(3)
    for _ in range(80):
        pair = draw.sample(mutations(), 2)
        with planted(*pair):
            expected = values(batch)
        assert same(values(batch, *pair), expected), pair


def test_two_at_links_of_their_own_are_both(batch: Batch) -> None:
    draw = random.Random(4)
    steps = [one for one in mutations() if one.function in STEPS]
    for _ in range(40):
        pair = [
            at(one, link) for one, link in zip(draw.sample(steps, 2), draw.choices((LINK, None, 2), k=2), strict=True)
        ]
        with planted(*pair):
            expected = values(batch)
        assert same(values(batch, *pair), expected), pair


N = (
    "outwards: {} body.I @ w_dot",
    "outwards: {} w.cross(body.I @ w)",
    "outwards: exchange operands of w.cross(body.I @ w)",
)


@pytest.mark.parametrize(
    ("ids", "statement"),
    [
        ((N[0].format("drop"), N[1].format("negate")), "N = keep(w.cross(body.I @ w) * -1)"),
        ((N[1].format("negate"), N[2]), "N = keep(body.I @ w_dot - (body.I @ w).cross(w))"),
        ((N[0].format("drop"), N[1].format("drop")), "N = keep(body.I @ w_dot * 0)"),
        ((N[0].format("drop"), N[0].format("negate")), "N = keep(w.cross(body.I @ w))"),
        ((N[0].format("negate"), N[0].format("drop")), "N = keep(body.I @ w_dot * -1 + w.cross(body.I @ w))"),
    ],
)
def test_two_in_one_statement_are_both_and_the_first_counts_where_they_exclude_each_other(
    ids: Sequence[str], statement: str
) -> None:
    errors = [mutation(one) for one in ids]
    syntax, node = place_of(errors[0])
    assert ast.unparse(rewritten(syntax, errors, of=syntax.statement(node))) == statement


def test_no_other_run_sees_an_error(batch: Batch) -> None:
    """Not before, not after, and not in another thread meanwhile."""
    plain = values(batch)
    errors = [mutation("outwards: drop w.cross(body.I @ w)"), at(mutation("rotation: drop across * c"), LINK)]
    wrong = values(batch, *errors)
    assert not same(wrong, plain)

    def runs(k: int) -> bool:
        return same(values(batch, *errors), wrong) if k % 2 else same(values(batch), plain)

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(runs, range(200)))
    assert same(values(batch), plain)


def test_it_runs_in_other_arithmetics(robot: Robot, batch: Batch) -> None:
    error = at(mutation("outwards: drop w.cross(w.cross(r_C))"), LINK)
    q, v, a = ([float(x) for x in rows[0]] for rows in (batch.q, batch.v, batch.a))
    one = mutated([error])(robot.model, INTERVAL, *([interval(x) for x in column] for column in (q, v, a))).tau
    other = run(robot.model, replace(batch, loads=()), [error])["tau"][0]
    assert np.allclose([float(x.mid()) for x in one], other, rtol=1e-12, atol=1e-9)


def test_none_is_the_recursion_itself() -> None:
    assert mutated([]) is dynamics.dynamics


def test_what_all_links_share_is_at_no_link_alone() -> None:
    with pytest.raises(ValueError, match="gravity"):
        at(mutation("newton_euler: drop the sign of -gravity"), 2)


def test_the_code_is_that_of_the_file() -> None:
    """An error names the line that it is in."""
    for one in mutations():
        assert one.original != one.statement
        compiled(one.function, [one])
    (one,) = [x for x in mutations() if x.id == "outwards: drop w.cross(body.I @ w)"]
    assert one.file == "core/newton_euler.py" and one.statement == "N = keep(body.I @ w_dot)"


def test_a_syntax_tree_is_never_changed() -> None:
    source = "def f(a, b):\n    return a.cross(b) + b\n"
    syntax = Syntax.of(source, "f")
    before = ast.dump(syntax.tree)
    k = next(k for k, node in enumerate(syntax.nodes) if isinstance(node, ast.BinOp))
    edit = Mutation("", "f", "drop", "b", "", "", "", 0, k, 2)
    assert ast.unparse(rewritten(syntax, [edit])) == "def f(a, b):\n    return a.cross(b)"
    assert ast.dump(syntax.tree) == before
