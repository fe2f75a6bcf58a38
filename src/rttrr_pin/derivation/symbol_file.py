"""Files of symbols: a robot whose numbers have names, from `[robot]`, `[[link]]`, `[[symbol]]`, `[payload]`."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rttrr_pin.core.model import Model
from rttrr_pin.derivation.expressions import read_expression
from rttrr_pin.derivation.frame_table import ENTRIES, joint_motion, model_of
from rttrr_pin.derivation.ring import evaluate
from rttrr_pin.derivation.symbolic_robot import (
    AXES,
    SLOTS,
    ParameterSymbols,
    Slot,
    SymbolicRobot,
    value_of_slot,
)
from rttrr_pin.derivation.symbols import INERTIA, LENGTH, MASS, Dimension, Expression, Symbol, dimension_of
from rttrr_pin.derivation.tables import Table, read_table, shown
from rttrr_pin.derivation.templates import MOST_SYMBOLS, Declaration, declarations
from rttrr_pin.errors import InputError, RttrrError
from rttrr_pin.loading import load

PUBLISHED = Path(__file__).parent / "data"
"""Files of symbols of bundled robots, by the robot's name."""

SYMBOL_KEYS = ("robot", "payload", "link", "symbol", "values", "preface")
ROBOT_KEYS = ("urdf", "gravity")
PLACES: Mapping[str, Sequence[tuple[int, ...]]] = {
    "mass": ((),),
    "origin": ((0,), (1,), (2,)),
    "com": ((0,), (1,), (2,)),
    "inertia": ENTRIES,
}
"""The numbers of a link, by their axes."""

MOST_LINKS = 50
"""Of a table of frames."""

LINK_KEYS = ("name", "parent", "joint", "origin", "rpy_degrees", "mass", "com", "inertia")

USUAL: Mapping[Dimension, float] = {LENGTH: 0.3, MASS: 2.0, INERTIA: 0.1}
"""The size of a symbol's number where no file and no [values] give it."""

SAME = 1e-9
"""Relative difference within which a number of a URDF is what the table of frames says: files are rounded."""


READ_AS_IT_STANDS: Mapping[str, Any] = {}


@dataclass(frozen=True)
class PublishedSymbols:
    """A robot in the symbols of a publication.

    Attributes:
        robot: the robot, with a number for each symbol.
        spellings: the name of the symbol that each spelling stands for; of several spellings the first is preferred.
        aliases: names of symbols that are equal to another, as J_yx is to J_xy, with the name of that other.
        preface: a paragraph that stands before what is derived in these symbols.
    """

    robot: SymbolicRobot
    spellings: Mapping[str, str]
    aliases: Mapping[str, str]
    preface: str = ""


def published_symbols(robot: str, model: Model, payload_link: int | None) -> PublishedSymbols | None:
    """The published symbols of a bundled robot; None where there are none, or they do not fit the robot as loaded."""
    path = PUBLISHED / f"{robot}.toml"
    if not path.is_file():
        return None
    try:
        symbols = read_symbols(read_table(path), path, latex=True, model=model)
    except RttrrError:
        return None
    return symbols if symbols.robot.payload_link == payload_link else None


