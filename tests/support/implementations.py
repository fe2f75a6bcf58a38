"""Implementations for tests: a right one with some numbers changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rttrr_pin import Robot
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.implementations import Batch, Evaluation, Implementation, make_implementation

Spoil = Callable[[dict[str, Any], Batch], None]


class Altered:
    """Another implementation whose values are changed in place after each evaluation."""

    version = ""

    def __init__(self, base: Implementation, spoil: Spoil, name: str = "altered") -> None:
        self.base, self.spoil, self.name = base, spoil, name
        self.quantities = base.quantities
        self.calls: list[int] = []

    def evaluate(self, batch: Batch) -> Evaluation:
        result = self.base.evaluate(batch)
        values = {key: x.copy() for key, x in result.values.items()}
        self.calls.append(len(batch))
        self.spoil(values, batch)
        return Evaluation(values, result.allowance, result.tau_joint)


def still(q: Any, v: Any, a: Any) -> Any:
    """A program that gives zeros."""
    return 0.0 * a


def altered(robot: Robot | Model, spoil: Spoil, base: str = "pinocchio", name: str = "altered") -> Altered:
    """An implementation of that name, with its values changed."""
    model = robot.model if isinstance(robot, Robot) else robot
    return Altered(make_implementation(base, model), spoil, name)


def evaluated(name: str, model: Model, q: Any, v: Any, a: Any, loads: tuple[Load, ...] | list[Load] = ()) -> Evaluation:
    """What an implementation makes of some states."""
    return make_implementation(name, model).evaluate(Batch(model, q, v, a, tuple(loads)))


def error(evaluation: Evaluation, other: Evaluation, key: str) -> Any:
    """The norms of the differences of one quantity."""
    difference = evaluation.values[key] - other.values[key]
    return np.abs(difference) if key == "tau" else np.linalg.norm(difference, axis=-1)


class Wrong(Altered):
    """Pinocchio with n of link 3 off by 1 N m, for the registry of names."""

    def __init__(self, model: Model) -> None:
        super().__init__(make_implementation("pinocchio", model), _n_of_link_3, "wrong")


def _n_of_link_3(values: dict[str, Any], batch: Batch) -> None:
    values["n"][:, 2] += 1.0


class Double(Altered):
    """Pinocchio with twice the tau, for the registry of names."""

    def __init__(self, model: Model) -> None:
        super().__init__(make_implementation("pinocchio", model), _twice_tau, "double")


def _twice_tau(values: dict[str, Any], batch: Batch) -> None:
    values["tau"] *= 2.0
