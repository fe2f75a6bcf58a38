"""Each argument of each public function, wrongly: a result, or an error of ours; never another exception."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import Joint, JointEffects, Limits, Link, Mimic, Model, RandomPayload, Robot, RttrrError, Wrench
from rttrr_pin.core.joints import REVOLUTE
from rttrr_pin.diagnosis import diagnose, diagnose_log, sample_states
from rttrr_pin.trajectories import Trajectory, trajectory
from rttrr_pin.validation import Sampler
from support.logs import write_log

ROOT = Path(__file__).parents[2]

WRONG: tuple[Any, ...] = (
    *(None, True, 0, 3, -1, 2.5, math.nan, math.inf, 10**400, 1j, np.int64(3), np.float32(2.5)),
    *("", "nonsense", "a\0b", "é\n\x1b[31m", "x" * 5000, b"bytes", object(), int, lambda: None, slice(1), ...),
    *([], (), [1, 2], [[1], [1, 2]], [[]], {}, {"a": 1}, {1: 2}, {"joint_1": "x"}, {"joint_1": None}, {"a"}),
    *(np.zeros(0), np.zeros((2, 3)), np.array("a"), np.array(None), np.full(5, np.nan), np.full((7, 5), 0.5)),
)
"""What somebody may pass by mistake."""

Call = tuple[Callable[..., Any], dict[str, Any]]

COORDINATES = {name: np.full(5, 0.3) for name in "qva"}
AT = {"link": None, "point": (0, 0, 0), "expressed_in": "link"}
STATES = {"seed": 0, "sampling": "uniform", "payload": None}
PROGRAMS = {"subject": "kernel", "reference": "recursion"}


def the_log() -> Path:
    path = Path(tempfile.mkdtemp()) / "log.csv"
    write_log(path, rttrr_pin.load("rttrr"), rate=200.0, seconds=1.0)
    return path


def the_motion() -> Trajectory:
    return trajectory(rttrr_pin.load("rttrr"), [0.0, 1.0], *np.full((3, 2, 5), 0.1))


def _rows(motion: Trajectory) -> int:
    return sum(map(len, motion.blocks()))


@cache
def calls() -> dict[str, Call]:
    """By name a function, and arguments that it takes."""
    robot = rttrr_pin.load("rttrr")
    base, Y = robot.base_parameters(), robot.regressor(**COORDINATES)
    publication = rttrr_pin.read_publication(ROOT / "examples/audit_two_link.toml")
    whole = {"q": COORDINATES["q"], "v": COORDINATES["v"], "a": COORDINATES["a"], "payload": None}
    parts = {"name": "m", "root": Link("b"), "links": (Link("l", 1.0),), "joints": (Joint("j", REVOLUTE),)}

    def joint(**arguments: Any) -> str:
        pair = (Joint("first", REVOLUTE), Joint(**arguments))
        return repr(Robot(Model("m", Link("b"), (Link("k"), Link("l")), pair)))

    return {
        "load": (
            rttrr_pin.load,
            {"source": "rttrr", "gravity": None, "base": "fixed", "xacro_args": {}, "packages": {}},
        ),
        "load_all": (rttrr_pin.load_all, {"folder": ROOT / "urdf"}),
        "Robot": (Robot, {"model": robot.model}),
        "inverse_dynamics": (robot.inverse_dynamics, whole),
        "enclose": (robot.enclose, {**whole, "parameters": "doubles"}),
        "compile": (robot.compile, {"outputs": "tau", "emitter": None}),
        "source": (robot.compile("tau").source, {"emitter": "c"}),
        "Kernel": (robot.compile("tau"), {**whole, "out": None, "threads": None}),
        "Kernel of several": (robot.compile(("tau", "n")), {**whole, "out": None, "threads": 1}),
        "mass_matrix": (robot.mass_matrix, {"q": whole["q"]}),
        "nonlinear_effects": (robot.nonlinear_effects, {"q": whole["q"], "v": whole["v"]}),
        "gravity_torque": (robot.gravity_torque, {"q": whole["q"]}),
        "regressor": (robot.regressor, COORDINATES),
        "derivatives": (robot.derivatives, whole),
        "base_parameters": (robot.base_parameters, {"tolerance": 1e-9}),
        "BaseParameters.of": (base.of, {"parameters": robot.inertial_parameters()}),
        "BaseParameters.regressor": (base.regressor, {"Y": Y}),
        "BaseParameters.condition": (base.condition, {"Y": Y}),
        "BaseParameters.advice": (base.advice, {"Y": np.repeat(Y[None], 20, axis=0), "most": 1000.0}),
        "jacobian": (robot.jacobian, {"q": whole["q"], **AT}),
        "wrench_torque": (robot.wrench_torque, {"q": whole["q"], "wrench": Wrench((1, 2, 3)), "point": (0, 0, 0)}),
        "WrenchEstimate": (robot.wrench_from_torque, {"q": whole["q"], "tau": whole["v"], **AT, "tolerance": 1e-9}),
        "with_joint_effects": (robot.with_joint_effects, {"effects": {"joint_1": JointEffects(1.0)}}),
        "with_payload_body": (
            robot.with_payload_body,
            {"mass": 1.0, "com": (0, 0, 0), "inertia": None, "link": None, "name": "load"},
        ),
        "with_locked": (robot.with_locked, {"joints": {"joint_1": 0.1}}),
        "a coordinate of with_locked": (lambda q: robot.with_locked({"joint_1": q}), {"q": 0.1}),
        "LinkWrenches": (robot.inverse_dynamics(**COORDINATES).at, {"name": "link_4"}),
        "in_convention": (robot.inverse_dynamics(**COORDINATES).in_convention, {"name": "mujoco"}),
        "JointWrenches": (robot.inverse_dynamics(**COORDINATES).in_convention("drake").at, {"link": "link_4"}),
        "Wrench": (
            lambda **wrench: robot.inverse_dynamics(**COORDINATES, payload=Wrench(**wrench)),
            {"force": (1, 2, 3), "moment": (0, 0, 0), "link": None, "expressed_in": "link"},
        ),
        "RandomPayload": (
            lambda **load: Sampler(robot.model, payload=RandomPayload(**load)).draw(0, 1),
            {"link": None, "force": 1.0, "moment": 1.0},
        ),
        "JointEffects": (
            lambda **effects: robot.with_joint_effects({"joint_1": JointEffects(**effects)}),
            {"armature": 0.1, "damping": 0.2, "friction": 0.3},
        ),
        "Joint": (
            joint,
            {"name": "j", "type": REVOLUTE, "parent": 0, "R": np.eye(3), "p": np.zeros(3), "axis": (1, 0, 0)},
        ),
        "parts of Joint": (
            lambda **own: joint(name="j", type=REVOLUTE, **own),
            {"limits": Limits(), "mimic": Mimic(0), "dynamics": JointEffects(), "effects": JointEffects()},
        ),
        "Limits": (lambda **own: joint(name="j", type=REVOLUTE, limits=Limits(**own)), {"lower": -1, "velocity": 2.0}),
        "Mimic": (lambda **own: joint(name="j", type=REVOLUTE, mimic=Mimic(**own)), {"joint": 0, "multiplier": 2.0}),
        "Link": (
            lambda **own: repr(Robot(Model("m", Link("b"), (Link(**own),), (Joint("j", REVOLUTE),)))),
            {"name": "l", "mass": 1.0, "com": np.zeros(3), "inertia": np.eye(3)},
        ),
        "Model": (lambda **own: repr(Robot(Model(**own))), {**parts, "gravity": (0, 0, -9.81)}),
        "validate": (rttrr_pin.validate, {"robot": robot, **PROGRAMS, "n_states": 3, **STATES}),
        "compare_state": (rttrr_pin.compare_state, {"robot": robot, "index": 3, **PROGRAMS, **STATES}),
        "search_worst_state": (
            rttrr_pin.search_worst_state,
            {"robot": robot, **PROGRAMS, "evaluations": 512, "seed": 0, "payload": None},
        ),
        "sample_states": (sample_states, {"robot": robot, "n": 10, "seed": 0, "payload": None}),
        "diagnose": (diagnose, {"robot": robot, **PROGRAMS, "n_states": 3, "seed": 0, "payload": None}),
        "conform": (
            rttrr_pin.conform,
            {
                "subject": "recursion",
                "robots": [robot],
                "levels": ["gravity"],
                "n_states": 2,
                "seed": 0,
                "precision": "auto",
            },
        ),
        "check_laws": (
            rttrr_pin.check_laws,
            {"robot": robot, "subject": "kernel", "n_states": 2, **STATES, "select": ("E",)},
        ),
        "compare_robots": (
            rttrr_pin.compare_robots,
            {"a": robot, "b": "trtrr", "n_states": 3, "seed": 0},
        ),
        "diagnose_log": (diagnose_log, {"robot": robot, "path": the_log()}),
        "compute_loads": (
            rttrr_pin.compute_loads,
            {
                "robot": robot,
                "trajectory": the_motion(),
                "quantities": ("tau", "f"),
                "payload": None,
                "convention": None,
                "output": None,
                "wrench_stamped": None,
                "load_cases": None,
                "ratings": {"joint_1": {"ratio": 100, "rated_torque": 67, "rated_speed": 2000, "rated_life": 35000}},
            },
        ),
        "read_trajectory": (
            lambda **how: _rows(rttrr_pin.read_trajectory(**how)),
            {"path": the_log(), "robot": robot, "topic": None, "cutoff": None, "time_unit": None},
        ),
        "trajectory": (
            lambda **how: _rows(trajectory(**how)),
            {"robot": robot, "time": [0.0, 0.1], "q": [whole["q"]] * 2, "v": [whole["v"]] * 2, "a": [whole["a"]] * 2},
        ),
        "rest_to_rest": (
            lambda **how: _rows(rttrr_pin.rest_to_rest(**how)),
            {"robot": robot, "poses": [whole["q"], np.zeros(5)], "durations": 1.0, "rate": 100.0, "name": "moves"},
        ),
        "pick_and_place": (
            lambda **how: _rows(rttrr_pin.pick_and_place(**how)),
            {"robot": robot, "mass": 1.0, "cycles": 1, "rate": 100.0},
        ),
        "inspect": (rttrr_pin.inspect, {"robot": robot, "folder": None, "select": "P", "ignore": ()}),
        "derive": (
            rttrr_pin.derive,
            {"robot": robot, "quantities": "g", "form": "auto", "parameters": None, "payload_link": None},
        ),
        "read_publication": (rttrr_pin.read_publication, {"path": ROOT / "examples/audit_two_link.toml"}),
        "audit": (rttrr_pin.audit, {"publication": publication, "seed": 0}),
    }


NAMES = (
    *("load", "load_all", "Robot", "inverse_dynamics", "enclose", "compile", "source", "Kernel", "mass_matrix"),
    *("nonlinear_effects", "gravity_torque", "regressor", "derivatives", "base_parameters", "jacobian"),
    *("wrench_torque", "WrenchEstimate", "with_joint_effects", "with_payload_body", "with_locked"),
    *("in_convention", "JointWrenches"),
    *("LinkWrenches", "Wrench", "RandomPayload", "JointEffects", "Joint", "Limits", "Mimic", "Link", "Model"),
    *("validate", "compare_state", "search_worst_state", "check_laws", "inspect", "derive", "read_publication"),
    *("conform", "compute_loads", "read_trajectory", "trajectory", "rest_to_rest", "pick_and_place"),
    *("audit", "compare_robots", "sample_states", "diagnose", "diagnose_log"),
    *(
        "BaseParameters.of",
        "BaseParameters.regressor",
        "BaseParameters.condition",
        "BaseParameters.advice",
        "Kernel of several",
    ),
    *("a coordinate of with_locked", "parts of Joint"),
)
"""The names of `calls`."""


def test_every_public_function_is_called() -> None:
    """Protocols, results of other calls and errors apart; a few need processes or a card and have tests of their own."""
    apart = {
        "Batch",
        "BaseParameters",
        "Convention",
        "DeviceKernel",
        "Enclosures",
        "Evaluation",
        "Implementation",
        "InputError",
        "LoadReport",
        "RttrrError",
        "Trajectory",
    }
    assert {*NAMES} == {*calls()}
    assert {*rttrr_pin.__all__} - apart - {"__version__", "validate_many"} <= {*NAMES}


@pytest.mark.one_in(2)
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.filterwarnings("ignore")
def test_a_wrong_argument_is_an_error_of_ours(name: str) -> None:
    function, right = calls()[name]
    function(**right)
    others = []
    for argument in right:
        for value in (*WRONG, iter("a")):
            try:
                function(**{**right, argument: value})
            except RttrrError:
                continue
            except Exception as error:
                others.append(f"{argument}={value!r:.60}: {type(error).__name__}: {error}")
    assert others == []
