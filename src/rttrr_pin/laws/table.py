"""The laws of mechanics that inverse dynamics must keep, as a table: id, statement, function.

Each function returns the residual of its law, which is zero if the law holds. On scalars (value, error bound) the
residual of a true law lies within its bound of zero, whatever rounding did, so there is no tolerance to choose.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from rttrr_pin.core.algebra import Scalar
from rttrr_pin.errors import UnknownNameError
from rttrr_pin.laws import balance, matrix, symmetry
from rttrr_pin.laws.case import Case


@dataclass(frozen=True, slots=True)
class Law:
    """A row of the table of laws.

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
    residual: Callable[[Case], Iterable[Scalar]]
    reads: tuple[str, ...] = ()


LAWS = (
    Law(
        "K101",
        "joint motion",
        "Placement and velocity of a joint agree: R' = R [w]x, p' = R v, w' = w_dot, v' = v_dot.",
        balance.joint_motion,
    ),
    Law(
        "E201",
        "power balance",
        "The driving power is the rate of energy, the power of the payload and that of friction and armature: "
        "tau . v = d/dt (T + V) + f_tool . v + n_tool . w + tau_joint . v.",
        balance.power,
        ("tau",),
    ),
    Law(
        "E202",
        "base force",
        "The base's force changes the linear momentum and carries weight and payload: f_0 = d/dt P - M g + f_tool.",
        balance.base_force,
        ("f",),
    ),
    Law(
        "E203",
        "base moment",
        "The base's moment about its origin, likewise: n_0 = d/dt L - p_C x M g + n_tool + p x f_tool.",
        balance.base_moment,
        ("f", "n"),
    ),
    Law(
        "B301",
        "Newton's law",
        "The net force on a link changes its linear momentum: F = d/dt (M v_C) - M g.",
        balance.net_force,
        ("F",),
    ),
    Law(
        "B302",
        "Euler's law",
        "The net moment on a link changes its angular momentum about its centre of mass: N = d/dt (I w).",
        balance.net_moment,
        ("N",),
    ),
    Law(
        "B303",
        "action and reaction, f",
        "The forces on a link add up; its children react with -f_c: f_i - sum f_c - f_tool = d/dt (M v_C) - M g.",
        balance.force_balance,
        ("f",),
    ),
    Law(
        "B304",
        "action and reaction, n",
        "The moments about the base's origin, likewise: n_i - sum n_c - n_tool = d/dt (p_C x M v_C + I w) - p_C x M g.",
        balance.moment_balance,
        ("f", "n"),
    ),
    Law(
        "M401",
        "symmetric",
        "The forces of unit accelerations make a symmetric mass matrix: M_ij = M_ji.",
        matrix.symmetric,
    ),
    Law(
        "M402",
        "kinetic energy",
        "The mass matrix is the second derivative of the kinetic energy: M_ij = d^2 T / dv_i dv_j.",
        matrix.of_kinetic_energy,
    ),
    Law(
        "M403",
        "positive definite",
        "No motion has a negative kinetic energy: the smallest eigenvalue of M is not below zero.",
        matrix.positive_definite,
    ),
    Law(
        "M404",
        "skew",
        "M' - 2 C is skew, for the C without torsion with C v = tau(q, v, 0) without gravity.",
        matrix.skew,
    ),
    Law(
        "M405",
        "forward of inverse",
        "Forward dynamics undo inverse dynamics: M^-1 (tau - tau(q, v, 0)) = a, with M of the kinetic energy.",
        matrix.forward,
    ),
    Law(
        "L501",
        "linear in acceleration",
        "Forces superpose in the accelerations: at x + y those at x and at y less those at 0.",
        symmetry.in_acceleration,
    ),
    Law(
        "L502",
        "linear in gravity",
        "Forces superpose in the field: in g + h those in g and in h less those in none.",
        symmetry.in_gravity,
    ),
    Law(
        "L503",
        "linear in inertia",
        "Forces superpose in mass, first moment and tensor: a link made of two bodies has those of both less those "
        "of none.",
        symmetry.in_inertia,
    ),
    Law(
        "I601",
        "base frame",
        "A base frame that is moved and rotated, and the field with it, changes no force.",
        symmetry.under_base,
    ),
    Law(
        "I602",
        "link frames",
        "Other link frames change the components of forces, and no driving force.",
        symmetry.under_frames,
    ),
    Law(
        "S701",
        "scale of mass",
        "s times the masses take s times the forces.",
        symmetry.under_mass,
    ),
    Law(
        "S702",
        "scale of time",
        "A motion s times as fast, in s^2 times the field, takes s^2 times the forces.",
        symmetry.under_time,
    ),
)
"""In the order of their ids."""


def chosen(select: Iterable[str] = ()) -> tuple[Law, ...]:
    """The laws whose ids begin with one of the prefixes; all laws without a prefix.

    Raises:
        UnknownNameError: a prefix fits no law.
    """
    prefixes = tuple(select)
    for prefix in prefixes:
        if not prefix or not any(law.id.startswith(prefix) for law in LAWS):
            raise UnknownNameError("law", prefix, [law.id for law in LAWS])
    return tuple(law for law in LAWS if not prefixes or law.id.startswith(prefixes))
