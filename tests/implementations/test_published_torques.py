"""Torques, mass matrices and accelerations that others published, against our recursion.

Each file of tests/data names its source; its `convention` says what the numbers mean. Joint extras (rotor
inertia seen through the gear, viscous and Coulomb friction) are no part of the recursion: `joint_terms` adds
the published ones to our rigid-body torques. Some of the robots could not be built (set2 of SymPyBotics has
random tensors); inverse dynamics is defined for them all the same.

Published digits bound every component on its own, so a case's `tol` is compared with the largest component.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from rttrr_pin import Robot, Wrench
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import FIXED, PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Link, Model
from support.recursion import recursion
from support.tolerances import EXACT, NINE_DIGITS, norm_error

Array = NDArray[np.float64]

DATA = Path(__file__).parents[1] / "data"

COUNTS = {
    "modern_robotics_3link": {"cases": 4, "native": 2},
    "sympybotics_puma560": {"cases": 16},
    "rtb_puma560": {"cases": 16, "forward_cases": 1},
}
"""How many published results each file holds, by the list they stand in."""

TYPES = {"R": REVOLUTE, "P": PRISMATIC}

TOOL = "tool"


@dataclass(frozen=True)
class Case:
    """One published result: the file and the list it stands in, its place there, and its numbers."""

    file: str
    section: str
    index: int
    numbers: dict[str, Any]

    def __str__(self) -> str:
        return f"{self.file}-{self.section}-{self.index}-{self.what}".replace(" ", "_")

    @property
    def what(self) -> str:
        """What was published: the file's word for it, or what of the motion and the loads is not zero."""
        if "what" in self.numbers:
            return str(self.numbers["what"])
        if "M" in self.numbers:
            return "mass matrix"
        if "tau_applied" in self.numbers:
            return "forward dynamics"
        names = {"gravity": "gravity", "qd": "rates", "qdd": "accelerations", "f_tip": "payload"}
        return "+".join(name for key, name in names.items() if np.any(self.numbers.get(key, 0)))

    def array(self, key: str) -> Array:
        """One of its vectors or matrices."""
        return np.array(self.numbers[key], dtype=float)

    @property
    def robot(self) -> Robot:
        """The robot that it belongs to, in its gravity field (none, where only a mass matrix is given)."""
        return robot(self.file, self.numbers["model"], tuple(self.numbers.get("gravity", (0.0, 0.0, 0.0))))

    @property
    def payload(self) -> Wrench | None:
        """What the robot exerts on its surroundings at the tool."""
        if "f_tip" not in self.numbers:
            return None
        return Wrench(self.numbers["f_tip"], self.numbers["n_tip"], link=TOOL)


@cache
def published(file: str) -> dict[str, Any]:
    """The content of one file."""
    content: dict[str, Any] = json.loads((DATA / f"{file}.json").read_text(encoding="utf-8"))
    return content


def cases(file: str) -> list[Case]:
    """Every published result of one file."""
    content = published(file)
    sections = {name: content[name] for name in content if name.endswith("cases")}
    if "scale" in content:
        sections["native"] = in_chain_coordinates(content)
    return [Case(file, name, i, case) for name, listed in sections.items() for i, case in enumerate(listed)]


def in_chain_coordinates(content: dict[str, Any]) -> list[dict[str, Any]]:
    """Modern Robotics' mass matrix and forward dynamics, which stand only in the `native` block.

    Its first screw is no unit screw: q, qd, qdd times `scale`, torques divided by it, are those of the chain.
    """
    native, scale = content["native"], np.array(content["scale"])
    forward = native["ForwardDynamics"]
    model, q = next(iter(content["models"])), native["thetalist"] * scale
    mass_matrix = np.array(native["MassMatrix"]) / np.outer(scale, scale)
    qdd = np.array(forward["ddtheta"]) * scale
    tip = {"n_tip": native["Ftip"][:3], "f_tip": native["Ftip"][3:]}
    motion = {"model": model, "q": q, "qd": native["dthetalist"] * scale, "gravity": native["g"]}
    return [
        {"model": model, "q": q, "M": mass_matrix, "tol": NINE_DIGITS * np.linalg.norm(mass_matrix)},
        motion
        | tip
        | {"qdd": qdd, "tau_applied": forward["taulist"] / scale, "tol": NINE_DIGITS * np.linalg.norm(qdd)},
    ]


@cache
def robot(file: str, name: str, gravity: tuple[float, float, float]) -> Robot:
    """The chain of one model, with the tool as a massless link fixed to its last link."""
    chain = published(file)["models"][name]
    links = [Link(f"link_{i}", x["m"], x["c"], x["I"]) for i, x in enumerate(chain["links"], start=1)]
    joints = [
        Joint(f"joint_{i}", TYPES[x["type"]], i - 2, x["R0"], x["p0"], x["axis"], rotated=True)
        for i, x in enumerate(chain["links"], start=1)
    ]
    links.append(Link(TOOL))
    joints.append(Joint(TOOL, FIXED, len(joints) - 1, chain["R_tip"], chain["p_tip"], rotated=True))
    return Robot(Model(name, Link("base"), tuple(links), tuple(joints), np.array(gravity)))


