"""Closed forms as programs, before they are Python or C: what each function takes, computes and gives."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction

from rttrr_pin.derivation import QUANTITIES, Derivation
from rttrr_pin.derivation.collect import Presenter
from rttrr_pin.derivation.motion import angles
from rttrr_pin.derivation.quantities import Index
from rttrr_pin.derivation.stepwise import needed
from rttrr_pin.derivation.symbols import Expression, Factors, Role
from rttrr_pin.derivation.tree import Sum
from rttrr_pin.derivation.writers.glossary import axis_units, labelled, payload_places
from rttrr_pin.derivation.writers.printing import Notation, lines
from rttrr_pin.derivation.writers.wording import plain

WIDTH = 112
"""Characters in a line of code."""


@dataclass(frozen=True)
class Routine:
    """A function for one quantity.

    Attributes:
        name: of the quantity.
        inputs: which of q, v, a, payload it takes.
        symbols: what the expressions use, but for steps.
        steps: what is computed on the way: names and expressions.
        entries: of the result: index, and an expression, or the index of an earlier entry that is the same.
    """

    name: str
    inputs: tuple[str, ...]
    symbols: tuple[str, ...]
    steps: tuple[tuple[str, Sum], ...]
    entries: tuple[tuple[Index, Sum | Index], ...]


def routine(derivation: Derivation, name: str) -> Routine:
    """The function for a quantity."""
    quantity, derived = QUANTITIES[name], derivation.quantities[name]
    presenter = Presenter(derivation.symbols)
    steps = needed(derivation.steps, derived.terms.values())
    used = _used([*(step.terms for step in steps), *derived.terms.values()])
    order = [x for x, symbol in derivation.symbols.items() if x in used and symbol.role is not Role.STEP]
    payload = ("payload",) if quantity.payload and derivation.robot.payload_link is not None else ()
    return Routine(
        name,
        (*quantity.inputs, *payload),
        tuple(order),
        tuple((step.symbol.name, presenter.expression(step.terms)) for step in steps),
        tuple(_entries(derived.terms, presenter)),
    )


@dataclass(frozen=True)
class Language:
    """How a programming language writes what goes in; each form has a place for one expression."""

    power: Callable[[str, int], str]
    sine: str
    cosine: str
    sign: str
    parameter: str

    @property
    def notation(self) -> Notation:
        """Of expressions."""
        return Notation(lambda x: repr(float(x)), self.power, " * ", len, "    ")

    def expression(self, expression: Sum, room: int) -> list[str]:
        """An expression in lines that fit."""
        return lines(expression, self.notation, room)

    def definition(self, name: str, derivation: Derivation) -> str:
        """What a symbol is made of."""
        symbol = derivation.symbols[name]
        match symbol.role:
            case Role.COORDINATE | Role.RATE | Role.ACCELERATION:
                return f"{name[0]}[{symbol.index - 1}]"
            case Role.SINE | Role.COSINE:
                form = self.sine if symbol.role is Role.SINE else self.cosine
                return form.format(_angle(derivation, name[2:]))
            case Role.SIGN:
                return self.sign.format(f"v[{symbol.index - 1}]")
            case Role.PAYLOAD:
                place, sign = payload_places(derivation)[name]
                return f"{'-' if sign < 0 else ''}payload[{place}]"
        return self.parameter.format(name)


def arguments(derivation: Derivation) -> dict[str, str]:
    """What each input is, in words."""
    model = derivation.robot.model
    q_units, v_units = axis_units(model)
    q_names, v_names = [plain(name) for name in model.q_names], [plain(name) for name in model.v_names]
    link = derivation.robot.payload_link
    at = "" if link is None else plain(model.links[link].name)
    return {
        "q": f"coordinates: {labelled(q_names, q_units)}",
        "v": f"rates: {labelled(v_names, v_units)}",
        "a": f"accelerations: {labelled(v_names, [f'{unit}^2' for unit in v_units])}",
        "payload": f"force [N] and moment [N m], x y z each, that {at} exerts on its surroundings, at and in its frame",
    }


def width(derivation: Derivation, argument: str) -> int:
    """How many numbers an input has."""
    model = derivation.robot.model
    return {"q": model.nq, "v": model.nv, "a": model.nv, "payload": 6}[argument]


def _angle(derivation: Derivation, suffix: str) -> str:
    """The argument of a sine."""
    (angle,) = (angle for angle in angles(derivation.robot.model) if angle.suffix == suffix)
    coordinate = f"q[{angle.place - 1}]"
    if (angle.multiplier, angle.offset) == (1.0, 0.0):
        return coordinate
    return f"{angle.multiplier!r} * {coordinate} + {angle.offset!r}"


def _used(polynomials: list[Expression]) -> set[str]:
    return {name for terms in polynomials for factors in terms for name, _ in factors}


def _entries(entries: Mapping[Index, Expression], presenter: Presenter) -> Iterator[tuple[Index, Sum | Index]]:
    """Expressions; what an earlier entry already is, such as the mirror of a mass matrix, refers to that."""
    seen: dict[frozenset[tuple[Factors, Fraction]], Index] = {}
    for at, terms in entries.items():
        key = frozenset(terms.items())
        if len(terms) > 1 and key in seen:
            yield at, seen[key]
        else:
            seen[key] = at
            yield at, presenter.expression(terms)
