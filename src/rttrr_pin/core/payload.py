"""Payloads: what the robot exerts on its surroundings, of a batch and as scalars."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arguments import not_negative
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.scalars import Arithmetic, columns
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.errors import InputError


@dataclass(frozen=True, slots=True)
class Load:
    """A payload of a batch: what the robot exerts on its surroundings at one link.

    Attributes:
        link: index of the link.
        f: force, (3,) or (N, 3) [N].
        n: moment about the origin of the link's frame, (3,) or (N, 3) [N m].
        in_base: whether both are in base axes; else in the link's.
    """

    link: int
    f: Array
    n: Array
    in_base: bool = False

    def block(self, part: slice | NDArray[np.int64]) -> Load:
        """The same for some states of the batch."""
        f, n = (x if x.ndim == 1 else x[part] for x in (self.f, self.n))
        return Load(self.link, f, n, self.in_base)


def same_loads(own: Sequence[Load], other: Sequence[Load]) -> bool:
    """Whether payloads are the same, bit by bit and in the same order."""
    return len(own) == len(other) and all(
        (x.link, x.in_base) == (y.link, y.in_base) and np.array_equal(x.f, y.f) and np.array_equal(x.n, y.n)
        for x, y in zip(own, other, strict=True)
    )


Payloads: TypeAlias = Wrench | Load | Sequence[Wrench | Load] | None
"""What is passed as payload: none, one or several, with the link's name or its index."""


def loads_of(model: Model, payload: Payloads) -> tuple[Load, ...]:
    """Payloads at the indices of their links.

    Raises:
        InputError: it is no wrench, or names no link where there are several last ones.
        UnknownNameError: no link is called so.
    """
    if payload is None:
        return ()
    if isinstance(payload, Sequence):
        return tuple(load_of(model, own) for own in payload)
    return (load_of(model, payload),)


def load_of(model: Model, payload: Wrench | Load) -> Load:
    """One of `loads_of`."""
    if isinstance(payload, Load):
        return payload
    if not isinstance(payload, Wrench):
        raise InputError(
            f"payload is a {type(payload).__name__}, expected a Wrench: pass Wrench(force=..., moment=...)"
        )
    f, n = np.asarray(payload.force, np.float64), np.asarray(payload.moment, np.float64)
    return Load(payload_link(model, payload.link), f, n, payload.expressed_in == "base")


def payload_link(model: Model, name: str | None) -> int:
    """The index of the link that a payload acts at; for None the only last link.

    Raises:
        UnknownNameError: no link is called so.
        InputError: there is no name, and not exactly one last link.
    """
    if name is not None:
        return model.link_index(name)
    leaves = model.leaves()
    if len(leaves) == 1:
        return leaves[0]
    names = ", ".join(model.link_names[i] for i in leaves) or "none"
    raise InputError(
        f"no link is named, and robot {model.name!r} has {len(leaves)} last links ({names}): pass link=NAME",
        options={"link=NAME": "--payload-link NAME"},
    )


@dataclass(frozen=True, slots=True)
class RandomPayload:
    """A payload that is drawn anew for each state, uniformly between minus and plus these bounds along each axis.

    Attributes:
        link: the link that it acts at; None: the tool, that is the robot's only last link.
        force: half range of each component of the force [N].
        moment: half range of each component of the moment about the origin of the link's frame [N m].
    """

    link: str | None = None
    force: float = 50.0
    moment: float = 10.0

    def __post_init__(self) -> None:
        for name in ("force", "moment"):
            object.__setattr__(self, name, not_negative(f"{name} of RandomPayload", getattr(self, name), name))


def payloads_of(loads: Sequence[Load], arithmetic: Arithmetic) -> list[Payload]:
    """The payloads of a batch in scalars."""
    return [
        Payload(load.link, _vector(load.f, arithmetic), _vector(load.n, arithmetic), load.in_base) for load in loads
    ]


def _vector(x: Array, arithmetic: Arithmetic) -> Vector:
    """(3,) or (N, 3) as a vector of scalars."""
    return Vector(*(arithmetic.column(column) for column in columns(np.atleast_2d(x))))
