"""A robot in symbols: which letter stands for which of its numbers, and the specification's inputs made of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property

from rttrr_pin.algebra import Matrix, Scalar, Vector
from rttrr_pin.arithmetic import ROTATION_ERROR
from rttrr_pin.joint_motion import Body
from rttrr_pin.model import Joint, Link, Model
from rttrr_pin.newton_euler import Payload
from rttrr_pin.symbolic.ring import Polynomial, Ring, exact
from rttrr_pin.symbolic.symbols import (
    ACCELERATION,
    FORCE,
    INERTIA,
    LENGTH,
    MASS,
    MOMENT,
    NUMBER,
    Dimension,
    Role,
    Symbol,
    Terms,
)

Slot = tuple[str | int, ...]
"""One number of a robot: ("mass", i), ("com", i, x), ("inertia", i, x, y), ("origin", i, x), ("gravity", x), and of the
payload ("force", x), ("moment", x); links and joints i from 0, axes x, y of 0, 1, 2."""

Named = tuple[Symbol, int, tuple[Slot, ...]]
"""A letter, its sign (-1 where it stands for minus the number), and the numbers that it stands for."""

SLOT_DIMENSION: Mapping[str, Dimension] = {
    "mass": MASS,
    "com": LENGTH,
    "inertia": INERTIA,
    "origin": LENGTH,
    "gravity": ACCELERATION,
    "force": FORCE,
    "moment": MOMENT,
}
"""The dimension of each kind of slot."""

AXES = "xyz"


@dataclass(frozen=True)
class Letters:
    """What stands for the numbers of a robot.

    Attributes:
        symbols: the letters.
        slots: for some numbers, the polynomial in these letters; a number without one stays a number.
        values: of each letter, as the robot has it.
    """

    symbols: tuple[Symbol, ...] = ()
    slots: Mapping[Slot, Terms] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class SymbolicRobot:
    """A robot whose numbers are polynomials in symbols.

    Attributes:
        model: the structure, and the numbers that the letters stand for.
        letters: which letter stands for which number.
        payload_link: index of the link that the payload acts at; None: there is no payload.
    """

    model: Model
    letters: Letters
    payload_link: int | None = None

    @cached_property
    def ring(self) -> Ring:
        """The polynomials in all symbols: coordinates, rates, accelerations, sines, cosines, letters."""
        return Ring([*self.motion, *self.letters.symbols])

    @cached_property
    def motion(self) -> tuple[Symbol, ...]:
        """Coordinates, rates, accelerations, their sines, cosines and signs."""
        return tuple(_motion_symbols(self.model))

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
        force, moment = (self._vector(kind, (), (0.0, 0.0, 0.0)) for kind in ("force", "moment"))
        return [Payload(self.payload_link, force, moment)]

    def bodies(self) -> list[Body]:
        """The links with their joints, as the specification takes them."""
        return [self._body(i, *pair) for i, pair in enumerate(zip(self.model.joints, self.model.links, strict=True))]

    def sincos(self, angle: Scalar) -> tuple[Polynomial, Polynomial]:
        """The symbols for sine and cosine of a joint's angle."""
        suffix = self._angles[str(self.ring.lift(angle))]
        return self.ring[f"s_{suffix}"], self.ring[f"c_{suffix}"]

    def sign(self, rate: Scalar) -> Polynomial:
        """The symbol for the sign of a rate."""
        return self.ring["sign_" + str(rate).removeprefix("v_")]

    def _body(self, i: int, joint: Joint, link: Link) -> Body:
        return Body(
            type=joint.type,
            axis=Vector.of(joint.axis, exact),
            R=Matrix.of(joint.R, _direction),
            p=self._vector("origin", (i,), joint.p),
            M=self._number(("mass", i), link.mass),
            r_C=self._vector("com", (i,), link.com),
            I=Matrix(
                tuple(self._vector("inertia", (i, x), row) for x, row in enumerate(link.inertia))  # type: ignore[arg-type]
            ),
        )

    def _vector(self, kind: str, place: tuple[int, ...], values: Iterable[float]) -> Vector:
        return Vector(*(self._number((kind, *place, x), float(value)) for x, value in enumerate(values)))

    def _number(self, slot: Slot, value: float) -> Scalar:
        if slot in self.letters.slots:
            return self.ring.polynomial(self.letters.slots[slot])
        return exact(value) if value else 0

    @cached_property
    def _angles(self) -> dict[str, str]:
        """The suffix of the sine and cosine of each angle, by the angle's polynomial."""
        suffixes = {str(self.ring[f"q_{k}"]): str(k) for k in angle_places(self.model)}
        for i, joint in enumerate(self.model.joints):
            if joint.mimic is not None and joint.type.rotates:
                followed = self.ring[f"q_{_first_coordinate(self.model, joint.mimic.joint)}"]
                angle = followed * exact(joint.mimic.multiplier) + exact(joint.mimic.offset)
                suffixes[str(self.ring.lift(angle))] = f"j{i + 1}"
        return suffixes


