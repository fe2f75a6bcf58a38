"""A suite of tests as data: at which states, to which tolerance, a program is compared with right results."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from rttrr_pin.conformance.levels import LEVELS, MOST
from rttrr_pin.conformance.mutation.mutants import Mutants, results
from rttrr_pin.core.arguments import names_of, not_negative, whole_number
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.diagnosis.engine.evidence import flat, joined, loaded, shape_of_loads, spread
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.implementations import Batch, default_allowance
from rttrr_pin.validation.sampling import Ranges

LEVEL_OF = {
    "gravity": "gravity",
    "rates": "rates",
    "random": "accelerations",
    "payload": "payload",
    "fast": "fast",
    "cancelling": "cancelling",
}
"""Kinds of states that are those of a level."""

KINDS = (*LEVEL_OF, "units")
"""Kinds of states."""


@dataclass(frozen=True, slots=True)
class Tolerances:
    """A suite of tests as data: |result - right one| <= atol + rtol |right one|, number by number.

    Attributes:
        states: kinds of states, some of `KINDS`: "gravity" at rest, "rates" without accelerations, "random" all of q,
            v and a, "payload" with a wrench at the last link, "fast" at 300 rad/s, "cancelling" where all terms of a
            driving force add up to nearly nothing, "units" at rest with one acceleration of 1 after the other, as tests
            of the mass matrix have.
        n_states: how many of each kind; of "units" so many poses.
        atol: absolute tolerance [N or N m]; None for the rounding tolerance of `validate`, whatever `rtol` is.
        rtol: relative tolerance.
        quantities: what is compared, of tau, F, N, f, n.
        rates: the largest rate [rad/s or m/s]; None for the limits of the robot.
        seed: of the states.
    """

    states: tuple[str, ...] = ("random",)
    n_states: int = 10
    atol: float | None = 1e-6
    rtol: float = 0.0
    quantities: tuple[str, ...] = ("tau",)
    rates: float | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        """Check what was passed.

        Raises:
            InputError: a number cannot be used.
            UnknownNameError: there is no such kind of states or quantity.
        """
        for argument, known in (("states", KINDS), ("quantities", QUANTITIES)):
            own = names_of(argument, getattr(self, argument))
            object.__setattr__(self, argument, own)
            if not own:
                raise InputError(f"{argument} is empty: name at least one of {', '.join(known)}")
            for name in own:
                if name not in known:
                    raise UnknownNameError("kind of states" if argument == "states" else "quantity", name, known)
        whole_number("n_states", self.n_states, 1, MOST, "10^6", "-n")
        whole_number("seed", self.seed, 0, 2**128 - 1, "2^128 - 1", "--seed")
        for argument in ("atol", "rtol", "rates"):
            if getattr(self, argument) is not None:
                not_negative(argument, getattr(self, argument))

    @property
    def payload(self) -> bool:
        """Whether some of the states have one."""
        return "payload" in self.states

    @property
    def sentence(self) -> str:
        """What is compared."""
        states = ", ".join(f"{self.n_states:,} {kind}" for kind in self.states)
        slow = "" if self.rates is None else f" at up to {self.rates:g} rad/s"
        relative = f" + {self.rtol:g} of it" if self.rtol and self.atol else f"{self.rtol:g} of it"
        tolerance = f"{self.atol:g}" if self.atol else ""
        bound = "rounding" if self.atol is None else (tolerance + (relative if self.rtol else "")) or "0"
        return f"{', '.join(self.quantities)} within {bound} at {states} states{slow}"

    def batches(self, model: Model) -> list[Batch]:
        """The states of a robot, those with a payload apart."""
        found: dict[object, list[Batch]] = {}
        for kind in dict.fromkeys(self.states):
            batch = _states(kind, model, self.n_states, self.seed)
            if self.rates is not None and kind != "gravity":
                batch = replace(batch, v=batch.v * (self.rates / Ranges.of(model).rate))
            found.setdefault(shape_of_loads(batch) if loaded(batch).any() else (), []).append(batch)
        return [joined(batches) for batches in found.values()]

    def sees(self, mutants: Mutants) -> Iterator[bool]:
        """Of each mutant whether a test would fail on it."""
        keys = self.quantities
        tried = [own.planted for own in mutants.found]
        seen = np.zeros(len(tried), dtype=bool)
        with np.errstate(all="ignore"):  # what overflows is seen
            for batch in self.batches(mutants.robot.model):
                expected = flat(dict(batch.recursion[0].items()), keys)
                allowed = self._allowed(batch, expected)
                for k, values in enumerate(results(mutants.robot.model, tried, batch)):
                    seen[k] |= not (np.abs(flat(values, keys) - expected) <= allowed).all()
        return iter(seen.tolist())

    def _allowed(self, batch: Batch, expected: Array) -> Array:
        """How far each number may be off."""
        if self.atol is None:
            return 2.0 * spread(default_allowance(batch), self.quantities)
        return self.atol + self.rtol * np.abs(expected)


def _states(kind: str, model: Model, count: int, seed: int) -> Batch:
    """Those of a level, or unit accelerations."""
    levels = {level.id: level for level in LEVELS}
    if kind != "units":
        return levels[LEVEL_OF[kind]].states(model, count, seed)
    rest = levels["gravity"].states(model, count, seed)
    still = np.zeros((count * model.nv, model.nv))
    return Batch(model, np.repeat(rest.q, model.nv, axis=0), still, np.tile(np.eye(model.nv), (count, 1)))
