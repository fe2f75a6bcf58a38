"""The recursion run on symbols: the closed forms of v_dot_C, F, N, f, n and tau."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from rttrr_pin.core.algebra import ZERO, Matrix, Vector
from rttrr_pin.core.dynamics import Result, dynamics
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.newton_euler import Keep
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.derivation.ring import Polynomial, exact
from rttrr_pin.derivation.symbolic_robot import SymbolicRobot


@dataclass(frozen=True)
class ClosedForms:
    """The five quantities, and the accelerations of the centres of mass, as polynomials.

    Attributes:
        robot: whose they are.
        v_dot_C: acceleration of the centre of mass of each link, gravity included, in {i}; equations (9)-(15).
        F, N, f, n: of each link, in {i}; (16)-(22), (23)-(30), (31)-(43).
        tau: of each degree of freedom.
    """

    robot: SymbolicRobot
    v_dot_C: list[Vector]
    F: list[Vector]
    N: list[Vector]
    f: list[Vector]
    n: list[Vector]
    tau: list[Polynomial]


class TooLongError(Exception):
    """A closed form has more terms than it may; caught where another form can be taken."""


def closed_forms(robot: SymbolicRobot, most_terms: int | None = None) -> ClosedForms:
    """Run the recursion on symbols.

    Args:
        robot: the robot in symbols.
        most_terms: how many terms a component of a vector may have; None for any number.

    Returns:
        Polynomials, reduced modulo c^2 + s^2 = 1.

    Raises:
        TooLongError: some component has more terms.
    """
    ring = robot.ring

    def keep(x: Vector) -> Vector:
        reduced = ring.reduced_vector(x)
        if most_terms is not None and max(len(ring.lift(component)) for component in reduced) > most_terms:
            raise TooLongError
        return reduced

    arithmetic = symbolic_arithmetic(robot, keep)
    result = _run(robot, arithmetic, robot.bodies())
    moved = _run(robot, arithmetic, unit_masses(robot.bodies()))
    vectors: Callable[[list[Vector]], list[Vector]] = lambda xs: [ring.reduced_vector(x) for x in xs]  # noqa: E731
    return ClosedForms(
        robot,
        v_dot_C=vectors(moved.F),
        F=vectors(result.F),
        N=vectors(result.N),
        f=vectors(result.f),
        n=vectors(result.n),
        tau=[ring.reduced(x) for x in result.tau],
    )


def unit_masses(bodies: Sequence[Body]) -> list[Body]:
    """Links of mass 1 without a tensor: the net force on such a link is the acceleration of its centre of mass."""
    return [replace(body, M=1, I=Matrix((ZERO, ZERO, ZERO))) for body in bodies]


def symbolic_arithmetic(robot: SymbolicRobot, keep: Keep | None = None) -> Arithmetic:
    """Polynomials as a kind of scalar: every finished vector is reduced at once, so none ever grows needlessly."""
    return Arithmetic(
        number=lambda value, error: exact(value),
        column=lambda values: exact(float(values)),
        sincos=robot.sincos,
        sign=robot.sign,
        keep=keep or robot.ring.reduced_vector,
    )


def _run(robot: SymbolicRobot, arithmetic: Arithmetic, bodies: Sequence[Body]) -> Result:
    return dynamics(
        robot.model, arithmetic, robot.q, robot.v, robot.a, robot.payloads, links=bodies, gravity=robot.gravity
    )
