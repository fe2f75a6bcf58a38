"""Files of equations: from TOML or YAML to a publication with its robot, symbols and conventions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from os import PathLike
from pathlib import Path

from rttrr_pin.auditing.publication import DEFINITION, Convention, Equation, Publication
from rttrr_pin.core.arguments import path_of
from rttrr_pin.core.model import Model
from rttrr_pin.derivation.symbol_file import PUBLISHED, SYMBOL_KEYS, read_symbols, spell
from rttrr_pin.derivation.symbolic_robot import Slot, SymbolicRobot, value_of_slot
from rttrr_pin.derivation.tables import Table, read_table, shown
from rttrr_pin.derivation.templates import filled
from rttrr_pin.errors import InputError

RTTRR = Path(__file__).parent / "data/rttrr_2016_conventions.toml"
"""The paper that this package starts from."""

FILE_KEYS = (
    *("title", "source", "language", "symbols", "equations", *SYMBOL_KEYS),
    *("coordinates", "equation", "convention"),
)
EQUATION_KEYS = ("number", "line", "quantity", "link", "joint", "row", "column", "components", "latex", "python")

VECTORS, SCALARS, MATRICES = ("vC", "F", "N", "f", "n"), ("tau", "g", "a"), ("M", "C")
"""Quantities of a link, of a joint, and of two."""

COORDINATES: Mapping[str, tuple[str, str, str, str]] = {
    "latex": ("q_<k>", r"\dot{q}_<k>", r"\ddot{q}_<k>", r"\tau_<k>"),
    "python": ("q<k>", "qd<k>", "qdd<k>", "tau<k>"),
}
"""How coordinates, rates, accelerations and forces are spelled unless [coordinates] says otherwise."""

NO_FORCE = "0"
"""Instead of a spelling: nothing drives this joint."""

MOST_EQUATIONS = 1000
"""In one file."""


def read_publication(
    path: str | PathLike[str] = RTTRR,
    xacro: bool = False,
    xacro_args: Mapping[str, object] | None = None,
    lenient: bool = False,
    mimic: bool = True,
    packages: Mapping[str, str | PathLike[str]] | None = None,
) -> Publication:
    """A file of equations, TOML or YAML, with its robot, symbols and conventions.

    Args:
        path: the file; without one, the paper on RTTRR.
        xacro: whether a xacro file behind `urdf` is expanded, which runs the Python in it.
        xacro_args: values of its <xacro:arg>, as in `load`.
        lenient: whether to go on where it does not say what a number is, as in `load`.
        mimic: whether its joints with <mimic> follow others.
        packages: folders of the ROS packages that it names.

    Raises:
        InputError: it is no path.
        EquationError: the file cannot be used; the message names the place and the reason.
        UrdfError, InputError: its URDF cannot be used, as in `load`.
    """
    reading = {"xacro": xacro, "xacro_args": xacro_args, "lenient": lenient, "mimic": mimic, "packages": packages}
    path = path_of("path", path)
    file = read_table(path).only(FILE_KEYS)
    language = file.get("language", str, "latex")
    if language not in COORDINATES:
        raise file.error(f"language is {shown(language)}: expected {' or '.join(COORDINATES)}")
    latex = language == "latex"
    symbols = read_symbols(*_symbol_file(file, path), latex, reading=reading)
    spellings = dict(symbols.spellings)
    passive = _spell_motion(spellings, file, symbols.robot.model, language)
    equations = tuple(_equations(file, path, symbols.robot.model, language))
    publication = Publication(
        title=file.get("title", str, path.stem),
        source=file.get("source", str, path.name),
        language=language,
        robot=_with_decimals(symbols.robot),
        spellings=spellings,
        aliases=symbols.aliases,
        equations=equations,
        conventions=tuple(_conventions(file, set(spellings.values()))),
        passive=passive,
        definitions=tuple(text for x in equations if x.quantity == DEFINITION for text in x.texts),
    )
    try:
        if latex:
            publication.vocabulary  # noqa: B018 - said now, with the file's name, and not in the middle of an audit
    except InputError as error:
        raise file.error(str(error)) from error
    return publication


def _symbol_file(file: Table, path: Path) -> tuple[Table, Path]:
    """The tables of symbols: the file's own, those of a file beside it, or those of a bundled robot."""
    name = file.get("symbols", str, "")
    if not name:
        return file, path
    own = [key for key in SYMBOL_KEYS if key in file.entries]
    if own:
        raise file.error(f"has [{own[0]}] beside symbols = {shown(name)}: leave one")
    beside = path.parent / name
    target = beside if beside.is_file() else PUBLISHED / f"{name}.toml"
    if not target.is_file():
        known = ", ".join(sorted(x.stem for x in PUBLISHED.glob("*.toml")))
        raise file.error(f"symbols is {shown(name)}: expected a file beside this one, or one of {known}")
    return read_table(target).only(FILE_KEYS), target


def _with_decimals(robot: SymbolicRobot) -> SymbolicRobot:
    """The robot whose numbers without a symbol are what their decimals say: a text has 9.81, not the nearest double."""
    model, slots = robot.model, dict(robot.parameters.slots)
    axes = range(3)
    every: list[Slot] = [("gravity", x) for x in axes]
    for i in range(len(model.links)):
        every += [("mass", i), *(("com", i, x) for x in axes), *(("origin", i, x) for x in axes)]
        every += [("inertia", i, x, y) for x in axes for y in axes]
    for slot in every:
        if slot not in slots and (value := value_of_slot(model, slot)):
            slots[slot] = {(): Fraction(repr(value))}
    return replace(robot, parameters=replace(robot.parameters, slots=slots))


