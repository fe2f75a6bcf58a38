"""`rttrr-pin mutate`."""

from __future__ import annotations

from typing import Any

import click

from rttrr_pin.errors import InputError, NumberError
from rttrr_pin.reporting.options import base, flag, friction, gravity, outcome, reading, robot, seed, xacro
from rttrr_pin.reporting.output import AGREE, DISAGREE, Output, progress, write_json
from rttrr_pin.validation.options import RunOptions

KINDS = ("gravity", "rates", "random", "payload", "fast", "cancelling", "units")


@click.command
@robot()
@click.option("--states", multiple=True, default=("random",), metavar="KIND", help=f"Of {', '.join(KINDS)}. Repeats.")
@click.option("-n", "count", default=10, help="How many states of each kind.")
@click.option("--atol", default="1e-6", metavar="NUMBER", help="Absolute tolerance [N, N m]; or rounding.")
@click.option("--rtol", default=0.0, help="Relative tolerance, of the right result.")
@click.option("--rates", type=float, metavar="NUMBER", help="Largest rate [rad/s, m/s]; without it the file's limits.")
@click.option(
    "--quantity", multiple=True, default=("tau",), metavar="NAME", help="What is compared: tau, F, N, f, n. Repeats."
)
@click.option(
    "--pytest", metavar="ARGUMENTS", help="Instead of states and tolerances: tests, run by pytest with these arguments."
)
@click.option(
    "--function", metavar="MODULE:NAME", help="The function f(q, v, a) that the tests call; without it, a fixture."
)
@click.option("--fixture", default="inverse_dynamics", help="The fixture that the tests have their function from.")
@click.option("--mutants", type=int, metavar="N", help="Try so many at most; by default all, or 200 with --pytest.")
@click.option("--size", default=0.1, help="How wrong numbers are: 0.1 is ten percent of a mass.")
@click.option("--least", default=100.0, metavar="PERCENT", help="Exit 1 below this score.")
@seed
@gravity
@base
@friction
@xacro
@reading
@flag("--full", help="List all that passes.")
@outcome
def mutate(
    states: tuple[str, ...],
    count: int,
    atol: str,
    rtol: float,
    rates: float | None,
    quantity: tuple[str, ...],
    pytest: str | None,
    function: str | None,
    fixture: str,
    mutants: int | None,
    size: float,
    least: float,
    full: bool,
    json: str | None,
    quiet: bool,
    **run: Any,
) -> int:
    """Tell how many wrong dynamics of a robot a suite of tests would let pass, and which: its mutation score.

    The suite is told as states and a tolerance, or run: --pytest "tests/test_dynamics.py".

    Exit code: 0 all are seen (or --least of them), 1 some pass, 2 unusable input.
    """
    if not 0.0 <= least <= 100.0:
        raise InputError(f"--least is {least:g}: expected percent, from 0 to 100")
    told = {"--states": states != ("random",), "-n": count != 10, "--atol": atol != "1e-6", "--rtol": rtol != 0.0}
    beside = [name for name, given in (told | {"--rates": rates is not None}).items() if given]
    if pytest is not None and beside:
        raise InputError(f"{', '.join(beside)} is of a suite that is told, and --pytest runs one: leave out either")
    options = RunOptions(**run)
    loaded = options.load(json)
    from rttrr_pin.conformance.mutation.mutation import mutate as score
    from rttrr_pin.conformance.mutation.mutation_report import show_score
    from rttrr_pin.conformance.mutation.pytest_suite import PytestSuite
    from rttrr_pin.conformance.mutation.suites import Tolerances

    if pytest is None and function is not None:
        raise InputError("--function goes with --pytest ARGUMENTS: name the tests that call it")
    most = mutants if mutants is not None or pytest is None else DRAWN
    with progress(most, quiet, "wrong dynamics") as advance:
        suite: Tolerances | PytestSuite
        if pytest is not None:
            suite = PytestSuite(pytest, function, fixture, quantity, advance)
        else:
            suite = Tolerances(states, count, _tolerance(atol), rtol, quantity, rates, options.seed)
        result = score(loaded, suite, most, size, options.seed)
    write_json(json, result.to_dict)
    show_score(result, Output(quiet=quiet or json == "-"), full)
    return AGREE if 100.0 * result.score >= least else DISAGREE


DRAWN = 200
"""Mutants that tests are run on unless it is said how many."""


def _tolerance(text: str) -> float | None:
    """A number, or None for rounding."""
    if text == "rounding":
        return None
    try:
        return float(text)
    except ValueError:
        raise NumberError(f"--atol is {text!r}: expected a number, or rounding", name="atol", value=text) from None
