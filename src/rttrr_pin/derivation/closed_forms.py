"""The recursion run on symbols: the closed forms of v_dot_C, F, N, f, n and tau, and of M, C and g in tau."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from flint import fmpq

from rttrr_pin.core.algebra import ZERO, Matrix, Vector
from rttrr_pin.core.dynamics import Result, dynamics
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.newton_euler import Keep
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.derivation.ring import Polynomial, exact
from rttrr_pin.derivation.symbolic_robot import SymbolicRobot
from rttrr_pin.derivation.symbols import Role

HALF = fmpq(1, 2)


@dataclass(frozen=True)
class ClosedForms:
    """Quantities of a robot as polynomials, reduced modulo c^2 + s^2 = 1.

    M, C and g are tau taken apart: it is linear in the accelerations and of second degree in the rates, and

        tau = M(q) a + C(q, v) v + g(q) + payload + friction of the joints
        M_ij = d tau_i / d a_j
        C_ij = 1/2 sum over k of d^2 tau_i / d v_j d v_k v_k

    The second derivatives are twice the Christoffel symbols c_ijk of the first kind, which are symmetric in j and k. So
    dM/dt - 2 C is skew-symmetric where v is the time derivative of q; of planar and floating joints it is not, and only
    C v has a meaning.

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

    @cached_property
    def M(self) -> list[list[Polynomial]]:
        """Mass matrix, armature included, (nv, nv)."""
        ring = self.robot.ring
        accelerations = ring.names(Role.ACCELERATION)
        return [[ring.derivative(x, name) for name in accelerations] for x in self.tau]

    @cached_property
    def C(self) -> list[list[Polynomial]]:
        """Coriolis and centrifugal matrix, (nv, nv): C v is what the rates take."""
        ring = self.robot.ring
        rates = ring.names(Role.RATE)

        def entry(tau: Polynomial, rate: str) -> Polynomial:
            by_rate = ring.derivative(tau, rate)
            return sum((ring.derivative(by_rate, other) * ring[other] * HALF for other in rates), start=ring.lift(0))

        return [[entry(x, rate) for rate in rates] for x in self.tau]

    @cached_property
    def g(self) -> list[Polynomial]:
        """What holds the robot still, (nv,)."""
        ring = self.robot.ring
        return [ring.without(x, ring.names(*MOVING)) for x in self.tau]


MOVING = (Role.RATE, Role.ACCELERATION, Role.PAYLOAD, Role.SIGN)
"""What is 0 while a robot is held still, with nothing at its tool."""


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
    return ClosedForms(
        robot,
        v_dot_C=[ring.reduced_vector(x) for x in moved.F],
        F=[ring.reduced_vector(x) for x in result.F],
        N=[ring.reduced_vector(x) for x in result.N],
        f=[ring.reduced_vector(x) for x in result.f],
        n=[ring.reduced_vector(x) for x in result.n],
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
