"""Closed forms as programs, a function for each quantity: Python over NumPy, and C99."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from textwrap import TextWrapper
from typing import Any

from rttrr_pin.compile.emit.c_text import identifier
from rttrr_pin.derivation import QUANTITIES, Derivation
from rttrr_pin.derivation.collect import Presenter, Sum
from rttrr_pin.derivation.motion import angles
from rttrr_pin.derivation.quantities import Index
from rttrr_pin.derivation.stepwise import needed
from rttrr_pin.derivation.symbols import Factors, Role
from rttrr_pin.derivation.writers.glossary import axis_units, labelled, parameters, payload_places
from rttrr_pin.derivation.writers.printing import Notation, lines
from rttrr_pin.derivation.writers.templates import rendered
from rttrr_pin.derivation.writers.wording import conventions, names_of_links, plain

WIDTH = 112
"""Characters in a line of code."""

LONGEST_NAME = 60
"""Characters of a robot's name in those of functions: compilers tell 63 apart."""


@dataclass(frozen=True, slots=True)
class Argument:
    """What a function takes: its name, how many numbers it has, and what they are."""

    name: str
    width: int
    meaning: str


@dataclass(frozen=True)
class Language:
    """A programming language: the template of a file, and how it writes what goes in; each form has its places.

    Attributes:
        template: the file's name.
        power: a symbol to a power.
        sine, cosine, sign: of an expression.
        parameter: a number of the robot.
        variable: the declaration of a variable.
        entry: what an entry of the result is called, by its place in a row and its index.
        short: an assignment in one line.
        long: an assignment in several.
    """

    template: str
    power: Callable[[str, int], str]
    sine: str
    cosine: str
    sign: str
    parameter: str
    variable: str
    entry: Callable[[int, Index], str]
    short: str
    long: str

    def __call__(self, derivation: Derivation, preface: str = "") -> str:
        """A file that needs nothing but the language's own library of mathematics."""
        model = derivation.robot.model
        return rendered(
            self.template,
            {"wrapped": _wrapped, "uses": _uses},
            robot=identifier(model.name)[:LONGEST_NAME],
            title=f"Dynamic model of {plain(model.name)}: {', '.join(derivation.quantities)}.",
            texts=[
                *([preface] if preface else []),
                *conventions(derivation),
                f"Links and joints: {names_of_links(model)}.",
            ],
            parameters=list(parameters(derivation)),
            arguments=_arguments(derivation),
            routines=[self._routine(derivation, name) for name in derivation.quantities],
        )

    def _routine(self, derivation: Derivation, name: str) -> dict[str, Any]:
        """The function for a quantity, as the template takes it."""
        quantity, derived = QUANTITIES[name], derivation.quantities[name]
        presenter, steps = Presenter(derivation.symbols), needed(derivation.steps, derived.terms.values())
        polynomials = [*(step.terms for step in steps), *derived.terms.values()]
        used = {name for terms in polynomials for factors in terms for name, _ in factors}
        symbols = [x for x, symbol in derivation.symbols.items() if x in used and symbol.role is not Role.STEP]
        payload = ("payload",) if quantity.payload and derivation.robot.payload_link is not None else ()
        assignments = [
            self._assignment(self.variable.format(step.symbol.name), presenter.expression(step.terms)) for step in steps
        ]
        names = {at: self.entry(k, at) for k, at in enumerate(derived.terms)}
        seen: dict[frozenset[tuple[Factors, Fraction]], str] = {}
        for at, terms in derived.terms.items():
            # what an earlier entry is already, such as the mirror of a mass matrix, refers to that
            earlier = seen.setdefault(frozenset(terms.items()), names[at])
            same = len(terms) > 1 and earlier != names[at]
            assignments.append(self._assignment(names[at], earlier if same else presenter.expression(terms)))
        return {
            "name": name,
            "quantity": quantity,
            "shape": derived.shape,
            "inputs": [
                argument for argument in _arguments(derivation) if argument.name in (*quantity.inputs, *payload)
            ],
            "definitions": [
                self.short.format(self.variable.format(x), self._definition(x, derivation)) for x in symbols
            ],
            "assignments": assignments,
            "entries": list(names.values()),
        }

    def _definition(self, name: str, derivation: Derivation) -> str:
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
                column, sign = payload_places(derivation)[name]
                return f"{'-' if sign < 0 else ''}payload[{column}]"
        return self.parameter.format(name)

    def _assignment(self, name: str, value: Sum | str) -> str:
        notation = Notation(lambda x: repr(float(x)), self.power, " * ", len, "    ")
        first, *others = [value] if isinstance(value, str) else lines(value, notation, WIDTH - 8)
        if not others and len(name) + len(first) < WIDTH - 8:
            return self.short.format(name, first)
        return self.long.format(name, "\n".join(f"        {line}" for line in (first, *others)))


PYTHON = Language(
    "program.py.jinja",
    power=lambda name, power: name if power == 1 else f"{name}**{power}",
    sine="np.sin({})",
    cosine="np.cos({})",
    sign="np.sign({})",
    parameter='parameters["{}"]',
    variable="{}",
    entry=lambda k, at: f"entry_{k}",
    short="    {} = {}",
    long="    {} = (\n{}\n    )",
)

C = Language(
    "program.c.jinja",
    power=lambda name, power: " * ".join([name] * power),
    sine="sin({})",
    cosine="cos({})",
    sign="(double)(({0} > 0.0) - ({0} < 0.0))",
    parameter="parameters->{}",
    variable="const double {}",
    entry=lambda k, at: "out" + "".join(f"[{i}]" for i in at),
    short="    {} = {};",
    long="    {} =\n{};",
)


def _arguments(derivation: Derivation) -> Iterator[Argument]:
    model, link = derivation.robot.model, derivation.robot.payload_link
    q_units, v_units = axis_units(model)
    q_names, v_names = [plain(name) for name in model.q_names], [plain(name) for name in model.v_names]
    at = "" if link is None else plain(model.links[link].name)
    yield Argument("q", model.nq, f"coordinates: {labelled(q_names, q_units)}")
    yield Argument("v", model.nv, f"rates: {labelled(v_names, v_units)}")
    yield Argument("a", model.nv, f"accelerations: {labelled(v_names, [f'{unit}^2' for unit in v_units])}")
    yield Argument(
        "payload",
        6,
        f"force [N] and moment [N m], x y z each, that {at} exerts on its surroundings, at and in its frame",
    )


def _angle(derivation: Derivation, suffix: str) -> str:
    (angle,) = (angle for angle in angles(derivation.robot.model) if angle.suffix == suffix)
    coordinate = f"q[{angle.index - 1}]"
    if (angle.multiplier, angle.offset) == (1.0, 0.0):
        return coordinate
    return f"{angle.multiplier!r} * {coordinate} + {angle.offset!r}"


def _uses(lines: Sequence[str], argument: str) -> bool:
    """Whether an input occurs in definitions: in those of a function whose result is 0 it does not."""
    return any(f"{argument}[" in line or f"{argument}->" in line for line in lines)


def _wrapped(text: str, first: int = 0, others: int = 0) -> str:
    """A text in lines, the first and the others with so many blanks in front."""
    wrapper = TextWrapper(WIDTH, " " * first, " " * others, break_long_words=False, break_on_hyphens=False)
    return "\n".join(wrapper.wrap(text))  # a name stays whole
