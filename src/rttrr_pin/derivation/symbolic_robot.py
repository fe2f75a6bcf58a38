"""A robot in symbols: which symbol stands for which of its numbers, and the inputs of the recursion made of them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import NamedTuple

from rttrr_pin.core.algebra import Matrix, Scalar, Vector
from rttrr_pin.core.arrays import Rebuilt
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.scalars import ROTATION_ERROR
from rttrr_pin.derivation.motion import angles, index, motion_symbols
from rttrr_pin.derivation.ring import Polynomial, Ring, exact
from rttrr_pin.derivation.symbols import DIMENSIONS, Dimension, Expression, Role, Symbol

Slot = tuple[str | int, ...]
"""One number of a robot: ("mass", i), ("com", i, x), ("inertia", i, x, y), ("origin", i, x), ("gravity", x), and of the
payload ("force", x), ("moment", x); links and joints i from 0, axes x, y of 0, 1, 2."""

AXES = "xyz"


@dataclass(frozen=True, slots=True)
class SlotType:
    """Numbers of a robot of one type.

    Attributes:
        dimension: what they measure.
        value: the number that a model has, by what follows the type in a slot; 0 for the payload, which it has none of.
        role: what their symbols stand for.
    """

    dimension: Dimension
    value: Callable[..., float]
    role: Role = Role.PARAMETER


SLOTS: Mapping[str | int, SlotType] = {
    "mass": SlotType(DIMENSIONS["mass"], lambda model, i: model.links[i].mass),
    "com": SlotType(DIMENSIONS["length"], lambda model, i, x: float(model.links[i].com[x])),
    "inertia": SlotType(DIMENSIONS["inertia"], lambda model, i, x, y: float(model.links[i].inertia[x, y])),
    "origin": SlotType(DIMENSIONS["length"], lambda model, i, x: float(model.joints[i].p[x])),
    "gravity": SlotType(DIMENSIONS["acceleration"], lambda model, x: float(model.gravity[x]), Role.GRAVITY),
    "force": SlotType(DIMENSIONS["force"], lambda model, x: 0.0, Role.PAYLOAD),
    "moment": SlotType(DIMENSIONS["moment"], lambda model, x: 0.0, Role.PAYLOAD),
}
"""By what a slot begins with."""

RIGHT_ANGLE_ERROR = 1e-4
"""How far an entry of a rotation is from 0, 1 or -1 at most where a right angle was meant, and few digits written."""


@dataclass(frozen=True)
class ParameterSymbols:
    """What stands for the numbers of a robot.

    Attributes:
        symbols: by which numbers are called.
        slots: for some numbers, the polynomial in these symbols; a number without one stays a number.
        values: of each symbol, as the robot has it.
    """

    symbols: tuple[Symbol, ...] = ()
    slots: Mapping[Slot, Expression] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class SymbolicRobot(Rebuilt):
    """A robot whose numbers are polynomials in symbols.

    Attributes:
        model: the structure, and the numbers that the symbols stand for.
        parameters: which symbol stands for which number.
        payload_link: index of the link that the payload acts at; None: there is no payload.
        right_angles: whether an entry of a rotation within 1e-4 of 0, 1 or -1 is read as that number: files write
            1.5708 where they mean a right angle.
        steps: symbols for what is named on the way; none where all is written out.
    """

    model: Model
    parameters: ParameterSymbols
    payload_link: int | None = None
    right_angles: bool = False
    steps: tuple[Symbol, ...] = ()

    @cached_property
    def ring(self) -> Ring:
        """The polynomials in all symbols: coordinates, rates, accelerations, sines, cosines, parameters, steps."""
        return Ring([*self.motion, *self.parameters.symbols, *self.steps])

    @cached_property
    def motion(self) -> tuple[Symbol, ...]:
        """Coordinates, rates, accelerations, their sines, cosines and signs."""
        return tuple(motion_symbols(self.model))

    @property
    def q(self) -> list[Polynomial]:
        """A symbol for each coordinate."""
        return [self.ring[f"q_{k}"] for k in range(1, self.model.nq + 1)]

    @property
    def v(self) -> list[Polynomial]:
        """A symbol for each rate."""
        return [self.ring[f"v_{k}"] for k in range(1, self.model.nv + 1)]

    @property
    def a(self) -> list[Polynomial]:
        """A symbol for each acceleration."""
        return [self.ring[f"a_{k}"] for k in range(1, self.model.nv + 1)]

    @property
    def gravity(self) -> Vector:
        """The gravity field in the base frame."""
        return self._vector("gravity", (), self.model.gravity)

    @property
    def payloads(self) -> list[Payload]:
        """What the robot exerts on its surroundings."""
        if self.payload_link is None:
            return []
        force, moment = (self._vector(quantity, (), (0.0, 0.0, 0.0)) for quantity in ("force", "moment"))
        return [Payload(self.payload_link, force, moment)]

    def bodies(self) -> list[Body]:
        """The links with their joints, as the recursion takes them."""
        return [self._body(i, *pair) for i, pair in enumerate(zip(self.model.joints, self.model.links, strict=True))]

    def sincos(self, angle: Scalar) -> tuple[Polynomial, Polynomial]:
        """The symbols for sine and cosine of a joint's angle."""
        suffix = self._angles[str(self.ring.lift(angle))]
        return self.ring[f"s_{suffix}"], self.ring[f"c_{suffix}"]

    def sign(self, rate: Scalar) -> Scalar:
        """The symbol for the sign of a rate, or of a multiple of one; 0 for no rate."""
        for ((name, _),), multiple in self.ring.terms(rate).items():
            sign = self.ring["sign_" + name.removeprefix("v_")]
            return sign if multiple > 0 else -sign
        return 0

    def _body(self, i: int, joint: Joint, link: Link) -> Body:
        return Body(
            type=joint.type,
            axis=Vector.of(joint.axis, exact),
            R=Matrix.of(joint.R, self._direction),
            p=self._vector("origin", (i,), joint.p),
            M=self._number(("mass", i), link.mass),
            r_C=self._vector("com", (i,), link.com),
            I=Matrix(
                tuple(self._vector("inertia", (i, x), row) for x, row in enumerate(link.inertia))  # type: ignore[arg-type]
            ),
            parameters=tuple(exact(x) for x in joint.type.parameters),
        )

    def _vector(self, quantity: str, indices: tuple[int, ...], values: Iterable[float]) -> Vector:
        return Vector(*(self._number((quantity, *indices, x), float(value)) for x, value in enumerate(values)))

    def _number(self, slot: Slot, value: float) -> Scalar:
        if slot in self.parameters.slots:
            return self.ring.polynomial(self.parameters.slots[slot])
        return exact(value) if value else 0

    def _direction(self, value: float) -> Scalar:
        """An entry of a rotation: 0, 1 or -1 where it is so within the rounding of the sines that made it."""
        near = RIGHT_ANGLE_ERROR if self.right_angles else ROTATION_ERROR
        return round(value) if abs(value - round(value)) <= near else exact(value)

    @cached_property
    def _angles(self) -> dict[str, str]:
        """The suffix of the sine and cosine of each angle, by the angle's polynomial."""
        return {
            str(self.ring[f"q_{angle.index}"] * exact(angle.multiplier) + exact(angle.offset)): angle.suffix
            for angle in angles(self.model)
        }


