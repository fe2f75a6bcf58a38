"""The laws of mechanics that inverse dynamics must keep, as a table: id, statement, function.

No other implementation is asked. Each function returns what its law says is zero. Run on (value, bound) scalars, what
comes out lies within its bound of zero if the law holds, whatever rounding did; so there is no tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from rttrr_pin.core.algebra import Scalar
from rttrr_pin.errors import UnknownNameError
from rttrr_pin.laws import balance as law_balance
from rttrr_pin.laws import matrix as law_matrix
from rttrr_pin.laws import symmetry as law_symmetry
from rttrr_pin.laws.case import Case


@dataclass(frozen=True, slots=True)
class Law:
    """A row of the table of laws.

    Attributes:
        id: stable; its letter is the kind of law: K kinematics, E energy and momentum, B balance of each link, M mass
            matrix, L linearity, I invariance, S scaling.
        name: in two or three words.
        statement: what holds.
        residual: numbers that are then zero.
    """

    id: str
    name: str
    statement: str
    residual: Callable[[Case], Iterable[Scalar]]


LAWS = (
    Law(
        "K101",
        "motion of joints",
        "Placement and velocity of a joint change as it says: R' = R [w]x, p' = R v, w' = w_dot, v' = v_dot.",
        law_balance.kinematics,
    ),
    Law(
        "E201",
        "power",
        "Joints give what T + V gains, the payload gets and the drives take: "
        "tau . v = d/dt (T + V) + f_tool . v + n_tool . w + tau_joint . v.",
        law_balance.power,
    ),
    Law(
        "E202",
        "base force",
        "The base changes the linear momentum, bears the weight and the payload: f_0 = d/dt P - M g + f_tool.",
        law_balance.base_force,
    ),
    Law(
        "E203",
        "base moment",
        "The same for moments about its origin: n_0 = d/dt L - p_C x M g + n_tool + p x f_tool.",
        law_balance.base_moment,
    ),
    Law(
        "B301",
        "net force",
        "F of a link changes its linear momentum: F = d/dt (M v_C) - M g.",
        law_balance.net_force,
    ),
    Law(
        "B302",
        "net moment",
        "N of a link changes its spin: N = d/dt (I w), about its centre of mass.",
        law_balance.net_moment,
    ),
    Law(
        "B303",
        "forces on both sides",
        "What f does to a link, its opposite does to the parent: f_i - sum f_c - f_tool = d/dt (M v_C) - M g.",
        law_balance.force_balance,
    ),
    Law(
        "B304",
        "moments on both sides",
        "The same for n about the base's origin: n_i - sum n_c - n_tool = d/dt (p_C x M v_C + I w) - p_C x M g.",
        law_balance.moment_balance,
    ),
    Law(
        "M401",
        "symmetric",
        "The forces of unit accelerations make a symmetric mass matrix: M_ij = M_ji.",
        law_matrix.symmetric,
    ),
    Law(
        "M402",
        "kinetic energy",
        "They are the second derivatives of the kinetic energy: M_ij = d^2 T / dv_i dv_j.",
        law_matrix.of_kinetic_energy,
    ),
    Law(
        "M403",
        "positive definite",
        "No motion has a negative kinetic energy: the smallest eigenvalue of M is not below zero.",
        law_matrix.positive_definite,
    ),
    Law(
        "M404",
        "skew",
        "M' - 2 C is skew, for the C without torsion with C v = tau(q, v, 0) without gravity.",
        law_matrix.skew,
    ),
    Law(
        "M405",
        "forward of inverse",
        "Forward dynamics undo inverse dynamics: M^-1 (tau - tau(q, v, 0)) = a, with M of the kinetic energy.",
        law_matrix.forward,
    ),
    Law(
        "L501",
        "linear in acceleration",
        "Forces superpose in the accelerations: at x + y those at x and at y less those at 0.",
        law_symmetry.in_acceleration,
    ),
    Law(
        "L502",
        "linear in gravity",
        "Forces superpose in the field: in g + h those in g and in h less those in none.",
        law_symmetry.in_gravity,
    ),
    Law(
        "L503",
        "linear in inertia",
        "Forces superpose in mass, first moment and tensor: a link made of two bodies has those of both less those "
        "of none.",
        law_symmetry.in_inertia,
    ),
    Law(
        "I601",
        "base frame",
        "A base frame that is moved and turned, and the field with it, changes no force.",
        law_symmetry.under_base,
    ),
    Law(
        "I602",
        "link frames",
        "Other link frames change the components of forces, and no driving force.",
        law_symmetry.under_frames,
    ),
    Law(
        "S701",
        "scale of mass",
        "s times the masses take s times the forces.",
        law_symmetry.under_mass,
    ),
    Law(
        "S702",
        "scale of time",
        "A motion s times as fast, in s^2 times the field, takes s^2 times the forces.",
        law_symmetry.under_time,
    ),
)
"""In the order of their ids."""


def chosen(select: Iterable[str] = ()) -> tuple[Law, ...]:
    """The laws whose ids begin with one of the prefixes; all, where there is none.

    Raises:
        UnknownNameError: a prefix fits no law.
    """
    wanted = tuple(select)
    for prefix in wanted:
        if not prefix or not any(law.id.startswith(prefix) for law in LAWS):
            raise UnknownNameError("law", prefix, [law.id for law in LAWS])
    return tuple(law for law in LAWS if not wanted or law.id.startswith(wanted))
