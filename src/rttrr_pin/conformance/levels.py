"""Levels: what a program must get right, from gravity alone to sixty joints, each with the states that ask for it.

All numbers of states are doubles that float32 holds too, so that a program in single precision is asked the same; only
quaternions are not, which would lose their length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from rttrr_pin.conformance.robots import level_robot
from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import JointEffects
from rttrr_pin.core.joints import FIXED, FLOATING, PRISMATIC
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load, RandomPayload
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.robot import Robot
from rttrr_pin.validation.sampling import Ranges, Sampler
from rttrr_pin.validation.states import model_of

if TYPE_CHECKING:
    from rttrr_pin.exact.enclosures import Enclosures

MOST = 10**6
"""States of a level."""

FAST, SLIDE = 300.0, 10.0
"""Largest rate of the level `fast`, of angles [rad/s] and of slides [m/s]."""

SMALL = 1e-7
"""Largest diagonal entry of a tensor that counts as small [kg m^2]."""

MANY = 60
"""Joints of the last level."""

States = Callable[[Model, int, int], Batch]
"""From a model, a number of states and a seed to the states; state k depends on the seed and on k alone."""


@dataclass(frozen=True, slots=True, eq=False)
class Level:
    """What a program is asked.

    Attributes:
        id: its name, one word.
        sentence: what it asks.
        robots: names of the robots that it is asked with (`level_robot`).
        applies: whether a robot of the user's own can be asked it.
        states: the states that ask it, payloads included.
    """

    id: str
    sentence: str
    robots: tuple[str, ...]
    applies: Callable[[Model], bool]
    states: States

    @property
    def number(self) -> int:
        """Its place among the levels, from 1."""
        return LEVELS.index(self) + 1


@dataclass(frozen=True, slots=True, eq=False)
class Case:
    """One level, asked with one robot.

    Attributes:
        level: what is asked.
        name: of the robot, which is that of the set where it is one of it.
        robot: the robot, base and joint effects included.
        batch: the states.
    """

    level: Level
    name: str
    robot: Robot
    batch: Batch

    @property
    def id(self) -> str:
        """Of both, such as `gravity-arm6`."""
        return f"{self.level.id}-{self.name}"


@dataclass(frozen=True, slots=True, eq=False)
class ProvenCase(Case):
    """A case with the true values of its states.

    Attributes:
        enclosures: two doubles that each true value lies between.
    """

    enclosures: Enclosures


def cases(
    robots: Sequence[Robot] | None = None, levels: Sequence[str] | None = None, n_states: int = 32, seed: int = 0
) -> list[Case]:
    """The cases of a run, level by level.

    Args:
        robots: own robots, each asked with the levels that apply to it; None for the robots of the levels.
        levels: ids of those that are wanted; None for all.
        n_states: how many states each case has.
        seed: of the states.

    Raises:
        UnknownNameError: there is no such level.
        InputError: an argument cannot be used, or no level applies.
    """
    n_states = whole_number("n_states", n_states, 1, MOST, "10^6", "-n")
    seed = whole_number("seed", seed, 0, 2**128 - 1, "2^128 - 1", "--seed")
    chosen = [level for level in LEVELS if levels is None or level.id in levels]
    for own in levels or ():
        if own not in {level.id for level in LEVELS}:
            raise UnknownNameError("level", own, [level.id for level in LEVELS])
    if robots is None:
        asked = [(level, name, level_robot(name)) for level in chosen for name in level.robots]
    else:
        models = [model_of(robot, "there is nothing to ask") for robot in robots]
        asked = [
            (level, model.name, robot)
            for level in chosen
            for robot, model in zip(robots, models, strict=True)
            if level.applies(model)
        ]
    if not asked:
        raise InputError(f"no level applies to {', '.join(repr(own.name) for own in robots or ())}: choose others")
    return [Case(level, name, robot, level.states(robot.model, n_states, seed)) for level, name, robot in asked]


def _single(batch: Batch) -> Batch:
    """The states nearest to these whose numbers float32 holds; quaternions stay."""
    q, v, a = (_rounded(x) for x in (batch.q, batch.v, batch.a))
    for at in batch.model.quaternions:
        q[:, at : at + 4] = batch.q[:, at : at + 4]
    loads = tuple(Load(own.link, _rounded(own.f), _rounded(own.n), own.in_base) for own in batch.loads)
    return Batch(batch.model, q, v, a, loads)


def _rounded(x: Array) -> Array:
    return x.astype(np.float32).astype(np.float64)


def _drawn(model: Model, count: int, seed: int, payload: RandomPayload | None = None) -> Batch:
    return Sampler(model, "uniform", seed, payload).draw(0, count)


def _gravity(model: Model, count: int, seed: int) -> Batch:
    """At rest."""
    drawn = _drawn(model, count, seed)
    return _single(replace(drawn, v=np.zeros_like(drawn.v), a=np.zeros_like(drawn.a)))


def _rates(model: Model, count: int, seed: int) -> Batch:
    """Without accelerations."""
    drawn = _drawn(model, count, seed)
    return _single(replace(drawn, a=np.zeros_like(drawn.a)))


def _all(model: Model, count: int, seed: int) -> Batch:
    """Coordinates, rates and accelerations."""
    return _single(_drawn(model, count, seed))


def _payload(model: Model, count: int, seed: int) -> Batch:
    """All, and a wrench at the last of the links that carry no other."""
    return _single(_drawn(model, count, seed, RandomPayload(link=model.links[model.leaves()[-1]].name)))


def _fast(model: Model, count: int, seed: int) -> Batch:
    """All, at rates of up to `FAST` and `SLIDE`."""
    drawn = _drawn(model, count, seed)
    return _single(replace(drawn, v=drawn.v / Ranges.of(model).rate * np.where(model.rotations, FAST, SLIDE)))


def _cancelling(model: Model, count: int, seed: int) -> Batch:
    """Accelerations at which all terms of each driving force add up to nearly nothing: M a = -h, to seven digits."""
    drawn = _single(_drawn(model, count, seed))
    nv = model.nv
    h = _tau(model, drawn.q, drawn.v, np.zeros_like(drawn.a))
    q = np.repeat(drawn.q, nv, axis=0)
    units = np.tile(np.eye(nv), (count, 1))
    M = _tau(model.with_gravity(np.zeros(3)), q, np.zeros_like(units), units).reshape(count, nv, nv)
    a = np.stack([np.linalg.lstsq(own.T, -right, rcond=None)[0] for own, right in zip(M, h, strict=True)])
    return _single(replace(drawn, a=a))


def _tau(model: Model, q: Array, v: Array, a: Array) -> Array:
    return Batch(model, q, v, a).recursion[0].tau


def _moves(model: Model) -> bool:
    return model.nv > 0


def _branches(model: Model) -> bool:
    parents = [joint.parent for joint in model.joints]
    return len(set(parents)) < len(parents)


def _is_small(model: Model) -> bool:
    largest = [float(np.abs(link.inertia).max()) for link in model.links if link.mass]
    return bool(largest) and max(largest) < SMALL


LEVELS = (
    Level("gravity", "Gravity alone, at rest.", ("arm6",), _moves, _gravity),
    Level("rates", "Rates: centrifugal, Coriolis and gyroscopic terms.", ("arm6",), _moves, _rates),
    Level("accelerations", "Accelerations too.", ("arm6",), _moves, _all),
    Level("payload", "A payload at the last link.", ("arm6",), lambda model: bool(model.links), _payload),
    Level(
        "prismatic",
        "Joints that slide.",
        ("rttrr",),
        lambda model: any(joint.type == PRISMATIC for joint in model.joints),
        _all,
    ),
    Level("tree", "Links that carry several others, and continuous joints.", ("tree",), _branches, _all),
    Level(
        "fixed",
        "Bodies on fixed joints, and what these joints carry.",
        ("fixed",),
        lambda model: model.nv > 0 and any(joint.type == FIXED for joint in model.joints),
        _all,
    ),
    Level(
        "mimic",
        "Joints that follow others.",
        ("mimic",),
        lambda model: any(joint.mimic is not None for joint in model.joints),
        _all,
    ),
    Level(
        "floating",
        "A floating base: the root's own inertia, and the wrench that drives it.",
        ("floating",),
        lambda model: any(joint.type == FLOATING for joint in model.joints),
        _all,
    ),
    Level(
        "effects",
        "Armature, damping and friction of joints.",
        ("effects",),
        lambda model: any(joint.effects != JointEffects() for joint in model.joints),
        _all,
    ),
    Level("fast", f"Rates of {FAST:.0f} rad/s and {SLIDE:.0f} m/s.", ("arm6", "rttrr"), _moves, _fast),
    Level(
        "cancelling",
        "Large terms that add up to nearly nothing in each driving force.",
        ("arm6", "rttrr"),
        _moves,
        _cancelling,
    ),
    Level("small", "Tensors of 1e-8 kg m^2.", ("small",), lambda model: _moves(model) and _is_small(model), _all),
    Level("sixty", "Sixty joints.", ("sixty",), lambda model: len(model.moving) >= MANY, _all),
)
"""All of them; each stands on those before it."""
