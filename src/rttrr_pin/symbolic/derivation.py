"""The specification run on symbols: the closed forms of v_dot_C, F, N, f, n and tau."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from rttrr_pin.algebra import ZERO, Matrix, Vector
from rttrr_pin.arithmetic import Arithmetic, Result, dynamics
from rttrr_pin.joint_motion import Body
from rttrr_pin.symbolic.chain import SymbolicRobot
from rttrr_pin.symbolic.ring import Polynomial, exact


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


def closed_forms(robot: SymbolicRobot) -> ClosedForms:
    """Run the specification on symbols.

    Args:
        robot: the robot in symbols.

    Returns:
        Polynomials, reduced modulo c^2 + s^2 = 1.
    """
    ring = robot.ring
    result = _run(robot, robot.bodies())
    moved = _run(robot, [replace(body, M=1, I=Matrix((ZERO, ZERO, ZERO))) for body in robot.bodies()])
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


def symbolic_arithmetic(robot: SymbolicRobot) -> Arithmetic:
    """Polynomials as a kind of scalar: every finished vector is reduced at once, so none ever grows needlessly."""
    return Arithmetic(
        number=lambda value, error: exact(value),
        column=lambda values: exact(float(values)),
        sincos=robot.sincos,
        sign=robot.sign,
        keep=robot.ring.reduced_vector,
    )


def _run(robot: SymbolicRobot, bodies: list[Body]) -> Result:
    arithmetic = symbolic_arithmetic(robot)
    return dynamics(
        robot.model, arithmetic, robot.q, robot.v, robot.a, robot.payloads, links=bodies, gravity=robot.gravity
    )