def read_symbols(
    file: Table, path: Path, latex: bool, model: Model | None = None, reading: Mapping[str, Any] = READ_AS_IT_STANDS
) -> PublishedSymbols:
    """The robot of a file of symbols.

    Args:
        file: the tables [robot], [[link]], [[symbol]], [payload], [values].
        path: of the file; its URDF is looked for beside it.
        latex: whether spellings are LaTeX.
        model: of the URDF, where it is loaded already.
        reading: how its URDF is read: arguments of `load`, by name.

    Raises:
        EquationError: the tables do not fit each other, or the URDF.
        UrdfError: the URDF cannot be used.
    """
    about = file.table("robot").only(ROBOT_KEYS)
    links = file.tables("link", "[[link]]")
    if len(links) > MOST_LINKS:
        raise file.error(f"has {len(links)} tables [[link]], expected {MOST_LINKS} at most: closed forms are for arms")
    declared, spellings = _declared(file, sum("mass" in link.entries for link in links), latex)
    aliases = {name: one.equal for name, one in declared.items() if one.equal}
    wrong = [equal for equal in aliases.values() if equal not in declared or equal in aliases]
    if wrong:
        raise file.error(f"a symbol is said to be equal to {shown(wrong[0])}: expected the name of another symbol")
    symbols = [one.symbol for name, one in declared.items() if name not in aliases]
    slots = dict(_slots(links, about, [symbol.name for symbol in symbols]))
    values = _given_values(file, symbols)
    if model is not None or "urdf" in about.entries:
        if model is None:
            name = about.get("urdf", str)
            beside = path.parent / name  # a file; where there is none, the name is what `load` takes
            model = load(str(beside) if beside.is_file() else name, **reading).model
        _check_frames(model, links)
        indices = [model.link_index(link.get("name", str)) for link in links]
        slots = {_moved(slot, indices): x for slot, x in slots.items()}
        values = _values_in(model, slots, values, about)
    else:
        if not links:
            raise about.error('names no URDF, and there is no [[link]]: give urdf = "arm.urdf", or a [[link]] for each')
        values = _usual(symbols, slots) | values
        model = model_of(
            links, lambda slot: float(evaluate(slots[slot], values)) if slot in slots else 0.0, ("gravity", 0) in slots
        )
    payload_link, payload = _payload(file.table("payload").only(("link", "force", "moment")), model, symbols)
    slots |= payload
    _check_dimensions(slots, {symbol.name: symbol for symbol in symbols}, file)
    roles = {name: SLOTS[slot[0]].role for slot, x in slots.items() for factors in x for name, _ in factors}
    idle = [symbol.name for symbol in symbols if symbol.name not in roles]
    if idle:
        raise file.error(
            f"symbol {shown(idle[0])} stands for no number: use it in [robot], [[link]] or [payload]; "
            "what stands for other symbols is defined by an equation"
        )
    chosen = tuple(replace(symbol, role=roles[symbol.name]) for symbol in symbols)
    parameters = ParameterSymbols(chosen, slots, {symbol.name: values.get(symbol.name, 0.0) for symbol in chosen})
    preface = " ".join(file.get("preface", str, "").split())
    return PublishedSymbols(SymbolicRobot(model, parameters, payload_link), spellings, aliases, preface)


def spell(spellings: dict[str, str], printed: Sequence[str], name: str, table: Table) -> None:
    """Add spellings of a symbol; one that another symbol has would silently be read as either."""
    for spelling in printed:
        other = spellings.setdefault(spelling, name)
        if other != name:
            raise table.error(
                f"{shown(spelling)} is to be {shown(name)}, and is {shown(other)} already: spell them differently"
            )


def _declared(file: Table, links: int, latex: bool) -> tuple[dict[str, Declaration], dict[str, str]]:
    """Declarations by name, and the name of each spelling."""
    declared: dict[str, Declaration] = {}
    spellings: dict[str, str] = {}
    for table in file.tables("symbol", "[[symbol]]"):
        for one in declarations(table, links, latex):
            name = one.symbol.name
            if name in declared:
                raise table.error(f"symbol {shown(name)} is declared twice: leave one")
            declared[name] = one
            if len(declared) > MOST_SYMBOLS:
                raise file.error(f"declares more than {MOST_SYMBOLS} symbols: leave those of the equations")
            spell(spellings, one.spellings, name, table)
    return declared, spellings


def _given_values(file: Table, symbols: Sequence[Symbol]) -> dict[str, float]:
    table = file.table("values")
    values = {name: table.get(name, float) for name in table.entries}
    for name, value in values.items():
        if name not in {symbol.name for symbol in symbols}:
            raise table.error(f"{shown(name)} is no symbol: declare it in [[symbol]]")
        if not math.isfinite(value):
            raise table.error(f"{name} is {value}: expected a finite number")
    return values


def _slots(links: Sequence[Table], about: Table, names: Sequence[str]) -> Iterator[tuple[Slot, Expression]]:
    """The expression of each number that the tables state; links by their position in the table."""
    for i, link in enumerate(links):
        link.only(LINK_KEYS)
        read = _reader(link, names)
        for key, entries in PLACES.items():
            if key in link.entries:
                for axes, text in zip(entries, link.texts(key, len(entries)), strict=True):
                    yield (key, i, *axes), read(text)
                    yield (key, i, *axes[::-1]), read(text)  # tensors are symmetric
    if "gravity" in about.entries:
        for x, text in enumerate(about.texts("gravity", 3)):
            yield ("gravity", x), _reader(about, names)(text)


def _reader(table: Table, names: Sequence[str]) -> Callable[[str], Expression]:
    """Reads expressions in these symbols; what is wrong is said with the table's place."""

    def read(text: str) -> Expression:
        try:
            return read_expression(text, names)
        except InputError as error:
            raise table.error(str(error)) from error

    return read


