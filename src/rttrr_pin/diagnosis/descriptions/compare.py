"""Compare two descriptions of one robot, in numbers and in torques."""

from __future__ import annotations

import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from rttrr_pin.core.arguments import whole_number
from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.descriptions.difference import Difference
from rttrr_pin.diagnosis.descriptions.effects_of import (
    Effect,
    Torques,
    all_together,
    effect,
    effect_of,
    first_torques,
    torques_and_bound,
)
from rttrr_pin.diagnosis.descriptions.matched import Matched, matched, notes_of
from rttrr_pin.diagnosis.descriptions.reasons import reasons
from rttrr_pin.diagnosis.engine.evidence import rms
from rttrr_pin.errors import InputError, listed
from rttrr_pin.loading import load
from rttrr_pin.reporting.results import Summarised, finite
from rttrr_pin.robot import Robot
from rttrr_pin.urdf.sources import AnySource
from rttrr_pin.validation.states import Progress

MOST_STATES = 100_000
"""All of them are in memory at once."""

REMAINDER = 1000.0
"""Times the running error bound: what is left, all differences together, is rounding up to there."""


@dataclass(frozen=True, slots=True)
class JointTorque:
    """Torques of one degree of freedom over all states [N m or N].

    Attributes:
        rms: of the first robot.
        change: rms of second less first, all differences together.
        largest: its largest size.
        remainder: rms of what no difference that is listed explains; 0 where that is rounding.
    """

    rms: float
    change: float
    largest: float
    remainder: float


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Comparison(Summarised):
    """How two descriptions of a robot differ.

    Attributes:
        robots: their names.
        pairs: names of joints that move, first and second, in the order of the first.
        only_a: joints that only the first can move; they stand still at 0 here.
        only_b: likewise, of the second.
        effects: differences beyond rounding, each alone applied to the first robot: those that change a torque, the
            largest share first, then those that change none.
        rounding: those that printed digits explain, the largest first; they are one note, and not in `effects`.
        rounding_effect: what they change together; None where there are none.
        joints: torques by degree of freedom, as the first names them.
        reasons: why links differ, where one description is what a known slip makes of the other.
        notes: names, order, directions, frames, merged links.
        n_states: how many states.
        seed: of the generator.
        seconds: wall time.
    """

    robots: tuple[str, str]
    pairs: tuple[tuple[str, str], ...]
    only_a: tuple[str, ...]
    only_b: tuple[str, ...]
    effects: tuple[Effect, ...]
    rounding: tuple[Difference, ...]
    rounding_effect: Effect | None
    joints: Mapping[str, JointTorque]
    reasons: tuple[str, ...]
    notes: tuple[str, ...]
    n_states: int
    seed: int
    seconds: float

    @property
    def mattering(self) -> tuple[Effect, ...]:
        """Differences that change a torque, the largest share of a joint's own torque first."""
        return tuple(own for own in self.effects if own.matters)

    @property
    def idle(self) -> tuple[Effect, ...]:
        """Differences that change no torque."""
        return tuple(own for own in self.effects if not own.matters)

    @property
    def remainder(self) -> dict[str, float]:
        """By degree of freedom the rms of what no difference explains [N m or N], where that is beyond rounding."""
        return {name: own.remainder for name, own in self.joints.items() if own.remainder}

    @property
    def free(self) -> tuple[Effect, ...]:
        """Joints that move by themselves in one of the two and follow another in the other."""
        return tuple(
            e for e in self.effects if e.difference.kind == "mimic" and None in (e.difference.a, e.difference.b)
        )

    @property
    def passed(self) -> bool:
        """Whether both have the same dynamics, to rounding or to the digits that were printed."""
        return not (self.only_a or self.only_b or self.mattering or self.remainder or self.free)

    def summary(self) -> str:
        """The verdict in one sentence."""
        what = f"{self.robots[0]} and {self.robots[1]}"
        idle = f", {len(self.idle)} without an effect on torques" if self.idle else ""
        if self.passed:
            printed = " to the digits printed" if self.rounding else ""
            return f"PASS {what}: the same dynamics{printed}{idle}"
        parts = []
        if self.mattering:
            first = self.mattering[0]
            number = (
                "1 difference changes torques"
                if len(self.mattering) == 1
                else (f"{len(self.mattering)} differences change torques, most of all")
            )
            parts.append(
                f"{number}: {first.difference.where}, {100 * first.worst:.3g} % of the torque of {first.joint} (rms)"
            )
        if lone := (*self.only_a, *self.only_b):
            parts.append(f"without a counterpart: {listed(lone)}")
        if self.free and not self.mattering:
            parts.append(
                f"follows another joint in one of them: {listed([str(e.difference.joint) for e in self.free])}"
            )
        if self.remainder:
            name = max(self.remainder, key=self.remainder.__getitem__)
            parts.append(f"{self.remainder[name]:.3g} of {name} (rms) is explained by none of them")
        return f"FAIL {what}: {'; '.join(parts)}{idle}"

    def to_dict(self) -> dict[str, Any]:
        """Everything as data for JSON."""
        data: dict[str, Any] = {
            "schema": 1,
            **{name: getattr(self, name) for name in ("passed", "robots", "only_a", "only_b", "reasons", "notes")},
            "pairs": [list(pair) for pair in self.pairs],
            "differences": [own.to_dict() for own in self.effects],
            "rounding": [own.to_dict() for own in self.rounding],
            "rounding_effect": None if self.rounding_effect is None else self.rounding_effect.to_dict()["tau"],
            "joints": {name: asdict(own) for name, own in self.joints.items()},
            "remainder": self.remainder,
            **{name: getattr(self, name) for name in ("n_states", "seed", "seconds")},
        }
        return finite(data)