def _direction(value: float) -> Scalar:
    """An entry of a rotation: 0, 1 or -1 where it is so within the rounding of the sines that made it."""
    return round(value) if abs(value - round(value)) <= ROTATION_ERROR else exact(value)


def angle_places(model: Model) -> Iterator[int]:
    """The places in q, from 1, of the coordinates that are angles."""
    for place, angle in enumerate(_coordinates(model), start=1):
        if angle is None:
            yield place


def _coordinates(model: Model) -> Iterator[Dimension | None]:
    """The dimension of each coordinate; None for an angle."""
    for joint in model.moving:
        for slot in joint.type.q_slots:
            if slot == "theta" or (not slot and joint.type.rotates):
                yield None
            else:
                yield NUMBER if slot.startswith("q") else LENGTH


def _first_coordinate(model: Model, joint: int) -> int:
    """The place in q, from 1, of the first coordinate of a joint."""
    return 1 + sum(model.joints[i].nq for i in model.independent if i < joint)


def _motion_symbols(model: Model) -> Iterator[Symbol]:
    """The symbols of all that changes with time."""
    for k, dimension in enumerate(_coordinates(model), start=1):
        yield Symbol(f"q_{k}", f"q_{_index(k)}", Role.COORDINATE, dimension or NUMBER, k)
        if dimension is None:
            yield Symbol(f"s_{k}", f"sq_{_index(k)}", Role.SINE, index=k)
            yield Symbol(f"c_{k}", f"cq_{_index(k)}", Role.COSINE, index=k)
    for i, joint in enumerate(model.joints):
        if joint.mimic is not None and joint.type.rotates:
            yield Symbol(f"s_j{i + 1}", rf"s\varphi_{_index(i + 1)}", Role.SINE, index=i + 1)
            yield Symbol(f"c_j{i + 1}", rf"c\varphi_{_index(i + 1)}", Role.COSINE, index=i + 1)
    letter = "q" if model.nq == model.nv else None
    rotations = [rotation for joint in model.moving for rotation in joint.type.rotations]
    for k, rotation in enumerate(rotations, start=1):
        rate, twice = (rf"\dot{{q}}_{_index(k)}", rf"\ddot{{q}}_{_index(k)}")
        if letter is None:
            rate, twice = f"v_{_index(k)}", rf"\dot{{v}}_{_index(k)}"
        length = 0 if rotation else 1
        yield Symbol(f"v_{k}", rate, Role.RATE, Dimension(length=length, time=-1), k)
        yield Symbol(f"a_{k}", twice, Role.ACCELERATION, Dimension(length=length, time=-2), k)
        yield Symbol(f"sign_{k}", rf"\operatorname{{sgn}}({rate})", Role.SIGN, index=k)


def _index(k: int) -> str:
    """A number as a LaTeX subscript."""
    return str(k) if k < 10 else f"{{{k}}}"


