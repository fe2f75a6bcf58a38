"""Stage 2: the publication's robot -> the right-hand side of each component, from the recursion run on its symbols."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from rttrr_pin.auditing.printed import Quotient
from rttrr_pin.auditing.publication import Publication, component_of, parts_of
from rttrr_pin.auditing.solve import Solver, force_symbols
from rttrr_pin.derivation.closed_forms import TooLongError, closed_forms
from rttrr_pin.derivation.symbolic_robot import ParameterSymbols, SymbolicRobot
from rttrr_pin.derivation.symbols import Expression, Symbol, renamed
from rttrr_pin.errors import InputError

MOST_TERMS = 20_000
"""Of one component, in all symbols."""

SPELLED = {"vC": "v_dot_C"}
"""What closed forms call a quantity that is called otherwise here."""


@dataclass(frozen=True)
class Derived:
    """The right-hand sides that are right.

    Attributes:
        symbols: by name, those of the joints' forces included.
        expressions: of each component, by its name, such as F5z.
        solutions: of each acceleration, by its name, such as a2: the quotients that it is equal to. First by all
            equations, in coordinates, rates and forces, if that can be written out; then by each single one.
    """

    symbols: Mapping[str, Symbol]
    expressions: Mapping[str, Expression]
    solutions: Mapping[str, Sequence[Quotient]] = field(default_factory=dict)

    def flipped(self, names: Collection[str]) -> Derived:
        """The right-hand sides with the sign of some symbols turned, as another convention has it."""
        expressions = {
            component: {
                factors: -x if sum(power for name, power in factors if name in names) % 2 else x
                for factors, x in expression.items()
            }
            for component, expression in self.expressions.items()
        }
        return replace(self, expressions=expressions)


def derive(publication: Publication) -> tuple[Derived, ...]:
    """What is right: in the robot's symbols, and, where the text keeps equal symbols apart, in those too."""
    robots = [publication.robot, *([_with_aliases(publication)] if publication.aliases else [])]
    names = [name for equation in publication.equations for name in equation.names]
    try:
        return tuple(_derived(robot, names, publication.passive) for robot in robots)
    except TooLongError as error:
        message = f"a component of this robot's closed forms has more than {MOST_TERMS:,} terms: audit fewer joints"
        raise InputError(message) from error


def _derived(robot: SymbolicRobot, names: Sequence[str], passive: Collection[int]) -> Derived:
    forms = closed_forms(robot, MOST_TERMS)
    wanted = {parts_of(name)[0] for name in names}
    quantities = {name: getattr(forms, SPELLED.get(name, name)) for name in wanted - {"a"}}
    expressions = {name: robot.ring.terms(component_of(name, quantities)) for name in names if parts_of(name)[0] != "a"}
    symbols = {**robot.ring.symbols, **{symbol.name: symbol for symbol in force_symbols(robot)}}
    solutions = Solver(forms, symbols, passive).solutions() if "a" in wanted else {}
    return Derived(symbols, expressions, solutions)


def _with_aliases(publication: Publication) -> SymbolicRobot:
    """The robot whose tensors have other symbols below the diagonal: their terms cancel in part."""
    robot, parameters = publication.robot, publication.robot.parameters
    alias = {main: name for name, main in publication.aliases.items()}
    slots = dict(parameters.slots)
    for slot, expression in parameters.slots.items():
        if slot[0] == "inertia" and str(slot[2]) > str(slot[3]):
            slots[slot] = renamed(expression, alias)
    named = {symbol.name: symbol for symbol in parameters.symbols}
    spelling = {name: text for text, name in reversed(list(publication.spellings.items()))}
    new = [replace(named[main], name=name, latex=spelling[name]) for name, main in publication.aliases.items()]
    values = {**parameters.values, **{name: parameters.values[main] for name, main in publication.aliases.items()}}
    return replace(robot, parameters=ParameterSymbols((*parameters.symbols, *new), slots, values))
