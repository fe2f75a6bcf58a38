"""Modules stood on one another: the letters of an arm in, its joints' origins and its links' parts out."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

from rttrr_pin.core.solids import Part, RigidBody, Triple, combine
from rttrr_pin.errors import InputError
from rttrr_pin.modular_arm.modules import BASE, BASE_EXIT, MODULES, TOOL, TOOL_ENTRY, Module


@dataclass(frozen=True)
class Arm:
    """An arm of modules.

    Attributes:
        code: its letters, from the base to the tool.
        modules: the module of each joint.
        origins: the origin of each joint, and of the tool joint at the end, in the frame of the link before [m].
        links: the parts of the base and of each link behind a joint, in that link's frame.
    """

    code: str
    modules: tuple[Module, ...]
    origins: tuple[Triple, ...]
    links: tuple[tuple[Part, ...], ...]

    @property
    def bodies(self) -> tuple[RigidBody, ...]:
        """Mass, centre of mass and inertia of each moving link, in its frame."""
        return tuple(combine(part.body() for part in parts) for parts in self.links[1:])

    @property
    def joint_names(self) -> tuple[str, ...]:
        """Of the moving joints, from the base."""
        return tuple(f"joint_{k}" for k in range(1, len(self.modules) + 1))

    @property
    def link_names(self) -> tuple[str, ...]:
        """From the base to the tool, which is a frame and has no parts."""
        return ("base", *(f"link_{k}" for k in range(1, len(self.modules) + 1)), "tool")


def modules_of(code: str) -> tuple[Module, ...]:
    """The modules that the letters stand for, by the table in the docstring of `rttrr_pin.modular_arm`.

    Args:
        code: at least one letter, each R (revolute) or T (prismatic), from the base to the tool.

    Raises:
        InputError: the code is no text, empty, or has other letters.
    """
    if not isinstance(code, str) or not re.fullmatch("[RT]+", code):
        raise InputError(
            f"the arm's code is {code!r}, wanted one letter per joint, R (revolute) or T (prismatic), in capitals and "
            f"at least one: write it like 'RTTRR'"
        )
    first_of_wrist = max(1, len(code.rstrip("R")), len(code) - 2)
    keys = []
    for k, letter in enumerate(code):
        before = code[:k]
        count = before.count("T") if letter == "T" else len(before) - len(before.rstrip("R"))
        keys.append(f"{'wrist ' if k >= first_of_wrist else ''}{letter}{'zy'[count % 2]}")
    return tuple(MODULES[key] for key in keys)


def build_arm(code: str) -> Arm:
    """Stands the modules of a code on one another.

    Args:
        code: as in `modules_of`.

    Raises:
        InputError: see `modules_of`.
    """
    modules = modules_of(code)
    exits = (BASE_EXIT, *(module.exit for module in modules))
    entries = (*(module.entry for module in modules), TOOL_ENTRY)
    origins = tuple(_sum(port, entry) for port, entry in zip(exits, entries, strict=True))
    owners = ("base", *(f"joint_{k}" for k in range(1, len(modules) + 1)), "tool")
    movers = (BASE, *(module.mover for module in modules))
    stators = (*(module.stator for module in modules), TOOL)
    links = tuple(
        (*_named(mover, owner, (0.0, 0.0, 0.0)), *_named(stator, next_owner, origin))
        for mover, stator, origin, (owner, next_owner) in zip(movers, stators, origins, pairwise(owners), strict=True)
    )
    return Arm(code, modules, origins, links)


def _sum(a: Triple, b: Triple) -> Triple:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _named(parts: tuple[Part, ...], owner: str, origin: Triple) -> Iterator[Part]:
    return (replace(part, name=f"{owner}_{part.name}", xyz=_sum(origin, part.xyz)) for part in parts)