def _payload(table: Table, model: Model, symbols: Sequence[Symbol]) -> tuple[int | None, dict[Slot, Expression]]:
    if not table.entries:
        return None, {}
    name = table.get("link", str, model.links[-1].name)
    if name not in model.link_names:
        raise table.error(f"link is {shown(name)}: expected one of {', '.join(model.link_names)}")
    read = _reader(table, [symbol.name for symbol in symbols])
    texts = {key: table.texts(key, 3, ("0", "0", "0")) for key in ("force", "moment")}
    return model.link_index(name), {(key, x): read(text) for key, row in texts.items() for x, text in enumerate(row)}


def _check_dimensions(slots: Mapping[Slot, Expression], symbols: Mapping[str, Symbol], file: Table) -> None:
    """Each symbol may stand only for what it measures; a bare number has the unit of its place."""
    for slot, expression in slots.items():
        wanted = SLOTS[slot[0]].dimension
        for factors in filter(None, expression):
            if (got := dimension_of(factors, symbols)) != wanted:
                shown = " ".join(f"{name}^{power}" if power > 1 else name for name, power in factors)
                raise file.error(f"{slot[0]} has {shown}, which measures {got}: expected {wanted}")


def _check_frames(model: Model, links: Sequence[Table]) -> None:
    """The table of frames agrees with the model of a URDF."""
    for link in links:
        name = link.get("name", str)
        if name not in model.link_names:
            raise link.error(f"the URDF has no link {shown(name)}: it has {', '.join(model.link_names)}")
        if "joint" in link.entries:
            joint = model.joints[model.link_index(name)]
            motion, axis = joint_motion(link)
            same_type = joint.type.name == motion or (motion == "revolute" and joint.type.rotates)
            if not same_type or (motion != "fixed" and tuple(joint.axis.tolist()) != axis):
                moves = f" about or along {joint.axis.tolist()}" if joint.nv else ""
                raise link.error(
                    f"joint is {shown(link.entries['joint'])}; in the URDF {joint.name} is {joint.type.name}{moves}"
                )


def _moved(slot: Slot, indices: Sequence[int]) -> Slot:
    """A slot whose link is counted as in the model."""
    return slot if slot[0] == "gravity" else (slot[0], indices[int(slot[1])], *slot[2:])


def _values_in(
    model: Model, slots: Mapping[Slot, Expression], stated: Mapping[str, float], about: Table
) -> dict[str, float]:
    """The number of each symbol as the URDF has it, once all expressions are shown to hold there."""
    values = dict(stated)
    for slot, expression in slots.items():
        if len(expression) == 1:
            ((factors, coefficient),) = expression.items()
            if len(factors) == 1 and factors[0][1] == 1 and factors[0][0] not in values:
                values[factors[0][0]] = value_of_slot(model, slot) / float(coefficient)
    for slot, expression in slots.items():
        missing = [name for factors in expression for name, _ in factors if name not in values]
        if missing:
            raise about.error(f"no number of the URDF tells {shown(missing[0])}: give it in [values]")
        here, there = float(evaluate(expression, values)), value_of_slot(model, slot)
        if not math.isclose(here, there, rel_tol=SAME, abs_tol=SAME * SAME):
            raise about.error(
                f"{_slot_name(model, slot)} is {there} in the URDF and {here} by the tables: one is wrong"
            )
    return values


def _slot_name(model: Model, slot: Slot) -> str:
    indices = [int(x) for x in slot[1:]]
    if slot[0] == "gravity":
        return f"gravity {AXES[indices[0]]}"
    axes = "".join(AXES[x] for x in indices[1:])
    return " ".join(filter(None, (str(slot[0]), axes, "of", model.links[indices[0]].name)))


def _usual(symbols: Sequence[Symbol], slots: Mapping[Slot, Expression]) -> dict[str, float]:
    """Numbers for symbols that nobody gave: of a usual size, all different; products of inertia small."""
    mixed = {
        name
        for slot, expression in slots.items()
        if slot[0] == "inertia" and slot[2] != slot[3]
        for factors in expression
        for name, _ in factors
    }
    values = {}
    for k, symbol in enumerate(symbols):
        size = 9.81 if symbol.name == "g" else USUAL.get(symbol.dimension, 1.0) * (1 + ((7 * k) % 23) / 100)
        values[symbol.name] = size / 10 if symbol.name in mixed else size
    return values
