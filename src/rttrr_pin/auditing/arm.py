"""The robot that published equations are about: its frames as a table, its numbers as letters."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from xml.sax.saxutils import quoteattr

from rttrr_pin.auditing.tables import Table
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Model
from rttrr_pin.derivation.chain import AXES, SLOT_DIMENSION, Letters, Slot, SymbolicRobot, value_of_slot
from rttrr_pin.derivation.ring import evaluate
from rttrr_pin.derivation.symbols import INERTIA, LENGTH, MASS, NUMBER, Dimension, Role, Symbol, Terms
from rttrr_pin.loading import load

Expression = Callable[[Table, str], Terms]
"""Reads an expression in letters; the table is for messages."""

LINK_KEYS = ("name", "parent", "joint", "origin", "rpy_degrees", "mass", "com", "inertia")

ENTRIES: Sequence[tuple[int, int]] = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
"""Places in the tensor, in the order of a link's `inertia`: xx, xy, xz, yy, yz, zz."""

USUAL: Mapping[Dimension, float] = {LENGTH: 0.3, MASS: 2.0, INERTIA: 0.1}
"""About what size a letter is taken to be where no file and no [values] give its number."""

SAME = 1e-9
"""Relative difference within which a number of the file is what the table of frames says: files are rounded."""


def read_robot(
    file: Table, symbols: Sequence[Symbol], expression: Expression, find: Callable[[str], str]
) -> SymbolicRobot:
    """The robot of a file of equations.

    Args:
        file: the whole file.
        symbols: its letters.
        expression: reads expressions in them.
        find: turns the name of a URDF into what can be loaded.

    Returns:
        The robot in symbols, with a number for each letter.

    Raises:
        EquationError: the tables do not fit each other, or the URDF.
    """
    about = file.table("robot").only(("urdf", "gravity"))
    links = file.tables("link", "[[link]]")
    slots = dict(_slots(links, about, expression))
    given = {name: file.table("values").get(name, float) for name in file.table("values").entries}
    for name, value in given.items():
        if not math.isfinite(value):
            raise file.table("values").error(f"{name} is {value}: expected a finite number")
    unknown = set(given) - {symbol.name for symbol in symbols}
    if unknown:
        raise file.table("values").error(f"{sorted(unknown)[0]!r} is no symbol: declare it in [[symbol]]")
    if "urdf" in about.entries:
        model = _from_urdf(about, links, find)
        places = [model.link_index(link.get("name", str)) for link in links]
        slots = {_placed(slot, places): terms for slot, terms in slots.items()}
        values = _values_in(model, slots, symbols, given, about)
    else:
        values = _usual(symbols, slots) | given
        model = _from_table(about, links, slots, values)
        places = [model.link_index(name) for name in _names(links)]
        slots = {_placed(slot, places): terms for slot, terms in slots.items()}
    force = file.table("payload").only(("link", "force", "moment"))
    payload_link = None
    if force.entries:
        name = force.get("link", str, model.links[-1].name)
        if name not in model.link_names:
            raise force.error(f"link is {name!r}: expected one of {', '.join(model.link_names)}")
        payload_link = model.link_index(name)
        slots |= dict(_payload(force, expression))
    _check_dimensions(slots, symbols, file)
    used = {name for terms in slots.values() for factors in terms for name, _ in factors}
    roles = _roles(slots)
    chosen = tuple(replace(symbol, role=roles.get(symbol.name, symbol.role)) for symbol in symbols)
    idle = [symbol.name for symbol in symbols if symbol.name not in used]
    if idle:
        raise file.error(f"symbol {idle[0]!r} stands for no number: use it in [robot], [[link]] or [payload]")
    return SymbolicRobot(model, Letters(chosen, slots, {s.name: values.get(s.name, 0.0) for s in chosen}), payload_link)


def _check_dimensions(slots: Mapping[Slot, Terms], symbols: Sequence[Symbol], file: Table) -> None:
    """Each letter may stand only for what it measures; a bare number has the unit of its place."""
    dimensions = {symbol.name: symbol.dimension for symbol in symbols}
    for slot, terms in slots.items():
        wanted = SLOT_DIMENSION[str(slot[0])]
        for factors in terms:
            got = NUMBER
            for name, power in factors:
                got = got.times(dimensions[name], power)
            if factors and got != wanted:
                shown = " ".join(f"{name}^{power}" if power > 1 else name for name, power in factors)
                raise file.error(f"{slot[0]} has {shown}, which measures {got}: expected {wanted}")


