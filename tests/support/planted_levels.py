"""Programs of any robot with one fault each, on the recursion of the core: what a level must see."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from rttrr_pin.core.joints import FIXED
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.diagnosis.catalogue.mechanics import mechanics
from rttrr_pin.diagnosis.variants.variant import Variant
from rttrr_pin.implementations import Batch, Evaluation

Spoil = Callable[[Batch], Batch]


def program(spoil: Spoil, name: str = "planted", quantities: tuple[str, ...] = QUANTITIES) -> Any:
    """A class of programs that take other states, or another model, than they are given."""

    class Planted:
        version = ""

        def __init__(self, model: Model) -> None:
            self.name, self.quantities = name, quantities

        def evaluate(self, batch: Batch) -> Evaluation:
            values = spoil(batch).recursion[0]
            return Evaluation({key: getattr(values, key) for key in quantities})

    return Planted


def with_model(change: Callable[[Model], Model]) -> Spoil:
    return lambda batch: replace(batch, model=change(batch.model))


def without_mass(links: Callable[[Model, int], bool]) -> Spoil:
    """Links that have neither mass nor tensor."""

    def change(model: Model) -> Model:
        own = [Link(link.name) if links(model, i) else link for i, link in enumerate(model.links)]
        return replace(model, links=tuple(own), document=None)

    return with_model(change)


def without_mimic(model: Model) -> Model:
    joints = [x if x.mimic is None else replace(x, mimic=replace(x.mimic, multiplier=0.0)) for x in model.joints]
    return replace(model, joints=tuple(joints), document=None)


def with_tensors_of_zero(model: Model) -> Model:
    """As programs do that take 1e-7 kg m^2 for nothing."""
    own = [x if np.abs(x.inertia).max() > 1e-7 else replace(x, inertia=np.zeros((3, 3))) for x in model.links]
    return replace(model, links=tuple(own), document=None)


def opposite(load: Load) -> Load:
    return Load(load.link, -load.f, -load.n, load.in_base)


class Gyroscopic:
    """The recursion without w x I w."""

    version, name, quantities = "", "gyroscopic", QUANTITIES

    def __init__(self, model: Model) -> None:
        found = [own for own in mechanics(model) if own.id == "outwards: drop w.cross(body.I @ w)"]
        self.variant = Variant(model)
        for own in found:
            self.variant = own.apply(self.variant, ())

    def evaluate(self, batch: Batch) -> Evaluation:
        return Evaluation(self.variant.evaluate(batch))


def last_link(model: Model, i: int) -> bool:
    return i == max(k for k, link in enumerate(model.links) if link.mass)


PLANTED: dict[str, tuple[Any, str, set[str] | None]] = {
    "a mass dropped": (program(without_mass(last_link)), "gravity", None),
    "no rates": (program(lambda batch: replace(batch, v=0.0 * batch.v)), "rates", None),
    "no gyroscopic term": (Gyroscopic, "rates", None),
    "no accelerations": (program(lambda batch: replace(batch, a=0.0 * batch.a)), "accelerations", None),
    "sign of the payload": (
        program(lambda batch: replace(batch, loads=tuple(map(opposite, batch.loads)))),
        "payload",
        {"payload"},
    ),
    "fixed links without mass": (
        program(without_mass(lambda model, i: model.joints[i].type == FIXED)),
        "fixed",
        {"fixed"},
    ),
    "mimic ignored": (program(with_model(without_mimic)), "mimic", {"mimic"}),
    "friction ignored": (program(with_model(Model.without_friction)), "effects", {"effects"}),
    "armature ignored": (program(with_model(Model.without_joint_effects)), "effects", {"effects"}),
    "root without mass": (
        program(without_mass(lambda model, i: model.floating and i == 0)),
        "floating",
        {"floating"},
    ),
    "small tensors are zero": (program(with_model(with_tensors_of_zero)), "small", {"small"}),
}
"""By fault the program, the first level that sees it, and all levels where it is those alone."""
