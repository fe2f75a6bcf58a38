"""Ours against other programs, on the states of one robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import LinkWrenches, Wrench
from rttrr_pin.errors import InputError
from rttrr_pin.exact import Adjudication
from rttrr_pin.implementations import Evaluation, Oracle, make_oracle
from rttrr_pin.robot import Robot
from rttrr_pin.validation.adjudicate import adjudicate_state
from rttrr_pin.validation.compare import Comparison, Gap, Ranking, Row
from rttrr_pin.validation.ours import Ours
from rttrr_pin.validation.states import Sampler, States

HUGE = 1e140
"""Numbers whose squares, times anything that occurs, stay within float64."""

Oracles = str | Sequence[str]
"""One of `oracles.ORACLES`, or several."""


@dataclass(frozen=True, slots=True)
class Reference:
    """Another program, and what was seen of it.

    Attributes:
        oracle: the program.
        comparison: gathers how far it is from ours.
    """

    oracle: Oracle
    comparison: Comparison

    @property
    def label(self) -> str:
        """Name and version."""
        return f"{self.oracle.name} {self.oracle.version}"


@dataclass(frozen=True, slots=True)
class Sides:
    """What all programs make of the same states.

    Attributes:
        ours: our result.
        bound: the bound on our rounding.
        theirs: the opponents', in their order.
    """

    ours: LinkWrenches
    bound: LinkWrenches
    theirs: tuple[Evaluation, ...]


@dataclass(frozen=True, slots=True)
class ComparisonRun:
    """Ours and other programs on the states of a robot.

    Attributes:
        robot: the robot.
        sampler: draws the states.
        ours: our side.
        references: the others.
        ranking: the states to look at again, by the largest share against any opponent.
    """

    robot: Robot
    sampler: Sampler
    ours: Ours
    references: tuple[Reference, ...]
    ranking: Ranking = field(default_factory=Ranking)

    @classmethod
    def of(
        cls, robot: Robot, seed: int, sampling: str, payload: Wrench | str | None, oracle: Oracles, states: int
    ) -> ComparisonRun:
        """Prepare to compare so many states.

        Raises:
            InputError: an argument cannot be used.
            OracleError: an oracle is missing, refuses the robot, or built another model than the file describes.
        """
        if not isinstance(robot, Robot):
            raise InputError(f"robot is a {type(robot).__name__}: pass a Robot, such as rttrr_pin.load({robot!r})")
        if not robot.model.links:
            raise InputError(f"robot {robot.name!r} has no joint, so that there is nothing to compare")
        sampler = Sampler(robot.model, sampling, seed, _payload(robot, payload))
        others = [make_oracle(name, robot.model) for name in _names(oracle)]
        references = (Reference(other, Comparison(robot.model, other.quantities)) for other in others)
        return cls(robot, sampler, Ours(robot, states), tuple(references))

    @property
    def rows(self) -> list[tuple[Reference, Row]]:
        """What was seen of each quantity at each place, opponent by opponent."""
        return [(reference, row) for reference in self.references for row in reference.comparison.rows]

    def sides(self, drawn: States) -> Sides:
        """Ours, the bound on it, and the opponents'."""
        with np.errstate(over="ignore", invalid="ignore"):  # what overflows is shown as a failure, with its state
            ours, bound = self.ours(drawn)
            _check_size(ours, drawn.first)
            theirs = (x.oracle.evaluate(drawn.q, drawn.v, drawn.a, drawn.loads) for x in self.references)
            return Sides(ours, bound, tuple(theirs))

    def add(self, drawn: States) -> None:
        """Take in some states."""
        sides = self.sides(drawn)
        shares = [
            reference.comparison.add(drawn.first, sides.ours, theirs, sides.bound)
            for reference, theirs in zip(self.references, sides.theirs, strict=True)
        ]
        self.ranking.see(np.max(shares, axis=0), drawn.first)

    def gaps(self, drawn: States) -> list[Gap]:
        """How far apart ours and the others are, one for each of `rows`."""
        return self.gaps_of(self.sides(drawn))

    def gaps_of(self, sides: Sides) -> list[Gap]:
        """The same of what is computed already."""
        pairs = zip(self.references, sides.theirs, strict=True)
        return [gap for other, theirs in pairs for gap in other.comparison.gaps(sides.ours, theirs, sides.bound)]

    def adjudicated(self, drawn: States) -> tuple[Adjudication, ...]:
        """Who is right in one state, one settlement for each opponent."""
        return self.adjudicate_results(drawn, self.sides(drawn))

    def adjudicate_results(self, drawn: States, sides: Sides) -> tuple[Adjudication, ...]:
        """The same of what is computed already."""
        named = [(x.oracle.name, theirs) for x, theirs in zip(self.references, sides.theirs, strict=True)]
        return adjudicate_state(self.robot.model, drawn, sides.ours, sides.bound, named)


def _names(oracle: Oracles) -> list[str]:
    """The oracles that are asked for, each once."""
    names = [oracle] if isinstance(oracle, str) else list(oracle)
    if not names:
        raise InputError("no oracle is named: name at least one, such as 'pinocchio'")
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(f"oracle {twice[0]!r} is named {names.count(twice[0])} times: once is enough")
    return names


def _payload(robot: Robot, payload: Wrench | str | None) -> Load | str | None:
    """For the sampler: a load, or the name of the link that gets a random one."""
    if payload is None:
        return None
    if isinstance(payload, str):
        if payload != "random":
            raise InputError(f"payload is {payload!r}: expected 'random' or a Wrench")
        return robot.link_names[robot.payload_link(None)]
    load = robot.load_of(payload)
    if load.f.ndim > 1 or load.n.ndim > 1:
        raise InputError("the payload of a validation has a batch axis: pass one force and one moment of 3 numbers")
    return load


def _check_size(ours: LinkWrenches, first: int) -> None:
    """Norms square what they are of: numbers whose squares overflow cannot be compared."""
    for key, x in ours.items():
        sizes = np.abs(x).reshape(len(x), -1).max(axis=1, initial=0.0)
        if not (sizes <= HUGE).all():
            row = int(np.argmax(~(sizes <= HUGE)))
            raise InputError(
                f"{key} reaches {sizes[row]:.1e} in state {first + row}, beyond {HUGE:.0e}, which no norm can hold: "
                "pass gravity, payload and masses of a size that a robot can have"
            )