def _roles(slots: Mapping[Slot, Terms]) -> dict[str, Role]:
    """What letters stand for beyond plain parameters."""
    roles = {"gravity": Role.GRAVITY, "force": Role.PAYLOAD, "moment": Role.PAYLOAD}
    return {
        name: roles[str(slot[0])]
        for slot, terms in slots.items()
        if slot[0] in roles
        for factors in terms
        for name, _ in factors
    }


def _slots(links: Sequence[Table], about: Table, expression: Expression) -> Iterator[tuple[Slot, Terms]]:
    """The expression of each number that the tables state; links by their place in the table."""
    for i, link in enumerate(links):
        link.only(LINK_KEYS)
        if "mass" in link.entries:
            yield ("mass", i), expression(link, link.texts("mass", 1)[0])
        for key, kind in (("origin", "origin"), ("com", "com")):
            if key in link.entries:
                for x, text in enumerate(link.texts(key, 3)):
                    yield (kind, i, x), expression(link, text)
        if "inertia" in link.entries:
            for (x, y), text in zip(ENTRIES, link.texts("inertia", 6), strict=True):
                yield ("inertia", i, x, y), expression(link, text)
                yield ("inertia", i, y, x), expression(link, text)
    if "gravity" in about.entries:
        for x, text in enumerate(about.texts("gravity", 3)):
            yield ("gravity", x), expression(about, text)


def _payload(table: Table, expression: Expression) -> Iterator[tuple[Slot, Terms]]:
    for kind in ("force", "moment"):
        for x, text in enumerate(table.texts(kind, 3, ("0", "0", "0"))):
            yield (kind, x), expression(table, text)


# With a URDF


def _from_urdf(about: Table, links: Sequence[Table], find: Callable[[str], str]) -> Model:
    """The model of the file; the table of frames must agree with it."""
    model = load(find(about.get("urdf", str))).model
    for link in links:
        name = link.get("name", str)
        if name not in model.link_names:
            raise link.error(f"the URDF has no link {name!r}: it has {', '.join(model.link_names)}")
        if "joint" in link.entries:
            joint = model.joints[model.link_index(name)]
            kind, axis = _motion(link)
            if not _moves_so(joint, kind, axis):
                raise link.error(f"joint is {link.entries['joint']!r}; in the URDF {joint.name} is {_said(joint)}")
    return model


def _moves_so(joint: Joint, kind: str, axis: tuple[float, ...]) -> bool:
    same_kind = joint.type.name == kind or (kind == "revolute" and joint.type.rotates)
    return same_kind and (kind == "fixed" or tuple(float(x) for x in joint.axis) == axis)


def _said(joint: Joint) -> str:
    return joint.type.name + ("" if joint.type.name == "fixed" else f" about or along {joint.axis.tolist()}")


def _placed(slot: Slot, places: Sequence[int]) -> Slot:
    """A slot whose link is counted as in the model."""
    kind, *rest = slot
    return slot if kind == "gravity" else (kind, places[int(rest[0])], *rest[1:])


def _values_in(
    model: Model, slots: Mapping[Slot, Terms], symbols: Sequence[Symbol], given: Mapping[str, float], about: Table
) -> dict[str, float]:
    """The number of each letter as the URDF has it, and the proof that all expressions hold there."""
    values = dict(given)
    for slot, terms in slots.items():
        if len(terms) == 1:
            ((factors, coefficient),) = terms.items()
            if len(factors) == 1 and factors[0][1] == 1 and factors[0][0] not in values:
                values[factors[0][0]] = value_of_slot(model, slot) / float(coefficient)
    for slot, terms in slots.items():
        missing = [name for factors in terms for name, _ in factors if name not in values]
        if missing:
            raise about.error(f"no number of the URDF tells {missing[0]!r}: give it in [values]")
        here, there = float(evaluate(terms, values)), value_of_slot(model, slot)
        if not math.isclose(here, there, rel_tol=SAME, abs_tol=SAME * SAME):
            raise about.error(
                f"{_slot_name(model, slot)} is {there} in the URDF and {here} by the tables: one is wrong"
            )
    return values


def _slot_name(model: Model, slot: Slot) -> str:
    kind, *place = slot
    axes = "".join(AXES[int(x)] for x in (place if kind == "gravity" else place[1:]))
    owner = "" if kind == "gravity" else f" of {model.links[int(place[0])].name}"
    return f"{kind} {axes}{owner}".replace(" of", " of", 1)


# Without one


