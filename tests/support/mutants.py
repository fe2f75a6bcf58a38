"""Errors planted in the reference recursion of this process: those of `diagnosis`, and a few that no human makes.

The latter only break linearity or scaling, or change the tenth digit. `planted` swaps the compiled code of a function,
so that whatever runs the recursion has the error.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from functools import lru_cache
from types import FunctionType
from typing import Any

import pytest

from rttrr_pin.core import dynamics, newton_euler
from rttrr_pin.diagnosis.variants.mutations import EQUIVALENT, STEPS, compiled, functions, generated
from rttrr_pin.diagnosis.variants.mutations import Mutation as Mutant
from rttrr_pin.diagnosis.variants.operators import Error, cross_product, errors, is_sum, summed, terms

__all__ = ["DETUNED", "EQUIVALENT", "Mutant", "mutant", "mutants", "planted"]

DETUNED = "2**-30"
"""Relative size of the error that the operator `detune` makes of a term."""


@lru_cache
def mutants(link: int | None = None) -> list[Mutant]:
    """Every error, at all links; or those of the steps on a link, at this link alone."""
    chosen = [function for name, function in functions().items() if link is None or name in STEPS]
    return [replace(one, link=link) for function in chosen for one in generated(function, all_errors)]


def mutant(identity: str) -> Mutant:
    """The error of that id."""
    return next(one for one in mutants() if one.id == identity)


@contextmanager
def planted(*mutants: Mutant) -> Iterator[None]:
    """Run the reference recursion with the errors; those at one link alone are in its steps."""
    with ExitStack() as stack:
        for name in dict.fromkeys(one.function for one in mutants):
            own = [one for one in mutants if one.function == name]
            stack.enter_context(_planted(functions()[name], [one for one in own if one.link is None]))
            for link in {one.link for one in own} - {None}:
                stack.enter_context(_planted_at(link, name, [one for one in own if one.link in (None, link)]))
        yield


@contextmanager
def _planted(function: FunctionType, mutants: list[Mutant]) -> Iterator[None]:
    original = function.__code__
    if mutants:
        function.__code__ = compiled(function.__qualname__, mutants, all_errors)
    try:
        yield
    finally:
        function.__code__ = original


@contextmanager
def _planted_at(link: int, name: str, mutants: list[Mutant]) -> Iterator[None]:
    assert name in STEPS
    step_before, recursion_before = getattr(newton_euler, name), dynamics.newton_euler
    wrong = FunctionType(compiled(name, mutants, all_errors), vars(newton_euler))
    target: list[Any] = [None]

    def step(body: Any, *rest: Any) -> Any:
        return (wrong if body is target[0] else step_before)(body, *rest)

    def recursion(bodies: Any, *rest: Any) -> Any:
        target[0] = bodies[link]
        return recursion_before(bodies, *rest)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(newton_euler, name, step)
        patch.setattr(dynamics, "newton_euler", recursion)
        yield


def all_errors(node: ast.AST, function: str, inner: bool) -> Iterator[Error]:
    """Errors that people make, then others."""
    yield from errors(node, function, inner)
    yield from _artificial(node, function, inner)


def _artificial(node: ast.AST, function: str, inner: bool) -> Iterator[Error]:
    """A term changed in the tenth digit, a cross product with itself or for its last operand, a number squared."""
    line = getattr(node, "lineno", 0)
    if is_sum(node) and not inner and function in STEPS:
        parts = [(sign, ast.unparse(term)) for sign, term in terms(node)]
        for k, (sign, term) in enumerate(parts):
            changed = (sign, f"({term}) * (1 + {DETUNED})")
            yield Error("detune", term, summed([*parts[:k], changed, *parts[k + 1 :]]), line)
    elif (operands := cross_product(node)) is not None:
        a, b = (f"({ast.unparse(x)})" for x in operands)
        yield Error("repeat", ast.unparse(node), f"{a}.cross({a}.cross{b})", line)
        if cross_product(operands[1]) is None:
            yield Error("keep the last of", ast.unparse(node), b, line)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub) and ast.unparse(node.operand) == "gravity":
        yield Error("square", "gravity", "gravity * -gravity.dot(gravity)", line)
    elif isinstance(node, ast.Attribute) and ast.unparse(node) == "body.M" and isinstance(node.ctx, ast.Load):
        yield Error("square", "body.M", "(body.M * body.M)", line)
