"""The equation of motion taken apart: tau = M(q) a + C(q, v) v + g(q) + payload + friction of the joints.

All by differentiating the closed form of tau, which is linear in the accelerations and in the payload, and of second
degree in the rates.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from flint import fmpq

from rttrr_pin.derivation.closed_forms import ClosedForms
from rttrr_pin.derivation.ring import Polynomial, Ring
from rttrr_pin.derivation.symbols import Role

HALF = fmpq(1, 2)


@dataclass(frozen=True)
class ModelTerms:
    """The parts of the equation of motion.

    Attributes:
        M: mass matrix, armature included, (nv, nv).
        C: Coriolis and centrifugal matrix, (nv, nv): C v is what the rates take.
        g: what holds the robot still, (nv,).
        payload: what the payload takes, (nv,).
        friction: damping and Coulomb friction of the joints, (nv,).
    """

    M: list[list[Polynomial]]
    C: list[list[Polynomial]]
    g: list[Polynomial]
    payload: list[Polynomial]
    friction: list[Polynomial]


def model_terms(forms: ClosedForms) -> ModelTerms:
    """Take the driving forces apart.

        M_ij = d tau_i / d a_j
        C_ij = 1/2 sum over k of d^2 tau_i / d v_j d v_k v_k

    The second derivatives are twice the Christoffel symbols c_ijk of the first kind, which are symmetric in j and k. So
    dM/dt - 2 C is skew-symmetric where v is the time derivative of q; of planar and floating joints it is not, and only
    C v has a meaning.

    Args:
        forms: the closed forms of a robot.

    Returns:
        Polynomials, reduced modulo c^2 + s^2 = 1.
    """
    ring = forms.robot.ring
    rates, accelerations = names(ring, Role.RATE), names(ring, Role.ACCELERATION)
    loads = names(ring, Role.PAYLOAD)
    still: dict[str | int, int] = dict.fromkeys([*rates, *accelerations, *loads, *names(ring, Role.SIGN)], 0)
    tau = [ring.lift(x) for x in forms.tau]
    return ModelTerms(
        M=[[ring.derivative(x, name) for name in accelerations] for x in tau],
        C=[[_coriolis(ring, x, name, rates) for name in rates] for x in tau],
        g=[x.subs(still) for x in tau],
        payload=[_linear(ring, x, loads) for x in tau],
        friction=[_friction(ring, x, rates, still) for x in tau],
    )


def names(ring: Ring, role: Role) -> list[str]:
    """The symbols of a role, in their order."""
    return [name for name, symbol in ring.symbols.items() if symbol.role is role]


def _coriolis(ring: Ring, tau: Polynomial, rate: str, rates: Iterable[str]) -> Polynomial:
    by_rate = ring.derivative(tau, rate)
    return sum((ring.derivative(by_rate, other) * ring[other] * HALF for other in rates), start=ring.lift(0))


def _linear(ring: Ring, x: Polynomial, by: Iterable[str]) -> Polynomial:
    """The part that is linear in these symbols."""
    return sum((ring.derivative(x, name) * ring[name] for name in by), start=ring.lift(0))


def _friction(ring: Ring, tau: Polynomial, rates: Sequence[str], still: dict[str | int, int]) -> Polynomial:
    """What is linear in the rates, and in their signs."""
    linear = [ring.derivative(tau, name).subs(still) * ring[name] for name in rates]
    return sum(linear, start=_linear(ring, tau, names(ring, Role.SIGN)))