def parameter(slot: Slot, name: str, latex: str) -> Symbol:
    """The symbol for a number of the robot."""
    kind = str(slot[0])
    role = {"gravity": Role.GRAVITY, "force": Role.PAYLOAD, "moment": Role.PAYLOAD}.get(kind, Role.PARAMETER)
    return Symbol(name, latex, role, SLOT_DIMENSION[kind])


def value_of_slot(model: Model, slot: Slot) -> float:
    """The number that a robot has in a slot; 0 for the payload, which it has none of."""
    kind, *place = slot
    i = [int(x) for x in place]
    if kind == "mass":
        return model.links[i[0]].mass
    if kind == "com":
        return float(model.links[i[0]].com[i[1]])
    if kind == "inertia":
        return float(model.links[i[0]].inertia[i[1], i[2]])
    if kind == "origin":
        return float(model.joints[i[0]].p[i[1]])
    return float(model.gravity[i[0]]) if kind == "gravity" else 0.0


def letters_of(model: Model, named: Iterable[Named]) -> Letters:
    """The letters that stand each for one number of a robot, in one place or in several.

    Args:
        model: the robot.
        named: each letter with its sign and the slots of its number.
    """
    symbols: list[Symbol] = []
    slots: dict[Slot, Terms] = {}
    values: dict[str, float] = {}
    for symbol, sign, places in named:
        symbols.append(symbol)
        values[symbol.name] = sign * value_of_slot(model, places[0])
        for slot in places:
            slots[slot] = {((symbol.name, 1),): Fraction(sign)}
    return Letters(tuple(symbols), slots, values)


def default_letters(model: Model, payload_link: int | None = None) -> Letters:
    """Letters for every number of a robot that is not zero, after the paper's: M, r_C, J*; p for the joints' origins.

    J_xy, J_xz, J_yz are minus the matrix elements, as the paper has them.

    Args:
        model: the robot.
        payload_link: index of the link that a payload acts at; None: there is none.
    """
    named = [letter for i in range(len(model.links)) for letter in _link_letters(i)]
    for x, axis in enumerate(AXES):
        name = "g" if axis == "z" else f"g_{axis}"
        named.append((parameter(("gravity", x), name, name), -1, (("gravity", x),)))
    named = [letter for letter in named if value_of_slot(model, letter[2][0])]
    if payload_link is not None:
        named += _payload_letters(payload_link)
    return letters_of(model, named)


def _link_letters(i: int) -> Iterator[Named]:
    """The letters of a link: origin of its joint, mass, centre of mass, tensor."""
    link, up = i + 1, f"{{}}^{_index(i + 1)}"
    for x, axis in enumerate(AXES):
        yield _named(("origin", i, x), f"p_{link}{axis}", f"p_{{{link}{axis}}}")
    yield _named(("mass", i), f"M_{link}", f"M_{_index(link)}")
    for x, axis in enumerate(AXES):
        yield _named(("com", i, x), f"r_C{link}{axis}", f"{up}r_{{C_{{{link}{axis}}}}}")
    for x, axis in enumerate(AXES):
        yield _named(("inertia", i, x, x), f"J_{link}{axis}", f"{up}J_{axis}^*")
    for x, y in ((0, 1), (0, 2), (1, 2)):
        pair = AXES[x] + AXES[y]
        slots = (("inertia", i, x, y), ("inertia", i, y, x))
        yield parameter(slots[0], f"J_{link}{pair}", f"{up}J_{{{pair}}}^*"), -1, slots


def _payload_letters(link: int) -> Iterator[Named]:
    up = f"{{}}^{_index(link + 1)}"
    for kind, letter in (("force", "f"), ("moment", "n")):
        for x, axis in enumerate(AXES):
            yield _named((kind, x), f"{letter}_tool_{axis}", rf"{up}{letter}_{{\mathrm{{tool}},{axis}}}")


def _named(slot: Slot, name: str, latex: str) -> Named:
    return parameter(slot, name, latex), 1, (slot,)
