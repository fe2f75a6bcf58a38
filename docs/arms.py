"""The bundled arms: `python docs/arms.py urdf` writes the files, and the tables of urdf/README.md.

The tables have one row for each number, with its source.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator, Mapping
from itertools import pairwise
from pathlib import Path
from types import MappingProxyType

from rttrr_pin.core.solids import Part, Triple
from rttrr_pin.errors import InputError
from rttrr_pin.modular_arm.build import Arm, build_arm, build_urdf, decimals, significant
from rttrr_pin.modular_arm.modules import BASE, BASE_EXIT, CODES, MATERIALS, MODULES, TOOL, TOOL_ENTRY, Module

PAPER: Mapping[tuple[str, str], str] = MappingProxyType(
    {
        ("joint_1", "axis"): "(9): q1'' and q1'^2 accelerate along x and y, never along z",
        ("joint_2", "axis"): "(10): q2'' adds to the z component alone",
        ("joint_3", "axis"): "(11): q3'' adds to the y component alone",
        ("joint_4", "axis"): "(12): c q4 and s q4 mix x and y",
        ("joint_5", "axis"): "(13)-(15): c q5 and s q5 mix x and z; (13) has -s q5 g",
        ("joint_1", "x"): "none: the base frame stands under the axis",
        ("joint_1", "y"): "none: the base frame stands under the axis",
        ("joint_1", "z"): "h1; in no equation, since {1} does not move away from the base",
        ("joint_2", "x"): "no length in (10): zero",
        ("joint_2", "y"): "no length in (10): zero",
        ("joint_2", "z"): "h2; see *heights*",
        ("joint_3", "x"): "l2, (11): -q1'^2 l2 in x",
        ("joint_3", "y"): "l3, (11): -q1'' l3 in x, added to q3",
        ("joint_3", "z"): "h3; see *heights*",
        ("joint_4", "x"): "no other length beside l2 in (12): zero",
        ("joint_4", "y"): "l4, (12): added to q3 + l3",
        ("joint_4", "z"): "h4; see *heights*",
        ("joint_5", "x"): "no length beyond l4 in (13)-(15): zero",
        ("joint_5", "y"): "no length beyond l4 in (13)-(15): zero",
        ("joint_5", "z"): "h5; see *heights*",
        ("tool_joint", "x"): "{6} of (8); not given: taken as zero",
        ("tool_joint", "y"): "{6} of (8); not given: taken as zero",
        ("tool_joint", "z"): "{6} of (8); h6, carries the payload's force into n5, whose equations are not printed",
    }
)
"""Where the paper shows, or leaves out, RTTRR's geometry: (joint, axis or component of the origin) -> equation."""

BEGIN, END = "<!-- tables: begin -->", "<!-- tables: end -->"
"""What stands before and after the tables in urdf/README.md."""

Row = tuple[str, ...]


def readme_tables() -> str:
    """The tables of urdf/README.md: one row for each number in the bundled files, with its source (Markdown)."""
    sections = [
        "## Materials\n\n" + _table(("material", "density [kg/m^3]", "assumed: stands for"), _material_rows()),
        "## Modules: joints\n\n"
        "The axis, ports and limits of each module; all are ours. Ports and origins that are not listed are zero.\n\n"
        + _table(("module", "quantity", "value", "unit", "assumed because"), _module_rows()),
        "## Modules: solids\n\n"
        "Centres and angles in the frame at the joint's origin (of the base and the tool: in their frame), at q = 0. "
        "Dimensions are\noutlines. Coordinates and angles that are not listed are zero. All are ours, by the look of "
        "such parts.\n\n"
        + _table(("module", "belongs to", "solid", "quantity", "value", "unit", "computed mass [kg]"), _solid_rows()),
    ]
    for code in CODES:
        arm = build_arm(code)
        sections.append(
            f"## {code}: joints\n\n" + _table(("joint", "quantity", "value", "unit", "source"), _joint_rows(arm))
        )
        sections.append(
            f"## {code}: inertias\n\nComputed from the solids. The moving mass is "
            f"{significant([sum(body.mass for body in arm.bodies)])} kg.\n\n"
            + _table(("link", "quantity", "value", "unit"), _inertia_rows(arm))
        )
    return "\n\n".join(sections)


def with_tables(readme: str) -> str:
    """The text of urdf/README.md with fresh tables between its marks.

    Raises:
        InputError: the text lacks the marks `BEGIN` and `END`, in this order.
    """
    head, begin, rest = readme.partition(BEGIN)
    _, end, tail = rest.partition(END)
    if not (begin and end):
        raise InputError(f"README.md lacks a mark, wanted {BEGIN!r} and then {END!r}: put both where the tables belong")
    return f"{head}{BEGIN}\n\n{readme_tables()}\n\n{END}{tail}"


def write_all(directory: Path) -> tuple[Path, ...]:
    """Writes the bundled files, and the tables in the directory's README.md if there is one; each file whole or not.

    Returns:
        The files written.

    Raises:
        InputError: see `with_tables`.
        OSError: a file cannot be written.
    """
    texts = {directory / f"{code.lower()}.urdf": build_urdf(code) for code in CODES}
    readme = directory / "README.md"
    if readme.exists():
        texts[readme] = with_tables(readme.read_text(encoding="utf-8"))
    for path, text in texts.items():
        fresh = path.with_name(path.name + ".new")
        fresh.write_text(text, encoding="utf-8", newline="\n")
        fresh.replace(path)
    return tuple(texts)