def joint_terms(case: Case, qd: Array, qdd: Array) -> Array:
    """The published joint terms: k qdd + viscous qd + Coulomb friction by the sign of qd, none at qd = 0."""
    if "use_joint_extra" not in case.numbers:
        return np.zeros_like(qdd)
    extra = published(case.file)["models"][case.numbers["model"]][case.numbers["use_joint_extra"]]
    k, viscous, positive, negative = (
        np.array(extra.get(key, np.zeros(qdd.shape[-1])))
        for key in ("reflected_inertia_k", "viscous_k", "coulomb_pos", "coulomb_neg")
    )
    coulomb = np.where(qd > 0, positive, np.where(qd < 0, negative, 0.0))
    return np.asarray(k * qdd + viscous * qd + coulomb)


def torques(case: Case) -> Array:
    """The recursion's rigid-body torques and the published joint terms for the motion and the payload of a case."""
    q, qd, qdd = (case.array(key) for key in ("q", "qd", "qdd"))
    return recursion(case.robot, q, qd, qdd, case.payload).tau + joint_terms(case, qd, qdd)


def mass_matrix(case: Case) -> Array:
    """Its columns: the torques for unit accelerations, without rates, gravity and payload."""
    q, unit = case.array("q"), np.eye(len(case.array("q")))
    rates = np.zeros_like(q)
    without_gravity = robot(case.file, case.numbers["model"], (0.0, 0.0, 0.0))
    return (without_gravity.inverse_dynamics(q, rates, unit).tau + joint_terms(case, rates, unit)).T


ALL = [case for file in COUNTS for case in cases(file)]
WITH_TORQUES = [case for case in ALL if "tau" in case.numbers]
WITH_MASS_MATRIX = [case for case in ALL if "M" in case.numbers]
WITH_ACCELERATIONS = [case for case in ALL if "tau_applied" in case.numbers]
WITH_PAYLOAD = [case for case in WITH_TORQUES if case.payload]


@pytest.mark.parametrize("case", WITH_TORQUES, ids=str)
def test_torques_are_the_published_ones(case: Case) -> None:
    """Inverse dynamics gives the published torques to the published digits."""
    assert np.abs(torques(case) - case.array("tau")).max() <= case.numbers["tol"]


@pytest.mark.one_in(2)
@pytest.mark.parametrize("case", WITH_MASS_MATRIX, ids=str)
def test_mass_matrix_is_the_published_one(case: Case) -> None:
    """Torques for unit accelerations are the columns of the mass matrix, to the published digits."""
    assert np.abs(mass_matrix(case) - case.array("M")).max() <= case.numbers["tol"]


@pytest.mark.parametrize("case", WITH_ACCELERATIONS, ids=str)
def test_published_accelerations_need_the_applied_torques(case: Case) -> None:
    """Inverse dynamics of the published accelerations is the applied torque, as far as their digits go."""
    error = np.abs(torques(case) - case.array("tau_applied"))
    assert (error <= np.abs(mass_matrix(case)).sum(axis=1) * case.numbers["tol"]).all()


@pytest.mark.parametrize("case", WITH_PAYLOAD, ids=str)
def test_fixed_tool_carries_the_payload(case: Case) -> None:
    """The force and moment that cross the joint of the massless tool are the payload, bit for bit."""
    q, qd, qdd = (case.array(key) for key in ("q", "qd", "qdd"))
    tool = case.robot.inverse_dynamics(q, qd, qdd, case.payload).at(TOOL)
    assert norm_error(tool["f"], case.array("f_tip")) <= EXACT
    assert norm_error(tool["n"], case.array("n_tip")) <= EXACT


def test_payload_cases_are_among_the_published() -> None:
    """Two files hold cases with a payload that is not zero, so the tool is tested with loads."""
    loaded = [case for case in WITH_PAYLOAD if np.any(case.array("f_tip")) and np.any(case.array("n_tip"))]
    assert {case.file for case in loaded} == {"modern_robotics_3link", "rtb_puma560"}


@pytest.mark.parametrize("file", COUNTS)
def test_every_published_case_is_a_test(file: str) -> None:
    """Each result of a file is a parameter of exactly one comparison, and none that we know is missing."""
    comparisons = (
        test_torques_are_the_published_ones,
        test_mass_matrix_is_the_published_one,
        test_published_accelerations_need_the_applied_torques,
    )
    marks = [mark for test in comparisons for mark in test.pytestmark]  # type: ignore[attr-defined]
    tested = sorted(
        str(case)
        for mark in marks
        for case in (mark.args[1] if mark.name == "parametrize" else ())
        if case.file == file
    )
    assert tested == sorted(str(case) for case in cases(file))
    assert len(tested) == len(set(tested)) == sum(COUNTS[file].values())
    assert {x: len(published(file)[x]) for x in COUNTS[file] if x != "native"} == {
        x: count for x, count in COUNTS[file].items() if x != "native"
    }


def test_every_published_file_is_read() -> None:
    """The files with a convention and cases are the ones whose cases are counted."""
    contents = {path.stem: json.loads(path.read_text(encoding="utf-8")) for path in DATA.glob("*.json")}
    with_cases = {name for name, content in contents.items() if {"convention", "cases"} <= set(content)}
    assert with_cases == set(COUNTS)
