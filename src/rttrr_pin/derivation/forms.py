"""Derive quantities of a robot in symbols: what is written out, and what is written step by step."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, product
from typing import TYPE_CHECKING, Any

from rttrr_pin.core.arguments import names_of, whole_number
from rttrr_pin.core.model import Model
from rttrr_pin.derivation.closed_forms import TooLongError, closed_forms
from rttrr_pin.derivation.quantities import DEFAULT, QUANTITIES, Extent, Index
from rttrr_pin.derivation.ring import Ring
from rttrr_pin.derivation.stepwise import Step, Stepwise, needed
from rttrr_pin.derivation.symbolic_robot import ParameterSymbols, SymbolicRobot, default_symbols
from rttrr_pin.derivation.symbols import Expression, Symbol
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.reporting.results import Summarised
from rttrr_pin.robot import model_of

if TYPE_CHECKING:
    from rttrr_pin.robot import Robot

FORMS = ("auto", "expanded", "stepwise")

MOST_TERMS = 10_000
"""In all that was asked for: more than that nobody reads, and `auto` names steps instead."""


@dataclass(frozen=True)
class Derived:
    """One quantity.

    Attributes:
        name: as in `QUANTITIES`.
        shape: of its array for one state.
        terms: of each entry, by its index from 0.
    """

    name: str
    shape: tuple[int, ...]
    terms: Mapping[Index, Expression]


@dataclass(frozen=True, eq=False, repr=False)
class Derivation(Summarised):
    """Quantities of a robot as polynomials.

    Attributes:
        robot: the robot in symbols.
        form: "expanded" or "stepwise".
        reason: why this form, in words.
        steps: what is named on the way, each in parameter symbols and earlier names; none in expanded form.
        quantities: by name.
    """

    robot: SymbolicRobot
    form: str
    reason: str
    steps: tuple[Step, ...]
    quantities: Mapping[str, Derived]

    @property
    def symbols(self) -> dict[str, Symbol]:
        """Every symbol that may occur, by name, in a fixed order."""
        symbols = (*self.robot.motion, *self.robot.parameters.symbols, *(step.symbol for step in self.steps))
        return {symbol.name: symbol for symbol in symbols}

    @property
    def ring(self) -> Ring:
        """The polynomials in these symbols."""
        return Ring(self.symbols.values())

    @property
    def passed(self) -> bool:
        """True: what was derived is right by construction; results of all features have this property."""
        return True

    def count(self) -> int:
        """The number of terms in all."""
        return sum(map(len, self.all_terms()))

    def summary(self) -> str:
        """Robot, form, quantities and length in one line."""
        names = ", ".join(self.quantities)
        return f"{self.robot.model.name}: {names} in {self.form} form ({self.reason}), {self.count():,} terms in all"

    def to_dict(self) -> dict[str, Any]:
        """The polynomials as data for JSON: of each term the coefficient, a fraction as text, and the powers."""
        return {
            "schema": 1,
            "robot": self.robot.model.name,
            "form": self.form,
            "symbols": {name: symbol.latex for name, symbol in self.symbols.items()},
            "steps": {step.symbol.name: _data(step.terms) for step in self.steps},
            "quantities": {
                name: [{"index": at, "terms": _data(terms)} for at, terms in derived.terms.items()]
                for name, derived in self.quantities.items()
            },
        }

    def all_terms(self) -> Iterable[Expression]:
        """Every polynomial: of the steps, then of the entries."""
        yield from (step.terms for step in self.steps)
        for derived in self.quantities.values():
            yield from derived.terms.values()


def _data(expression: Expression) -> list[dict[str, Any]]:
    return [{"coefficient": str(x), "powers": dict(factors)} for factors, x in expression.items()]


def derive(
    robot: Robot | Model,
    quantities: str | Iterable[str] = DEFAULT,
    form: str = "auto",
    parameters: ParameterSymbols | None = None,
    payload_link: str | int | None = None,
    right_angles: bool = False,
) -> Derivation:
    """Derive quantities of a robot in symbols, by the recursion of `newton_euler` over polynomials.

    Args:
        robot: the robot, or its model.
        quantities: names of `QUANTITIES`: v_dot_C, F, N, f, n, tau, M, C, g.
        form: "expanded" writes each entry in the parameter symbols alone; "stepwise" names the vectors that the
            recursion finishes on each link, for robots whose expanded form nobody could read; "auto" expands up to
            `MOST_TERMS` terms.
        parameters: what stands for the robot's numbers; None names each that is not zero, `ParameterSymbols()` keeps
            the numbers.
        payload_link: the link that the payload acts at, by name or index; None: there is none, or, where parameters
            are None, the only link that carries no other.
        right_angles: whether rotations within 1e-4 of right angles are read as such.

    Returns:
        Polynomials in the parameter symbols, coordinates, rates, accelerations, sines and cosines, in SI units.

    Raises:
        UnknownNameError: there is no such quantity, form or link.
        InputError: no quantity is asked for.
    """
    model = robot if isinstance(robot, Model) else model_of(robot)
    wanted = _quantities(quantities)
    if not isinstance(form, str) or form not in FORMS:
        raise UnknownNameError("form", form, FORMS)
    link = only_leaf(model) if payload_link is None and parameters is None else _link_of(model, payload_link)
    parameters = default_symbols(model, link) if parameters is None else parameters
    if not isinstance(parameters, ParameterSymbols):
        raise InputError(f"parameters is a {type(parameters).__name__}: pass ParameterSymbols(...) or None")
    symbolic = SymbolicRobot(model, parameters, link, right_angles)
    if form == "stepwise":
        return _stepwise(symbolic, wanted, "as asked for")
    if form == "expanded":
        return _expanded(symbolic, wanted, None)
    try:
        return _expanded(symbolic, wanted, MOST_TERMS)
    except TooLongError:
        return _stepwise(symbolic, wanted, f"written out it would have more than {MOST_TERMS:,} terms")


def _quantities(quantities: str | Iterable[str]) -> tuple[str, ...]:
    """The quantities that are asked for, each once."""
    wanted = tuple(dict.fromkeys(names_of("quantities", quantities)))
    for name in wanted:
        if name not in QUANTITIES:
            raise UnknownNameError("quantity", name, QUANTITIES)
    if not wanted:
        raise InputError(f"no quantity is asked for: name some of {', '.join(QUANTITIES)}")
    return wanted


def _link_of(model: Model, link: str | int | None) -> int | None:
    """The index of a link, by its name or by itself."""
    if link is None or isinstance(link, str):
        return None if link is None else model.link_index(link)
    return whole_number("payload_link", link, 0, len(model.links) - 1)


def only_leaf(model: Model) -> int | None:
    """The link that carries no other, where there is exactly one."""
    leaves = model.leaves()
    return leaves[0] if len(leaves) == 1 else None


def _expanded(robot: SymbolicRobot, quantities: Sequence[str], most_terms: int | None) -> Derivation:
    ring, forms = robot.ring, closed_forms(robot, most_terms)
    derived = {}
    for name in quantities:
        rows = getattr(forms, name)
        entries = rows if QUANTITIES[name].extent is Extent.JOINTS else chain.from_iterable(rows)
        derived[name] = _derived(robot.model, name, map(ring.terms, entries))
    result = Derivation(robot, "expanded", "as asked for", (), derived)
    if most_terms is None:
        return result
    if result.count() > most_terms:
        raise TooLongError
    return replace(result, reason=f"up to {most_terms:,} terms in all are written out")


def _stepwise(robot: SymbolicRobot, quantities: Sequence[str], reason: str) -> Derivation:
    runs = Stepwise(robot)
    derived = {name: _derived(robot.model, name, runs.quantity(name)) for name in quantities}
    results = [terms for quantity in derived.values() for terms in quantity.terms.values()]
    return Derivation(robot, "stepwise", reason, tuple(needed(runs.steps.values(), results)), derived)


def _derived(model: Model, name: str, terms: Iterable[Expression]) -> Derived:
    shape = QUANTITIES[name].extent.shape(model)
    return Derived(name, shape, dict(zip(product(*map(range, shape)), terms, strict=True)))
