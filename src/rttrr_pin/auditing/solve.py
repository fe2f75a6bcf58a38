"""Accelerations from forces, in symbols: M a = tau - C v - g, solved by Cramer's rule, and row by row."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from rttrr_pin.auditing.printed import Quotient
from rttrr_pin.derivation.closed_forms import ClosedForms
from rttrr_pin.derivation.motion import index
from rttrr_pin.derivation.ring import Polynomial, Ring
from rttrr_pin.derivation.symbolic_robot import SymbolicRobot
from rttrr_pin.derivation.symbols import FORCE, MOMENT, Role, Symbol
from rttrr_pin.errors import InputError

MOST_JOINTS, MOST_PRODUCTS = 4, 200_000
"""Of a robot whose equations are solved together, and products of terms on the way."""

Rows = Sequence[Sequence[Polynomial]]


def force_symbols(robot: SymbolicRobot) -> Iterator[Symbol]:
    """A symbol for the driving force of each degree of freedom."""
    for k, rotation in enumerate(robot.model.rotations, start=1):
        yield Symbol(f"tau_{k}", rf"\tau_{index(k)}", Role.PAYLOAD, MOMENT if rotation else FORCE, k)


class Solver:
    """Solves a robot's equations of motion for its accelerations.

    Attributes:
        symbols: of the robot, and of its forces.
        ring: the polynomials in these.
    """

    def __init__(self, forms: ClosedForms, symbols: Mapping[str, Symbol], passive: Collection[int]) -> None:
        self.symbols, self.ring = symbols, Ring(symbols.values())
        own = forms.robot.ring
        accelerations = own.names(Role.ACCELERATION)
        self._M = [[self._lifted(own, x) for x in row] for row in forms.M]
        rest = [self._lifted(own, own.without(x, accelerations)) for x in forms.tau]
        forces = [self.ring.lift(0) if k in passive else self.ring[f"tau_{k + 1}"] for k in range(len(rest))]
        self._right = [force - x for force, x in zip(forces, rest, strict=True)]

    def solutions(self) -> dict[str, list[Quotient]]:
        """The quotients that each acceleration, by its name such as a2, is equal to."""
        return {f"a{k + 1}": [*self._by_all(k), *self._by_rows(k)] for k in range(len(self._right))}

    def _by_all(self, k: int) -> Iterator[Quotient]:
        replaced = [[*row[:k], x, *row[k + 1 :]] for row, x in zip(self._M, self._right, strict=True)]
        numerator, denominator = self._determinant(replaced), self._determinant(self._M)
        if denominator is not None and not denominator:
            raise InputError("this robot's mass matrix is singular: forces do not tell its accelerations")
        if numerator is not None and denominator is not None:
            yield self._quotient(numerator, denominator)

    def _by_rows(self, k: int) -> Iterator[Quotient]:
        for row, x in zip(self._M, self._right, strict=True):
            if row[k]:
                others = (entry * self.ring[f"a_{j}"] for j, entry in enumerate(row, start=1) if j != k + 1)
                yield self._quotient(x - sum(others, start=self.ring.lift(0)), row[k])

    def _determinant(self, rows: Rows) -> Polynomial | None:
        """By the first row; None where it would take too long."""
        if not rows:
            return self.ring.lift(1)
        if len(rows) > MOST_JOINTS or max(len(x) for row in rows for x in row) ** len(rows) > MOST_PRODUCTS:
            return None
        total = self.ring.lift(0)
        for j, x in enumerate(rows[0]):
            if x:
                minor = self._determinant([[*row[:j], *row[j + 1 :]] for row in rows[1:]])
                total = total if minor is None else total + (-1) ** j * self.ring.reduced(x * minor)
        return self.ring.reduced(total)

    def _quotient(self, numerator: Polynomial, denominator: Polynomial) -> Quotient:
        common = numerator.gcd(denominator)
        above, below = (self.ring.terms(divmod(x, common)[0]) for x in (numerator, denominator))
        return Quotient(above, below)

    def _lifted(self, own: Ring, x: Polynomial) -> Polynomial:
        return self.ring.polynomial(own.terms(x))