def almost_right_angles(model: Model) -> int:
    """How many entries of the robot's rotations are near 0, 1 or -1 and are not so by rounding alone."""
    errors = [abs(float(value) - round(value)) for joint in model.joints for value in joint.R.ravel()]
    return sum(ROTATION_ERROR < error <= RIGHT_ANGLE_ERROR for error in errors)


def value_of_slot(model: Model, slot: Slot) -> float:
    """The number that a robot has in a slot."""
    return SLOTS[slot[0]].value(model, *slot[1:])


def default_symbols(model: Model, payload_link: int | None = None) -> ParameterSymbols:
    """Symbols for a robot's numbers that are not zero, after the paper's: M, r_C, J*, and p for the joints' origins.

    The payload is named after its link. J_xy, J_xz, J_yz are minus the matrix elements, as the paper has them.
    """
    named = [*_link_symbols(model), *_gravity_symbols()]
    used = [one for one in named if value_of_slot(model, one.slots[0])]
    return _parameters(model, [*used, *_payload_symbols(payload_link)])


def payload_symbols(model: Model, payload_link: int | None) -> ParameterSymbols:
    """Symbols for the payload alone: the robot's own numbers stay numbers."""
    return _parameters(model, _payload_symbols(payload_link))


class _Named(NamedTuple):
    """A symbol and the numbers that it stands for; the sign is -1 where it stands for minus the number."""

    name: str
    latex: str
    slots: tuple[Slot, ...]
    sign: int = 1


def _parameters(model: Model, named: Iterable[_Named]) -> ParameterSymbols:
    symbols: list[Symbol] = []
    slots: dict[Slot, Expression] = {}
    values: dict[str, float] = {}
    for name, latex, own_slots, sign in named:
        slot_type = SLOTS[own_slots[0][0]]
        symbols.append(Symbol(name, latex, slot_type.role, slot_type.dimension))
        values[name] = sign * value_of_slot(model, own_slots[0])
        slots |= {slot: {((name, 1),): Fraction(sign)} for slot in own_slots}
    return ParameterSymbols(tuple(symbols), slots, values)


def _link_symbols(model: Model) -> Iterator[_Named]:
    for i in range(len(model.links)):
        link, up = i + 1, f"{{}}^{index(i + 1)}"
        for x, axis in enumerate(AXES):
            yield _Named(f"p_{link}{axis}", f"p_{{{link}{axis}}}", (("origin", i, x),))
        yield _Named(f"M_{link}", f"M_{index(link)}", (("mass", i),))
        for x, axis in enumerate(AXES):
            yield _Named(f"r_C{link}{axis}", f"{up}r_{{C_{{{link}{axis}}}}}", (("com", i, x),))
        for x, axis in enumerate(AXES):
            yield _Named(f"J_{link}{axis}", f"{up}J_{axis}^*", (("inertia", i, x, x),))
        for x, y in ((0, 1), (0, 2), (1, 2)):
            pair = AXES[x] + AXES[y]
            yield _Named(f"J_{link}{pair}", f"{up}J_{{{pair}}}^*", (("inertia", i, x, y), ("inertia", i, y, x)), -1)


def _gravity_symbols() -> Iterator[_Named]:
    for x, name in enumerate(("g_x", "g_y", "g")):
        yield _Named(name, name, (("gravity", x),), -1)


def _payload_symbols(link: int | None) -> Iterator[_Named]:
    if link is None:
        return
    up = f"{{}}^{index(link + 1)}"
    for quantity, name in (("force", "f"), ("moment", "n")):
        for x, axis in enumerate(AXES):
            yield _Named(f"{name}_tool_{axis}", rf"{up}{name}_{{\mathrm{{tool}},{axis}}}", ((quantity, x),))
