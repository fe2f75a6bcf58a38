"""Closed forms of robots of every kind, each derived once, and what Pinocchio says of the same states."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

import rttrr_pin
from rttrr_pin import Robot
from rttrr_pin import derivation as symbolic
from rttrr_pin.core.payload import Load
from rttrr_pin.derivation.writers import WRITERS
from rttrr_pin.validation import Sampler
from support.implementations import evaluated
from support.pinocchio_states import pin_model, pin_q
from support.serial_chains import EXAMPLES, random_chain
from support.tolerances import ROUNDING, norm_error
from support.trees import random_tree

ROOT = Path(__file__).parents[2]
STATES = 12
ALL = tuple(symbolic.QUANTITIES)
OF_LINKS = ("F", "N", "f", "n")
ONE_AXIS = ("revolute", "continuous", "prismatic", "fixed")

ROBOTS: dict[str, tuple[str, str]] = {
    "rttrr": ("rttrr", "fixed"),
    "trtrr": ("trtrr", "fixed"),
    "any-axes": (random_chain(1, ("revolute", "prismatic", "revolute", "continuous")), "fixed"),
    "two-joints": (random_chain(8, ("continuous", "fixed", "prismatic")), "fixed"),
    "fixed-between": (EXAMPLES["fixed-between"], "fixed"),
    "tree": (random_tree(17, 5, ONE_AXIS), "fixed"),
    "tree-with-followers": (random_tree(12, 5, ONE_AXIS), "fixed"),
    "planar-joints": (random_tree(5, 2, ("planar", "continuous"), mimics=False), "fixed"),
    "floating-base": (random_tree(4, 2, ("revolute", "prismatic"), mimics=False), "floating"),
}

CASES = [
    ("rttrr", "auto", "letters"),
    ("rttrr", "stepwise", "letters"),
    ("rttrr", "auto", "numbers"),
    ("trtrr", "auto", "letters"),
    ("any-axes", "auto", "letters"),
    ("two-joints", "expanded", "letters"),
    ("two-joints", "expanded", "numbers"),
    ("fixed-between", "stepwise", "numbers"),
    ("tree", "stepwise", "letters"),
    ("tree-with-followers", "stepwise", "letters"),
    ("planar-joints", "stepwise", "letters"),
    ("floating-base", "stepwise", "letters"),
]
"""Robot, form, and whether its numbers have letters."""

IDS = ["-".join(case) for case in CASES]

FAST = [CASES[k] for k in (1, 2, 5, 7, 11)]
"""Those that the README's test line runs: each form, letters and numbers, an arm, a chain, a floating base."""


@cache
def robot(name: str) -> Robot:
    source, base = ROBOTS[name]
    return rttrr_pin.load(source, base=base)


@cache
def derived(name: str, form: str, kind: str) -> symbolic.Derivation:
    model = robot(name).model
    link = len(model.links) - 1
    parameters = symbolic.payload_symbols(model, link) if kind == "numbers" else symbolic.default_symbols(model, link)
    return symbolic.derive(model, ALL, form, parameters, link)


@cache
def written(case: tuple[str, str, str], language: str) -> str:
    return WRITERS[language](derived(*case))


@cache
def drawn(name: str) -> tuple[Any, np.ndarray]:
    """States, and a payload at the last link, force before moment."""
    rng = np.random.default_rng(7)
    return Sampler(robot(name).model, "mixed", 3).draw(0, STATES), rng.normal(size=(STATES, 6)) * 10.0


@cache
def pinocchios(name: str) -> dict[str, np.ndarray]:
    """What Pinocchio says: the wrenches by the oracle; M, g and C v by its own functions where no joint follows."""
    model = robot(name).model
    at, payload = drawn(name)
    load = Load(len(model.links) - 1, payload[:, :3], payload[:, 3:])
    wrenches = evaluated("pinocchio", model, at.q, at.v, at.a, [load]).values
    found = {key: wrenches[key] for key in ("tau", *OF_LINKS)}
    still = Robot(model.without_joint_effects())
    found["M"], found["g"] = robot(name).mass_matrix(at.q), still.gravity_torque(at.q)
    found["Cv"] = still.nonlinear_effects(at.q, at.v) - found["g"]
    if all(joint.mimic is None for joint in model.joints):
        found |= _by_its_own_functions(name)
    masses = np.array([link.mass for link in model.links])
    found["v_dot_C"] = found["F"] / np.where(masses, masses, np.nan)[:, None]
    return found


def _by_its_own_functions(name: str) -> dict[str, np.ndarray]:
    theirs = pin_model(robot(name))
    data, (at, _) = theirs.createData(), drawn(name)
    M, g, Cv = [], [], []
    for q, v in zip([pin_q(robot(name), q) for q in at.q], at.v, strict=True):
        upper = np.triu(pin.crba(theirs, data, q))
        M.append(upper + np.triu(upper, 1).T)
        g.append(pin.computeGeneralizedGravity(theirs, data, q).copy())
        Cv.append(pin.computeCoriolisMatrix(theirs, data, q, v) @ v)
    return {"M": np.array(M), "g": np.array(g), "Cv": np.array(Cv)}


def assert_pinocchios(name: str, ours: dict[str, np.ndarray]) -> None:
    """Every quantity, each link or all joints by their norm."""
    theirs, (at, _) = pinocchios(name), drawn(name)
    for key in ("tau", "M", "g"):
        assert norm_error(ours[key], theirs[key]) <= ROUNDING, key
    assert norm_error(np.einsum("kij,kj->ki", ours["C"], at.v), theirs["Cv"]) <= ROUNDING
    for key in ("v_dot_C", *OF_LINKS):
        for i in range(theirs[key].shape[1]):
            if not np.isnan(theirs[key][:, i]).any():
                assert norm_error(ours[key][:, i], theirs[key][:, i]) <= ROUNDING, (key, i)


def inputs(name: str, quantity: str) -> list[np.ndarray]:
    """What a function for the quantity takes."""
    at, payload = drawn(name)
    subject = symbolic.QUANTITIES[quantity]
    return [getattr(at, x) for x in subject.inputs] + ([payload] if subject.payload else [])