def _spell_motion(spellings: dict[str, str], file: Table, model: Model, language: str) -> tuple[int, ...]:
    """Add the spellings of coordinates, rates, accelerations and forces: by a template with <k>, or one for each.

    Returns:
        The joints that nothing drives.
    """
    keys = ("position", "velocity", "acceleration", "force")
    table = file.table("coordinates").only(keys)
    counts = (model.nq, model.nv, model.nv, model.nv)
    passive: tuple[int, ...] = ()
    for key, letter, usual, count in zip(keys, ("q", "v", "a", "tau"), COORDINATES[language], counts, strict=True):
        texts = table.texts(key, default=[usual])
        templates = [text for text in texts if "<k>" in text]
        single = [text for text in texts if "<k>" not in text]
        if single and len(single) != count:
            raise table.error(
                f"{key} has {len(single)} spellings without <k> for {count} coordinates: "
                "give one spelling with <k>, or one for each"
            )
        for k in range(1, count + 1):
            general = [filled(text, {"k": str(k)}, latex=language == "latex") for text in templates]
            printed = [*single[k - 1 : k], *general]
            if key == "force" and NO_FORCE in printed:
                passive = (*passive, k - 1)
            elif key != "force" or key in table.entries:
                spell(spellings, printed, f"{letter}_{k}", table)
            else:  # usual letters of forces, unless they are symbols of the robot
                spellings |= {text: f"{letter}_{k}" for text in printed if text not in spellings}
    return passive


def _equations(file: Table, path: Path, model: Model, language: str) -> list[Equation]:
    """The equations, which may stand in a file of their own."""
    separate = file.get("equations", str, "")
    tables = file.tables("equation", "equation")
    if separate:
        tables += read_table(path.parent / separate).only(("equation",)).tables("equation", "equation")
    if not tables:
        raise file.error("holds no [[equation]]: add one for each equation")
    if len(tables) > MOST_EQUATIONS:
        raise file.error(f"has {len(tables)} equations, expected {MOST_EQUATIONS} at most: divide it into files")
    equations = [_equation(table, model, language) for table in tables]
    names: dict[str, int | str] = {}
    for table, equation in zip(tables, equations, strict=True):
        for name in equation.names:
            if name in names:
                raise table.error(f"states {name}, as equation {names[name]} does: leave one")
            names[name] = equation.number
    return equations


def _equation(table: Table, model: Model, language: str) -> Equation:
    table.only(EQUATION_KEYS)
    number = table.entries.get("number", table.place.removeprefix("equation "))
    if isinstance(number, bool) or not isinstance(number, int | str):
        raise table.error(f'number is {shown(number)}: expected a whole number, or a text such as "6.10"')
    texts = tuple(table.texts(language))
    line = table.get("line", int, 0)
    quantity = table.get("quantity", str)
    if quantity == DEFINITION:
        return Equation(number, quantity, -1, "", texts, line)
    if quantity in VECTORS:
        axes = table.get("components", str, "xyz")
        if not axes or any(axis not in "xyz" for axis in axes) or len(set(axes)) < len(axes):
            raise table.error(f"components is {shown(axes)}: expected xyz, or some of them")
        _one_text_each(table, texts, len(axes), language)
        return Equation(number, quantity, _place(table, "link", model.link_names), axes, texts, line)
    if quantity in SCALARS and "joint" in table.entries:
        _one_text_each(table, texts, 1, language)
        return Equation(number, quantity, _place(table, "joint", model.v_names), "", texts, line)
    every = tuple(range(model.nv))
    if quantity in SCALARS:
        _one_text_each(table, texts, model.nv, language)
        return Equation(number, quantity, -1, "", texts, line, indices=every)
    if quantity in MATRICES:
        rows, columns = (
            (_place(table, key, model.v_names),) if key in table.entries else every for key in ("row", "column")
        )
        _one_text_each(table, texts, len(rows) * len(columns), language)
        return Equation(number, quantity, -1, "", texts, line, indices=rows, columns=columns)
    known = ", ".join((*VECTORS, *SCALARS, *MATRICES))
    raise table.error(f"quantity is {shown(quantity)}: expected {known} or {DEFINITION}")


def _one_text_each(table: Table, texts: Sequence[str], count: int, language: str) -> None:
    if len(texts) != count and (language != "latex" or len(texts) != 1):
        in_all = ", or one in all" if language == "latex" else ""
        raise table.error(f"has {len(texts)} texts for {count} components: give one for each{in_all}")


def _place(table: Table, key: str, names: Sequence[str]) -> int:
    """Which link or joint, by number from 1 or by name."""
    value = table.entries.get(key)
    if isinstance(value, str) and value in names:
        return names.index(value)
    if isinstance(value, int) and not isinstance(value, bool) and 1 <= value <= len(names):
        return value - 1
    raise table.error(f"{key} is {shown(value)}: expected 1 to {len(names)}, or one of {', '.join(names)}")


def _conventions(file: Table, symbols: set[str]) -> list[Convention]:
    conventions = []
    for table in file.tables("convention", "[[convention]]"):
        table.only(("title", "text", "equations", "flip"))
        flip = table.texts("flip", default=())
        unknown = [name for name in flip if name not in symbols]
        if unknown:
            raise table.error(f"flip names {shown(unknown[0])}, which is no symbol: use names of [[symbol]]")
        numbers = tuple(table.get("equations", list, []))
        conventions.append(Convention(table.get("title", str), table.get("text", str), numbers, tuple(flip)))
    return conventions
