"""What each symbol of a closed form means, in words, with its unit and its value."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from rttrr_pin.core.model import Model
from rttrr_pin.derivation import Derivation, Symbol
from rttrr_pin.derivation.motion import Angle, angles
from rttrr_pin.derivation.symbolic_robot import AXES, Slot
from rttrr_pin.derivation.symbols import Role
from rttrr_pin.derivation.writers.wording import plain

MEANINGS = {
    "mass": "mass of {link}",
    "com": "{axes} of the centre of mass of {link}",
    "inertia": "i{axes} of the inertia tensor of {link} about its centre of mass",
    "origin": "{axes} of the origin of {joint} on {parent}",
    "gravity": "gravity against the base's {axes} axis",
    "force": "payload: {axes} of the force that {link} exerts on its surroundings",
    "moment": "payload: {axes} of the moment that {link} exerts on its surroundings",
}
"""What the numbers of a robot are."""

MOVING = (Role.COORDINATE, Role.RATE, Role.ACCELERATION, Role.SIGN)
"""What the table begins with."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A row of the table of symbols.

    Attributes:
        symbol: the symbol.
        meaning: what it stands for.
        unit: in which it is.
        value: as the robot has it; None where it is given with the motion.
    """

    symbol: Symbol
    meaning: str
    unit: str
    value: float | None = None


def glossary(derivation: Derivation) -> list[Entry]:
    """The symbols that occur, but for sines, cosines and steps."""
    model = derivation.robot.model
    used = {name for terms in derivation.all_terms() for factors in terms for name, _ in factors}
    for angle in angles(model):  # in the table an angle stands as its coordinate, or, of a follower, by its sine
        if {f"s_{angle.suffix}", f"c_{angle.suffix}"} & used:
            used |= {f"q_{angle.index}", f"s_{angle.suffix}"}
    moving = [symbol for role in MOVING for symbol in derivation.robot.motion if symbol.role is role]
    entries = [_of_motion(model, symbol) for symbol in moving]
    entries += [_of_angle(model, angle) for angle in angles(model) if angle.suffix.startswith("j")]
    return [entry for entry in [*entries, *parameters(derivation, payload=True)] if entry.symbol.name in used]


def parameters(derivation: Derivation, payload: bool = False) -> Iterator[Entry]:
    """The symbols that stand for the robot's numbers; on request those of the payload too."""
    named = derivation.robot.parameters
    for symbol in named.symbols:
        of_payload = symbol.role is Role.PAYLOAD
        if of_payload and not payload:
            continue
        meanings: dict[str, None] = {}
        for slot, terms in named.slots.items():
            sign = terms.get(((symbol.name, 1),), Fraction(0))
            if sign:
                minus = "minus " if sign < 0 and slot[0] != "gravity" else ""
                meanings[minus + _meaning(derivation, slot)] = None
        yield Entry(
            symbol, ", ".join(meanings), symbol.dimension.unit, None if of_payload else named.values[symbol.name]
        )


def payload_places(derivation: Derivation) -> dict[str, tuple[int, int]]:
    """The place in (f_x, f_y, f_z, n_x, n_y, n_z), from 0, of each symbol of the payload, and its sign."""
    columns = {}
    for slot, terms in derivation.robot.parameters.slots.items():
        if slot[0] in ("force", "moment"):
            ((((name, _),), sign),) = terms.items()
            columns[name] = (int(slot[1]) + (3 if slot[0] == "moment" else 0), 1 if sign > 0 else -1)
    return columns


def _of_angle(model: Model, angle: Angle) -> Entry:
    """The angle of a joint that follows another."""
    joint = angle.suffix[1:]
    symbol = Symbol(f"s_{angle.suffix}", rf"\varphi_{{{joint}}}", Role.SINE)
    line = f"{angle.multiplier!r} times coordinate {angle.index} plus {angle.offset!r}"
    return Entry(symbol, f"angle of {plain(model.joints[int(joint) - 1].name)}: {line}", "rad")


def axis_units(model: Model) -> tuple[list[str], list[str]]:
    """Units of the entries of q, and of those of v; accelerations are per second more."""
    q: list[str] = [coordinate.unit or "1" for joint in model.moving for coordinate in joint.type.coordinates]
    return q, ["rad/s" if rotation else "m/s" for rotation in model.rotations]


def labelled(names: Sequence[str], units: Sequence[str]) -> str:
    """Names with their units, in a row."""
    return ", ".join(f"{name} [{unit}]" for name, unit in zip(names, units, strict=True))


def _of_motion(model: Model, symbol: Symbol) -> Entry:
    names = model.q_names if symbol.role is Role.COORDINATE else model.v_names
    of = plain(names[symbol.index - 1])
    if symbol.role is Role.COORDINATE:
        return Entry(symbol, f"coordinate of {of}", axis_units(model)[0][symbol.index - 1])
    word = {Role.RATE: "rate", Role.ACCELERATION: "acceleration", Role.SIGN: "sign of the rate"}[symbol.role]
    return Entry(symbol, f"{word} of {of}", symbol.dimension.unit)


def _meaning(derivation: Derivation, slot: Slot) -> str:
    model, number, axes = derivation.robot.model, str(slot[0]), [int(x) for x in slot[1:]]
    i = axes.pop(0) if number in ("mass", "com", "inertia", "origin") else derivation.robot.payload_link
    names = {"axes": "".join(AXES[x] for x in sorted(axes))}
    if i is not None:
        parent = model.joints[i].parent
        names["link"], names["joint"] = plain(model.links[i].name), plain(model.joints[i].name)
        names["parent"] = plain((model.links[parent] if parent >= 0 else model.root).name)
    return MEANINGS[number].format(**names)
