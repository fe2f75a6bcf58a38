"""Loads on each link in the states that matter, as boundary conditions of a finite element model."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator

import numpy as np

from rttrr_pin.core.arrays import Array, product
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.placements import in_base, on_parents
from rttrr_pin.loads.evaluation import Values
from rttrr_pin.loads.results import NamedState

HEADER = (
    *("state", "peak of", "row", "time [s]", "link", "load", "of"),
    *(f"{name}_{axis} [{unit}]" for name, unit in (("at", "m"), ("force", "N"), ("moment", "N m")) for axis in "xyz"),
)
"""Axes are those of the link; the moment is about the point at which it acts."""

Row = tuple[str, str, str, Array, Array, Array]
"""Link, kind of load, what exerts it; where, force, moment."""


def load_cases(model: Model, states: tuple[NamedState, ...], values: Values) -> str:
    """A CSV table: all that acts on each link, in its own axes; what acts on one link in one state adds up to zero.

    By d'Alembert's principle gravity and inertia act as -F at the centre of mass, with the moment -N; the root link
    has only what its joints exert on it.

    Args:
        model: the robot.
        states: those that matter.
        values: F, N, f, n there, (states, links, 3).
    """
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(HEADER)
    q = np.array([state.q for state in states]).reshape(len(states), model.nq)
    R, p = on_parents(model, q)
    R_0 = in_base(model, q)[0]
    for k, state in enumerate(states):
        own = {name: values[name][k] for name in ("F", "N", "f", "n")}
        for link, kind, of, at, force, moment in _acting(model, own, R[k], p[k], R_0[k], state.payload):
            numbers = [float(x) + 0.0 for vector in (at, force, moment) for x in vector]  # no zero has a minus
            table.writerow([k, state.name, state.row, state.time, link, kind, of, *numbers])
    return text.getvalue()


def _acting(model: Model, own: Values, R: Array, p: Array, R_0: Array, payload: tuple[Load, ...]) -> Iterator[Row]:
    """What acts on each link, the root first."""
    for i, link in enumerate((model.root, *model.links), start=-1):
        if i >= 0:
            yield link.name, "joint that carries it", model.joints[i].name, np.zeros(3), own["f"][i], own["n"][i]
            yield link.name, "gravity and inertia", "itself", link.com, -own["F"][i], -own["N"][i]
        for c, joint in enumerate(model.joints):
            if joint.parent == i:
                force, moment = -product(R[c], own["f"][c]), -product(R[c], own["n"][c])
                yield link.name, "joint that it carries", joint.name, p[c], force, moment
        for load in payload:
            if load.link == i:
                turned = R_0[i].T if load.in_base else np.eye(3)
                force, moment = -product(turned, load.f), -product(turned, load.n)
                yield link.name, "payload", "surroundings", np.zeros(3), force, moment