def _table(head: Row, rows: Iterable[Row]) -> str:
    lines = (head, ("---",) * len(head), *rows)
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _nonzero(prefix: str, letters: Iterable[str], values: Triple, unit: str) -> Iterator[Row]:
    return ((prefix + letter, decimals([value]), unit) for letter, value in zip(letters, values, strict=True) if value)


def _units(module: Module) -> tuple[str, str, str]:
    """Of the coordinate, the rate and the effort."""
    return ("rad", "rad/s", "N m") if module.type == "revolute" else ("m", "m/s", "N")


def _material_rows() -> Iterator[Row]:
    return ((material.name, decimals([material.density]), material.note) for material in MATERIALS)


def _module_rows() -> Iterator[Row]:
    yield from (("base", *row, "height of the base") for row in _nonzero("exit ", "xyz", BASE_EXIT, "m"))
    for module in MODULES.values():
        coordinate, rate, effort = _units(module)
        yield (module.key, "axis", decimals(module.axis), "", "the rule for codes")
        for row in (*_nonzero("entry ", "xyz", module.entry, "m"), *_nonzero("exit ", "xyz", module.exit, "m")):
            yield (module.key, *row, "size of the solids")
        yield (module.key, "lower", decimals([module.lower]), coordinate, module.range_note)
        yield (module.key, "upper", decimals([module.upper]), coordinate, module.range_note)
        yield (module.key, "velocity", decimals([module.velocity]), rate, "usual for a drive of this size")
        yield (module.key, "effort", decimals([module.effort]), effort, module.effort_note)
    yield from (("tool", *row, "length of the gripper") for row in _nonzero("entry ", "xyz", TOOL_ENTRY, "m"))


def _solid_rows() -> Iterator[Row]:
    halves: list[tuple[str, str, tuple[Part, ...]]] = [("base", "base", BASE)]
    for module in MODULES.values():
        halves += [(module.key, "link before", module.stator), (module.key, "link behind", module.mover)]
    halves += [("tool", "last link", TOOL)]
    for key, side, parts in halves:
        for part in parts:
            for row in _part_rows(part):
                yield (key, side, f"{part.name}: {type(part.solid).__name__.lower()}, {part.material.name}", *row)


def _part_rows(part: Part) -> Iterator[Row]:
    mass = significant([part.body().mass])
    for name, value in vars(part.solid).items():
        if isinstance(value, tuple):
            yield from ((*row, mass) for row in _nonzero(f"{name} ", "xyz", value, "m"))
        else:
            yield (name, decimals([value]), "m", mass)
    yield from ((*row, mass) for row in _nonzero("centre ", "xyz", part.xyz, "m"))
    yield from ((*row, mass) for row in _nonzero("", ("roll", "pitch", "yaw"), part.rpy, "rad"))


def _joint_rows(arm: Arm) -> Iterator[Row]:
    names = ("base", *(module.key for module in arm.modules), "tool")
    modules = (*arm.modules, None)
    for joint, origin, (below, above), module in zip(
        (*arm.joint_names, "tool_joint"), arm.origins, pairwise(names), modules, strict=True
    ):
        ours = f"ours: exit of {below} + entry of {above}"
        for letter, value in zip("xyz", origin, strict=True):
            paper = PAPER.get((joint, letter), "") if arm.code == "RTTRR" else ""
            yield (joint, f"origin {letter}", decimals([value]), "m", f"{paper}; value {ours}" if paper else ours)
        parallel = "(9)-(15): frames parallel at q = 0" if arm.code == "RTTRR" else "ours: frames parallel at q = 0"
        yield (joint, "origin roll, pitch, yaw", "0 0 0", "rad", parallel)
        if module:
            paper = PAPER.get((joint, "axis"), "") if arm.code == "RTTRR" else ""
            yield (joint, f"axis ({module.type})", decimals(module.axis), "", paper or "ours: the rule for codes")
            coordinate, rate, effort = _units(module)
            for key, unit in (("lower", coordinate), ("upper", coordinate), ("velocity", rate), ("effort", effort)):
                yield (joint, key, decimals([getattr(module, key)]), unit, f"ours: module {module.key}")


def _inertia_rows(arm: Arm) -> Iterator[Row]:
    for name, body in zip(arm.link_names[1:-1], arm.bodies, strict=True):
        yield (name, "mass", significant([body.mass]), "kg")
        yield from ((name, f"com {'xyz'[i]}", significant([body.com[i]]), "m") for i in range(3))
        for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
            yield (name, f"i{'xyz'[i]}{'xyz'[j]}", significant([body.inertia[i, j]]), "kg m^2")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Writes the bundled files and the tables of README.md.")
    parser.add_argument("directory", type=Path, help="where to write, such as urdf")
    for written in write_all(parser.parse_args().directory):
        print(written)