def _usual(symbols: Sequence[Symbol], slots: Mapping[Slot, Terms]) -> dict[str, float]:
    """Numbers for letters that nobody gave: of a usual size, all different; products of inertia small."""
    mixed = {
        name
        for slot, terms in slots.items()
        if slot[0] == "inertia" and slot[2] != slot[3]
        for factors in terms
        for name, _ in factors
    }
    values = {}
    for k, symbol in enumerate(symbols):
        spread = 1 + ((7 * k) % 23) / 100
        size = 9.81 if symbol.name == "g" else USUAL.get(symbol.dimension, 1.0) * spread
        values[symbol.name] = size / 10 if symbol.name in mixed else size
    return values


def _motion(link: Table) -> tuple[str, tuple[float, ...]]:
    """Type and axis of a joint, from words such as "revolute about z"."""
    words = link.get("joint", str).split()
    if words == ["fixed"]:
        return "fixed", (0.0, 0.0, 0.0)
    if len(words) == 3 and (words[0], words[1]) in (("revolute", "about"), ("prismatic", "along")):
        sign = -1.0 if words[2].startswith("-") else 1.0
        axis = words[2].lstrip("+-")
        if axis in ("x", "y", "z"):
            return words[0], tuple(sign if axis == other else 0.0 for other in AXES)
    raise link.error(
        f"joint is {link.entries['joint']!r}: expected 'revolute about z', 'prismatic along -y', 'fixed', ..."
    )


def _from_table(
    about: Table, links: Sequence[Table], slots: Mapping[Slot, Terms], values: Mapping[str, float]
) -> Model:
    """The model of a table of frames, by way of a URDF, so that every oracle can read it."""
    if not links:
        raise about.error(
            'names no URDF, and there is no [[link]]: give urdf = "arm.urdf", or a [[link]] for each link'
        )

    def number(slot: Slot) -> float:
        return float(evaluate(slots[slot], values)) if slot in slots else 0.0

    names = _names(links)
    for i, link in enumerate(links):
        if names[i] in ("base", *names[:i]):
            raise link.error(f"name is {names[i]!r}, which another link has: give each its own")
        if number(("mass", i)) < 0:
            raise link.error(f"mass is {number(('mass', i))} with the numbers of the letters: expected 0 or more")
    parts = ['<link name="base"/>']
    for i, link in enumerate(links):
        parent = link.get("parent", str, names[i - 1] if i else "base")
        if parent not in ("base", *names[:i]):
            raise link.error(f"parent is {parent!r}: expected base or a link above: {', '.join(names[:i])}")
        parts += [_link_xml(i, names[i], number), _joint_xml(link, i, (parent, names[i]), number)]
    gravity = tuple(number(("gravity", x)) for x in range(3)) if ("gravity", 0) in slots else (0.0, 0.0, -9.81)
    return load(f'<robot name="equations">{"".join(parts)}</robot>', gravity=gravity).model


def _degrees(link: Table, text: str) -> float:
    try:
        return float(Fraction(text))
    except (ValueError, ZeroDivisionError) as error:
        raise link.error(f"rpy_degrees has {text!r}: expected a number of degrees") from error


def _names(links: Sequence[Table]) -> list[str]:
    return [link.get("name", str, f"link_{i + 1}") for i, link in enumerate(links)]


def _link_xml(i: int, name: str, number: Callable[[Slot], float]) -> str:
    mass = number(("mass", i))
    tensor = {AXES[x] + AXES[y]: number(("inertia", i, x, y)) for x, y in ENTRIES}
    if not mass and not any(tensor.values()):
        return f"<link name={quoteattr(name)}/>"
    com = " ".join(repr(number(("com", i, x))) for x in range(3))
    entries = " ".join(f'i{axes}="{value!r}"' for axes, value in tensor.items())
    return (
        f'<link name={quoteattr(name)}><inertial><origin xyz="{com}" rpy="0 0 0"/><mass value="{mass!r}"/>'
        f"<inertia {entries}/></inertial></link>"
    )


def _joint_xml(link: Table, i: int, ends: tuple[str, str], number: Callable[[Slot], float]) -> str:
    kind, axis = _motion(link)
    xyz = " ".join(repr(number(("origin", i, x))) for x in range(3))
    degrees = [_degrees(link, text) for text in link.texts("rpy_degrees", 3, ("0", "0", "0"))]
    rpy = " ".join(repr(math.radians(angle)) for angle in degrees)
    moves = "" if kind == "fixed" else f'<axis xyz="{axis[0]} {axis[1]} {axis[2]}"/>'
    limits = "" if kind == "fixed" else '<limit lower="-1" upper="1" effort="100" velocity="1"/>'
    return (
        f'<joint name="joint_{i + 1}" type="{kind}"><origin xyz="{xyz}" rpy="{rpy}"/>'
        f"<parent link={quoteattr(ends[0])}/><child link={quoteattr(ends[1])}/>{moves}{limits}</joint>"
    )
