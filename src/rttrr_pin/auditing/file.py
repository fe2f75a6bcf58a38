"""Files of equations: from TOML or YAML to a publication with its robot, symbols and conventions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

from rttrr_pin.auditing.arm import read_robot
from rttrr_pin.auditing.match import as_terms
from rttrr_pin.auditing.publication import DEFINITION, Convention, Equation, Publication
from rttrr_pin.auditing.reading.python import read_python
from rttrr_pin.auditing.tables import Table, read_table
from rttrr_pin.auditing.templates import filled, letters_in
from rttrr_pin.derivation.chain import SymbolicRobot
from rttrr_pin.derivation.symbols import Symbol, Terms
from rttrr_pin.errors import InputError

DATA = Path(__file__).parent / "data"
RTTRR = DATA / "rttrr_2016_conventions.toml"
"""The paper that this package starts from."""

FILE_KEYS = (
    *("title", "source", "language", "equations", "robot", "payload", "link", "symbol", "coordinates", "values"),
    *("equation", "convention"),
)
EQUATION_KEYS = ("number", "line", "quantity", "link", "joint", "components", "latex", "python")

VECTORS, SCALARS = ("vC", "F", "N", "f", "n"), ("tau",)
"""Quantities of a link, and of a joint."""

COORDINATES: Mapping[str, tuple[str, str, str]] = {
    "latex": ("q_<k>", r"\dot{q}_<k>", r"\ddot{q}_<k>"),
    "python": ("q<k>", "qd<k>", "qdd<k>"),
}
"""How coordinates, rates and accelerations are spelled unless [coordinates] says otherwise."""


def read_publication(path: Path = RTTRR) -> Publication:
    """A file of equations, TOML or YAML, with its robot, symbols and conventions.

    Args:
        path: the file; without one, the paper on RTTRR.

    Returns:
        The publication.

    Raises:
        EquationError: the file cannot be used; it says where and why.
        UrdfError: its URDF cannot be used.
    """
    file = read_table(path).only(FILE_KEYS)
    language = file.get("language", str, "latex")
    if language not in COORDINATES:
        raise file.error(f"language is {language!r}: expected {' or '.join(COORDINATES)}")
    links = sum("mass" in link.entries for link in file.tables("link"))
    symbols: dict[str, Symbol] = {}
    spellings: dict[str, str] = {}
    twins: dict[str, str] = {}
    for table in file.tables("symbol", "[[symbol]]"):
        for letter in letters_in(table, links, language == "latex"):
            name = letter.symbol.name
            if name in symbols:
                raise table.error(f"symbol {name!r} is declared twice: leave one")
            symbols[name] = letter.symbol
            _spell(spellings, letter.spellings, name, table)
            if letter.equal:
                twins[name] = letter.equal
    strangers = [name for name in twins.values() if name not in symbols or name in twins]
    if strangers:
        raise file.error(f"a symbol is said to be equal to {strangers[0]!r}: expected the name of another symbol")
    letters = [symbol for name, symbol in symbols.items() if name not in twins]
    robot = read_robot(file, letters, _expression(symbols), _finder(path))
    _spell_motion(spellings, file, robot, language)
    found = Publication(
        title=file.get("title", str, path.stem),
        source=file.get("source", str, path.name),
        language=language,
        robot=robot,
        spellings=spellings,
        twins=twins,
        equations=tuple(_equations(file, path, robot, language)),
        conventions=tuple(_conventions(file, symbols)),
    )
    try:
        if language == "latex":
            found.vocabulary  # noqa: B018 - said now, with the file's name, and not in the middle of an audit
    except InputError as error:
        raise file.error(str(error)) from error
    return found


def _spell(spellings: dict[str, str], printed: Iterable[str], name: str, table: Table) -> None:
    """Add spellings of a symbol; one that another symbol has would silently be read as either."""
    for spelling in printed:
        other = spellings.setdefault(spelling, name)
        if other != name:
            raise table.error(f"{spelling!r} is to be {name!r}, and is {other!r} already: spell them differently")


def _expression(symbols: Mapping[str, Symbol]) -> Callable[[Table, str], Terms]:
    """Reads expressions in the letters, such as `-J_1xy` or `l_1/2`."""
    names = {name: name for name in symbols}

    def read(table: Table, text: str) -> Terms:
        component = read_python(text, names)
        if component.unparsed:
            raise table.error(f"{text!r} cannot be read: {component.unparsed}")
        readings = [term.readings[0] for term in component.terms]
        unknown = [name for reading in readings for name in reading.unknown]
        if unknown:
            raise table.error(f"{text!r} has {unknown[0]!r}, which is no symbol: declare it in [[symbol]]")
        return as_terms((reading.coefficient, reading.factors) for reading in readings)

    return read


def _finder(path: Path) -> Callable[[str], str]:
    """A URDF is looked for beside the file first; otherwise the name is what `load` takes."""

    def find(name: str) -> str:
        beside = path.parent / name
        return str(beside) if beside.is_file() else name

    return find


def _spell_motion(spellings: dict[str, str], file: Table, robot: SymbolicRobot, language: str) -> None:
    """Add the spellings of coordinates, rates and accelerations."""
    table = file.table("coordinates").only(("position", "velocity", "acceleration"))
    usual = COORDINATES[language]
    for key, letter, default, count in zip(
        ("position", "velocity", "acceleration"),
        "qva",
        usual,
        (robot.model.nq, robot.model.nv, robot.model.nv),
        strict=True,
    ):
        for template in table.texts(key, default=[default]):
            for k in range(1, count + 1):
                printed = filled(template, {"k": str(k)}, latex=language == "latex")
                _spell(spellings, [printed], f"{letter}_{k}", table)


def _equations(file: Table, path: Path, robot: SymbolicRobot, language: str) -> list[Equation]:
    """The equations, which may stand in a file of their own."""
    place = file.get("equations", str, "")
    tables = file.tables("equation", "equation")
    if place:
        tables += read_table(path.parent / place).only(("equation",)).tables("equation", "equation")
    if not tables:
        raise file.error("holds no [[equation]]: add one for each equation")
    found = [_equation(table, robot, language) for table in tables]
    names: dict[str, int | str] = {}
    for table, equation in zip(tables, found, strict=True):
        for name in equation.names:
            if name in names:
                raise table.error(f"states {name}, as equation {names[name]} does: leave one")
            names[name] = equation.number
    return found


def _equation(table: Table, robot: SymbolicRobot, language: str) -> Equation:
    table.only(EQUATION_KEYS)
    number = table.entries.get("number", table.place.removeprefix("equation "))
    if isinstance(number, bool) or not isinstance(number, int | str):
        raise table.error(f'number is {number!r}: expected a whole number, or a text such as "6.10"')
    texts = tuple(table.texts(language))
    line = table.get("line", int, 0)
    quantity = table.get("quantity", str)
    if quantity == DEFINITION:
        return Equation(number, quantity, -1, "", texts, line)
    if quantity in VECTORS:
        axes = table.get("components", str, "xyz")
        if not axes or any(axis not in "xyz" for axis in axes) or len(set(axes)) < len(axes):
            raise table.error(f"components is {axes!r}: expected xyz, or some of them")
        if len(texts) not in (1, len(axes)):
            raise table.error(f"has {len(texts)} texts for {len(axes)} components: give one for each, or one in all")
        return Equation(number, quantity, _place(table, "link", robot.model.link_names), axes, texts, line)
    if quantity in SCALARS:
        return Equation(number, quantity, _place(table, "joint", robot.model.v_names), "", texts, line)
    raise table.error(f"quantity is {quantity!r}: expected {', '.join((*VECTORS, *SCALARS))} or {DEFINITION}")


def _place(table: Table, key: str, names: Sequence[str]) -> int:
    """Which link or joint, by number from 1 or by name."""
    value = table.entries.get(key)
    if isinstance(value, str) and value in names:
        return names.index(value)
    if isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= len(names):
        return value - 1
    raise table.error(f"{key} is {value!r}: expected 1 to {len(names)}, or one of {', '.join(names)}")


def _conventions(file: Table, symbols: Mapping[str, Symbol]) -> list[Convention]:
    found = []
    for table in file.tables("convention", "[[convention]]"):
        table.only(("title", "text", "equations", "flip"))
        flip = table.texts("flip", default=())
        unknown = [name for name in flip if name not in symbols]
        if unknown:
            raise table.error(f"flip names {unknown[0]!r}, which is no symbol: use names of [[symbol]]")
        numbers = tuple(table.get("equations", list, []))
        found.append(Convention(table.get("title", str), table.get("text", str), numbers, tuple(flip)))
    return found