def compare_robots(
    a: Robot | AnySource,
    b: Robot | AnySource,
    n_states: int = 500,
    seed: int = 0,
    progress: Progress | None = None,
) -> Comparison:
    """Say in what two descriptions of one robot differ, and which of it matters for the torques.

    Joints and links are paired by name, where that fails by their place in the tree. The second robot is put into the
    frames and coordinates of the first: frames that are elsewhere on the same axis, and coordinates that count the
    other way, are no differences, and links on fixed joints are part of what carries them. Each difference that is left
    is then applied alone to the first robot, at random states within its limits.

    Args:
        a: a robot, or what `load` takes; how a file is read (friction, gravity, ...) is up to `load`.
        b: another description of it.
        n_states: how many states, up to 100,000.
        seed: from 0 to 2^128 - 1; the same seed gives the same states.
        progress: called with the number of differences whose effect is known.

    Returns:
        The differences, sorted by effect, and what none of them explains.

    Raises:
        InputError: no joint of one is a joint of the other, or torques overflow; or what `load` raises.
    """
    start = time.perf_counter()
    count = whole_number("n_states", n_states, 1, MOST_STATES, option="--states")
    first, second = (own.model if isinstance(own, Robot) else load(own).model for own in (a, b))
    whole = whole_number("seed", seed, 0, 2**128 - 1, "2^128 - 1", "--seed")
    if not (first.nv and second.nv):
        which = first.name if not first.nv else second.name
        raise InputError(f"{which!r} has no joint that moves, so that there are no torques to compare")
    both = matched(first, second)
    if not both.pairs:
        raise InputError(
            f"no joint of {first.name!r} ({listed(first.joint_names)}) moves as one of {second.name!r} "
            f"({listed(second.joint_names)}) does: pass two descriptions of one robot"
        )
    torques = first_torques(both.a, both.other.tree, count, whole)
    effects = list[Effect]()
    for own in both.differences:
        if not own.rounding:
            effects.append(effect_of(own, both.a, torques))
            if progress is not None:
                progress(len(effects))
    effects.sort(key=lambda own: (-own.worst, not own.matters))
    printed = sorted((own for own in both.differences if own.rounding), key=lambda own: -own.relative)
    together = None
    if printed:
        change = torques.of(all_together(both.a, printed)) - torques.tau
        together = effect(replace(printed[0], change=None), change, torques)
    return Comparison(
        robots=(first.name, second.name),
        pairs=both.pairs,
        only_a=both.only_a,
        only_b=both.only_b,
        effects=tuple(effects),
        rounding=tuple(replace(own, change=None) for own in printed),
        rounding_effect=together,
        joints=_joints(both, torques),
        reasons=tuple(reasons(first, second, both.links)) if effects else (),
        notes=tuple(notes_of(both)),
        n_states=count,
        seed=whole,
        seconds=time.perf_counter() - start,
    )


def _joints(both: Matched, torques: Torques) -> dict[str, JointTorque]:
    """Torques of the first, and how those of the second, at the same motion, differ."""
    signs = {body.joint.name: sign for body, sign in zip(both.a.bodies, both.other.signs, strict=True)}
    partner = dict(both.pairs)
    motion = {
        partner[name]: (signs[name] * q, signs[name] * v, signs[name] * a) for name, (q, v, a) in torques.motion.items()
    }
    joints = [partner[name] for name in torques.joints]
    tau, bound = torques_and_bound(both.model_b, motion, joints, "second")
    bound = np.maximum(torques.bound, bound)
    own_signs = [
        signs[joint.name] for joint in both.a.model.joints if joint.name in torques.joints for _ in range(joint.nv)
    ]
    tau = tau * np.array(own_signs)
    change = tau - torques.of(both.model_a)
    left = change - (torques.of(all_together(both.a, both.differences)) - torques.tau)
    most: Array = np.abs(left).max(axis=0, initial=0.0)
    remainder = np.where(most <= REMAINDER * bound, 0.0, rms(left))
    columns = zip(torques.rms, rms(change), np.abs(change).max(axis=0, initial=0.0), remainder, strict=True)
    return {label: JointTorque(*(float(x) for x in own)) for label, own in zip(torques.labels, columns, strict=True)}
