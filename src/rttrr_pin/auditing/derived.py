"""Stage 2: the publication's robot -> the right-hand side of each component, from the recursion run on its symbols."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from rttrr_pin.auditing.publication import Publication, component_of
from rttrr_pin.derivation.closed_forms import closed_forms
from rttrr_pin.derivation.symbolic_robot import ParameterSymbols, SymbolicRobot
from rttrr_pin.derivation.symbols import Expression, Symbol, renamed


@dataclass(frozen=True)
class Derived:
    """The right-hand sides that are right.

    Attributes:
        symbols: by name.
        expressions: of each component, by its name, such as F5z.
    """

    symbols: Mapping[str, Symbol]
    expressions: Mapping[str, Expression]

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
    return tuple(_derived(robot, names) for robot in robots)


def _derived(robot: SymbolicRobot, names: Sequence[str]) -> Derived:
    forms = closed_forms(robot)
    quantities = {"vC": forms.v_dot_C, "F": forms.F, "N": forms.N, "f": forms.f, "n": forms.n, "tau": forms.tau}
    expressions = {name: robot.ring.terms(component_of(name, quantities)) for name in names}
    return Derived(robot.ring.symbols, expressions)


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
