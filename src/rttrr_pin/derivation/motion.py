"""The symbols of all that changes with time: coordinates, rates, accelerations, sines, cosines, signs of rates."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from rttrr_pin.core.model import Model
from rttrr_pin.derivation.symbols import LENGTH, NUMBER, Dimension, Role, Symbol

DIMENSIONS = {"rad": None, "m": LENGTH, "": NUMBER}
"""The dimension of a coordinate by its unit; None for an angle."""


@dataclass(frozen=True, slots=True)
class Angle:
    """What a sine and a cosine are of: multiplier q + offset.

    Attributes:
        suffix: the symbols are called s_SUFFIX and c_SUFFIX.
        index: of the coordinate in q, from 1.
        multiplier: 1 but for a joint that follows another.
        offset: [rad], 0 but for a joint that follows another.
    """

    suffix: str
    index: int
    multiplier: float = 1.0
    offset: float = 0.0


def angles(model: Model) -> list[Angle]:
    """The angles of a robot: those among its coordinates, then those of joints that follow others."""
    own = [Angle(str(k), k) for k, dimension in enumerate(_coordinates(model), start=1) if dimension is None]
    return own + [
        Angle(
            f"j{i + 1}",
            1 + sum(model.joints[k].nq for k in model.independent if k < mimic.joint),
            mimic.multiplier,
            mimic.offset,
        )
        for i, joint in enumerate(model.joints)
        if (mimic := joint.mimic) is not None and joint.type.rotates
    ]


def _coordinates(model: Model) -> Iterator[Dimension | None]:
    """The dimension of each coordinate; None for an angle."""
    for joint in model.moving:
        yield from (DIMENSIONS[own.unit] for own in joint.type.coordinates)


def motion_symbols(model: Model) -> Iterator[Symbol]:
    """The symbols of all that changes with time."""
    for k, dimension in enumerate(_coordinates(model), start=1):
        yield Symbol(f"q_{k}", f"q_{index(k)}", Role.COORDINATE, dimension or NUMBER, k)
        if dimension is None:
            yield Symbol(f"s_{k}", f"sq_{index(k)}", Role.SINE, index=k)
            yield Symbol(f"c_{k}", f"cq_{index(k)}", Role.COSINE, index=k)
    for i, joint in enumerate(model.joints):
        if joint.mimic is not None and joint.type.rotates:
            yield Symbol(f"s_j{i + 1}", rf"s\varphi_{index(i + 1)}", Role.SINE, index=i + 1)
            yield Symbol(f"c_j{i + 1}", rf"c\varphi_{index(i + 1)}", Role.COSINE, index=i + 1)
    plain = model.nq == model.nv
    for k, rotation in enumerate(model.rotations, start=1):
        rate, twice = (rf"\dot{{q}}_{index(k)}", rf"\ddot{{q}}_{index(k)}")
        if not plain:
            rate, twice = f"v_{index(k)}", rf"\dot{{v}}_{index(k)}"
        length = 0 if rotation else 1
        yield Symbol(f"v_{k}", rate, Role.RATE, Dimension(length=length, time=-1), k)
        yield Symbol(f"a_{k}", twice, Role.ACCELERATION, Dimension(length=length, time=-2), k)
        yield Symbol(f"sign_{k}", rf"\mathrm{{sgn}}({rate})", Role.SIGN, index=k)


def index(k: int) -> str:
    """A number as a LaTeX subscript."""
    return str(k) if k < 10 else f"{{{k}}}"
