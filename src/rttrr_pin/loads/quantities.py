"""What can be asked of a trajectory, as columns with names and units."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import prod

from rttrr_pin.core.arguments import names_of
from rttrr_pin.core.conventions import Convention
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import LINK_QUANTITIES
from rttrr_pin.errors import InputError, UnknownNameError

CROSSING = ("f", "n")
"""What crosses a joint; in another convention it is `SAID`."""

SAID = ("force", "moment")

PER_JOINT = ("tau", "power", "energy")
"""One number for each degree of freedom."""

ASKED = ("tau", *LINK_QUANTITIES, "power", "energy")
"""What `compute_loads` takes as quantities."""

ERROR = "_error"
"""What the name of half a band of 95 percent ends with, behind that of what it belongs to."""


@dataclass(frozen=True, slots=True)
class Field:
    """An array of an output.

    Attributes:
        name: of the array.
        shape: of what belongs to one row.
        columns: the names of its numbers, the last axis fastest.
        units: theirs.
        kind: of its numbers: "float", "int32", "uint32" or "string", as Parquet calls them.
    """

    name: str
    shape: tuple[int, ...]
    columns: tuple[str, ...]
    units: tuple[str, ...]
    kind: str = "float"

    @property
    def width(self) -> int:
        """How many columns it has."""
        return prod(self.shape)


TIME = Field("time", (), ("time",), ("s",))


def checked(quantities: str | Sequence[str]) -> tuple[str, ...]:
    """The quantities, in the order in which they are written.

    Raises:
        UnknownNameError: there is no such quantity.
        InputError: none is named.
    """
    names = names_of("quantities", quantities)
    for name in names:
        if name not in ASKED:
            raise UnknownNameError("quantity", name, ASKED)
    if not names:
        raise InputError(f"quantities is empty: name at least one of {', '.join(ASKED)}")
    return tuple(name for name in ASKED if name in names)


def check_convention(quantities: Sequence[str], row: Convention | None) -> None:
    """A convention is of what crosses joints.

    Raises:
        InputError: nothing of that is asked for.
    """
    if row is not None and not {*CROSSING} & {*quantities}:
        raise InputError(
            f"convention {row.name!r} says how f and n are written, and neither is asked for: add f or n",
            options={"convention": "--convention"},
        )


def written(quantities: Sequence[str], row: Convention | None) -> tuple[str, ...]:
    """The quantities by the names of their arrays: f and n are force and moment in another convention."""
    said = {} if row is None else dict(zip(CROSSING, SAID, strict=True))
    return tuple(said.get(name, name) for name in quantities)


def field(name: str, model: Model) -> Field:
    """The array of a quantity: `tau_joint_1`, ..., `n_tool_z`."""
    if name in PER_JOINT:
        columns = tuple(f"{name}_{label}" for label in model.v_names)
        return Field(name, (model.nv,), columns, UNITS[name](model))
    columns = tuple(f"{name}_{link}_{axis}" for link in model.link_names for axis in "xyz")
    return Field(name, (len(model.links), 3), columns, UNITS[name](model) * len(columns))


def with_error(own: Field) -> Field:
    """The array of the half widths of its band."""
    columns = tuple(f"{column}{ERROR}" for column in own.columns)
    return Field(own.name + ERROR, own.shape, columns, own.units)


def force_units(model: Model) -> tuple[str, ...]:
    """Of the driving force of each degree of freedom."""
    return tuple("N m" if rotation else "N" for rotation in model.rotations)


def rate_units(model: Model) -> tuple[str, ...]:
    """Of each rate."""
    return tuple("rad/s" if rotation else "m/s" for rotation in model.rotations)


UNITS: Mapping[str, Callable[[Model], tuple[str, ...]]] = {
    "tau": force_units,
    "power": lambda model: ("W",) * model.nv,
    "energy": lambda model: ("J",) * model.nv,
    **dict.fromkeys(("F", "f", "force"), lambda model: ("N",)),
    **dict.fromkeys(("N", "n", "moment"), lambda model: ("N m",)),
}
"""Of a quantity of links one unit for all its numbers."""
