"""What a residual may be due to: groups of columns, and what their fitted numbers say in words and units."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.identification import INERTIAL
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.descriptions.rigid_tree import RigidTree
from rttrr_pin.diagnosis.logs.residual import PER_LINK, Residuals

Told = Callable[[Array, Array], tuple[str, Mapping[str, Any]]]
"""From fitted numbers and their standard errors to a sentence, and to numbers by name; NaN where nothing tells one."""


@dataclass(frozen=True, slots=True, eq=False)
class Candidate:
    """One thing that would explain part of the residual.

    Attributes:
        hypothesis: what it is called, the same for each link or joint.
        link: the link it is about, if any.
        joint: the degree of freedom it is about, if any.
        directions: of its numbers in the columns of `Residuals`, (columns, numbers).
        told: its numbers in words.
    """

    hypothesis: str
    link: str | None
    joint: str | None
    directions: Array
    told: Told


def candidates(residuals: Residuals) -> list[Candidate]:
    """All of a robot: of each joint, of each link that moves by itself, of gravity, of tau."""
    model, names = residuals.model, residuals.names
    place = {name: k for k, name in enumerate(names)}

    def at(*wanted: str) -> Array:
        directions = np.zeros((len(names), len(wanted)))
        directions[[place[name] for name in wanted], range(len(wanted))] = 1.0
        return directions

    found = []
    for j, (name, turns, still) in enumerate(zip(model.v_names, model.rotations, residuals.still, strict=True)):
        for kind, told in (_at_rest if still else _of_joint)(name, turns).items():
            found.append(Candidate(kind, None, name, at(f"{COLUMN[kind]} {j}"), told))
    if model.nv > 1:
        every = at(*(f"factor {j}" for j in range(model.nv))).sum(axis=1, keepdims=True)
        found.append(Candidate("factor of all tau", None, None, every, _factor("tau of all joints")))
    found.append(Candidate("gravity", None, None, at(*(f"gravity {k}" for k in range(3))), _gravity(model)))
    for body in reversed(RigidTree.of(model).bodies):  # of links that fit alike the outermost one is told
        name, *together = (own.link.name for own in body.members)
        i, told = model.link_index(name), _body(name, together)
        whole = [f"link {i} {k}" for k in range(PER_LINK)]
        found.append(Candidate("mass and centre of mass", name, None, at(*whole[:4]), told))
        found.append(Candidate("inertia", name, None, at(*whole), told))
    return found


COLUMN = {
    "viscous friction": "viscous",
    "Coulomb friction": "coulomb",
    "armature": "armature",
    "offset": "offset",
    "force at rest": "offset",
    "factor of tau": "factor",
}
"""By hypothesis on a joint its column."""


def _of_joint(name: str, turns: bool) -> dict[str, Told]:
    """By hypothesis what its number says."""
    force, rate, mass = ("N m", "N m s/rad", "kg m^2") if turns else ("N", "N s/m", "kg")
    return {
        "viscous friction": _number(f"{name} has viscous friction", "viscous friction", rate),
        "Coulomb friction": _number(f"{name} has Coulomb friction", "Coulomb friction", force),
        "armature": _number(f"{name} has armature (rotor and gears)", "armature", mass),
        "offset": _number(f"tau of {name} is measured with an offset", "offset", force, signed=True),
        "factor of tau": _factor(f"tau of {name}"),
    }


def _at_rest(name: str, turns: bool) -> dict[str, Told]:
    """The same of a joint that stands still."""
    what = f"{name} stands still, and friction at rest or an offset is in its tau"
    return {
        "force at rest": _number(what, "force at rest", "N m" if turns else "N", signed=True),
        "factor of tau": _factor(f"tau of {name}"),
    }


def _number(what: str, key: str, unit: str, signed: bool = False) -> Told:
    def told(x: Array, error: Array) -> tuple[str, Mapping[str, Any]]:
        size = _with_error(x[0] if signed else abs(x[0]), error[0])
        than = "" if signed else f" {'more' if x[0] >= 0.0 else 'less'} than the model"
        sentence = f"{what}: {size} {unit}{than}"
        return sentence, {key: float(x[0]), "error": float(error[0]), "unit": unit}

    return told


def _factor(what: str) -> Told:
    def told(x: Array, error: Array) -> tuple[str, Mapping[str, Any]]:
        factor = 1.0 + float(x[0])
        sentence = f"{what} is measured {_with_error(factor, error[0])} times what the model says (gear, unit or sign)"
        return sentence, {"factor": factor, "error": float(error[0])}

    return told


def _gravity(model: Model) -> Told:
    def told(x: Array, error: Array) -> tuple[str, Mapping[str, Any]]:
        field = np.where(np.isfinite(x), model.gravity + x, model.gravity)
        sentence = f"gravity is ({_listed(field)}) m/s^2 in base axes, and ({_listed(model.gravity)}) in the model"
        return sentence, {"gravity": field.tolist(), "error": np.nan_to_num(error).tolist(), "unit": "m/s^2"}

    return told


def _body(name: str, together: list[str]) -> Told:
    where = f"{name} (or what is fixed to it: {', '.join(together[:3])})" if together else name

    def told(x: Array, error: Array) -> tuple[str, Mapping[str, Any]]:
        values: dict[str, Any] = {}
        for key, own, off in zip(INERTIAL, x.tolist(), error.tolist(), strict=False):
            if np.isfinite(own):
                values |= {key: own, f"error of {key}": off}
        if not np.isfinite(x[0]):
            shown = ", ".join(f"{key} {x[INERTIAL.index(key)]:+.3g}" for key in INERTIAL if key in values)
            return f"{where}: {shown} more than the model, in SI; motion does not tell its mass", values
        sentence = f"{where} has {_with_error(abs(x[0]), error[0])} kg {'more' if x[0] >= 0 else 'less'} than the model"
        if abs(x[0]) > 5.0 * error[0] and np.isfinite(x[1:4]).all():
            centre = x[1:4] / x[0]
            values["com"] = centre.tolist()
            sentence += f", centred at ({_listed(centre)}) m in the axes of {name}"
        return sentence, values

    return told


def _with_error(x: float, error: float) -> str:
    return f"{x:.4g} +- {error:.1g}"


def _listed(x: Array) -> str:
    return ", ".join(f"{own:.4g}" for own in x.tolist())
