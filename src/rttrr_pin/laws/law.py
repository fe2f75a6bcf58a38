"""What a law of mechanics is: an id, a name, a statement, and the residual that the law says is zero.

On scalars (value, error bound) the residual of a true law lies within its bound of zero, whatever rounding did, so
there is no tolerance to choose.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pkgutil import resolve_name
from typing import TypeAlias

from rttrr_pin.core.algebra import Scalar
from rttrr_pin.laws.case import Case

Residual: TypeAlias = Callable[[Case], Iterator[Scalar]]


@dataclass(frozen=True, slots=True)
class Law:
    """A law that inverse dynamics must keep.

    Attributes:
        id: stable; its letter is the kind of law: K kinematics, E energy and momentum, B balance of each link, M mass
            matrix, L linearity, I invariance, S scaling.
        name: in two or three words.
        statement: what holds.
        residual: the numbers that the law says are zero.
        reads: the quantities that it needs of a program, where any program can be checked; empty where the law needs
            the reference recursion itself, at other motions or for another description of the robot.
    """

    id: str
    name: str
    statement: str
    residual: Residual
    reads: tuple[str, ...] = ()

    def __reduce__(self) -> tuple[object, ...]:
        """By its name, which in its module is that of the law and no longer of the function."""
        return resolve_name, (f"{self.residual.__module__}:{self.residual.__name__}",)


def law(id: str, name: str, reads: tuple[str, ...] = ()) -> Callable[[Residual], Law]:
    """Make a law of the function that yields its residual; the statement is the first paragraph of its docstring."""

    def of(residual: Residual) -> Law:
        statement = (residual.__doc__ or name).partition("\n\n")[0]
        return Law(id, name, " ".join(statement.split()), residual, reads)

    return of
