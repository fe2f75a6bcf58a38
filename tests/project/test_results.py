"""What every public object promises: copies, JSON, a short representation, data that stays as it is."""

from __future__ import annotations

import builtins
import copy
import dataclasses
import inspect
import json
import pickle
import re
import tempfile
from collections.abc import Callable
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import errors
from rttrr_pin.conformance import Tolerances, conform, mutate
from rttrr_pin.diagnosis import diagnose, diagnose_log, sample_states
from rttrr_pin.implementations import make_implementation
from rttrr_pin.trajectories import trajectory
from rttrr_pin.validation import Sampler
from support.implementations import still
from support.logs import write_log

EXAMPLE = Path(__file__).parents[2] / "examples/audit_two_link.toml"

PACKAGES = (
    "rttrr_pin",
    *(
        f"rttrr_pin.{name}"
        for name in ["errors", "implementations", "validation", "laws", "inspection", "diagnosis", "loads"]
    ),
    "rttrr_pin.conformance",
)
PACKAGES = (*PACKAGES, *(f"rttrr_pin.{name}" for name in ["auditing", "derivation", "compile", "exact"]))

LONGEST = 6000
"""Characters that nobody minds in an interactive session: the arrays of one state, or a law for each line."""


def not_a_number(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    return np.full(5, np.nan)


def the_log(robot: rttrr_pin.Robot) -> Path:
    path = Path(tempfile.mkdtemp()) / "log.csv"
    write_log(path, robot, rate=200.0, seconds=1.0)
    return path


@cache
def objects() -> dict[str, Any]:
    """One of each kind, by name."""
    robot = rttrr_pin.load("rttrr")
    v = np.full(5, 0.3)
    batch = Sampler(robot.model).draw(0, 2)
    publication = rttrr_pin.read_publication(EXAMPLE)
    wrong: dict[str, Any] = {"subject": not_a_number, "reference": "recursion"}
    return {
        "Robot": robot,
        "Model": robot.model,
        "Joint": robot.model.joints[0],
        "Link": robot.model.links[0],
        "Kernel": robot.compile("tau"),
        "Wrench": rttrr_pin.Wrench((1, 2, 3)),
        "LinkWrenches": robot.inverse_dynamics(v, v, v),
        "JointWrenches": robot.inverse_dynamics(v, v, v).in_convention("mujoco"),
        "Enclosures": robot.enclose(v, v, v),
        "BaseParameters": robot.base_parameters(),
        "WrenchEstimate": robot.wrench_from_torque(v, v),
        "Batch": batch,
        "Evaluation": make_implementation("recursion", robot.model).evaluate(batch),
        "Validation": rttrr_pin.validate(robot, "recursion", "kernel", n_states=np.int64(3), seed=np.int64(2)),  # type: ignore[arg-type]
        "Validation of nan": rttrr_pin.validate(robot, n_states=3, **wrong),
        "StateReport": rttrr_pin.compare_state(robot, np.int64(3), "recursion", "kernel"),  # type: ignore[arg-type]
        "StateReport of nan": rttrr_pin.compare_state(robot, 3, **wrong),
        "WorstCase": rttrr_pin.search_worst_state(robot, "recursion", "kernel", np.int64(512), seed=np.int64(1)),  # type: ignore[arg-type]
        "Sample": sample_states(robot, 10),
        "Diagnosis": diagnose(robot, "recursion", n_states=np.int64(3), seed=np.int64(2)),  # type: ignore[arg-type]
        "Diagnosis of a cause": diagnose(robot, still, n_states=20),
        "LogDiagnosis": diagnose_log(robot, the_log(robot)),
        "Conformance": conform("recursion", levels=["gravity"], n_states=np.int64(2), seed=np.int64(2)),  # type: ignore[arg-type]
        "Conformance of nan": conform(not_a_number, [robot], ["rates"], n_states=2),
        "MutationScore": mutate(robot, Tolerances(("gravity",), 2), np.int64(9), seed=np.int64(2)),  # type: ignore[arg-type]
        "MutationScore of huge errors": mutate(robot, Tolerances(("gravity",), 2), 9, 1e300),
        "LawReport": rttrr_pin.check_laws(robot, n_states=np.int64(2), seed=np.int64(2)),  # type: ignore[arg-type]
        "Inspection": rttrr_pin.inspect(robot),
        "LoadReport": rttrr_pin.compute_loads(robot, trajectory(robot, [0.0, 1.0], *np.full((3, 2, 5), 0.1))),
        "Comparison": rttrr_pin.compare_robots(robot, "trtrr", np.int64(3), seed=np.int64(2)),  # type: ignore[arg-type]
        "Derivation": rttrr_pin.derive(robot, "g"),
        "Derivation in steps": rttrr_pin.derive(robot, ("g",), form="stepwise", payload_link="tool"),
        "Publication": publication,
        "AuditResult": rttrr_pin.audit(publication, seed=np.int64(1)),  # type: ignore[arg-type]
    }


NAMES = (
    *("Robot", "Model", "Joint", "Link", "Kernel", "Wrench", "LinkWrenches", "JointWrenches", "Enclosures"),
    *(
        "BaseParameters",
        "WrenchEstimate",
        "Batch",
        "Evaluation",
        "Validation",
        "Validation of nan",
        "StateReport",
        "StateReport of nan",
    ),
    *(
        "Sample",
        "Conformance",
        "Conformance of nan",
        "MutationScore",
        "MutationScore of huge errors",
        "WorstCase",
        "LawReport",
        "Inspection",
        "LoadReport",
        "Derivation",
        "Derivation in steps",
        "Publication",
        "AuditResult",
        "Comparison",
        "Diagnosis",
        "Diagnosis of a cause",
        "LogDiagnosis",
    ),
)

COPIES: dict[str, Callable[[Any], Any]] = {
    "pickle": lambda x: pickle.loads(pickle.dumps(x)),
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
}


@pytest.mark.parametrize("copied", COPIES)
@pytest.mark.parametrize("name", NAMES)
def test_copies_are_as_frozen_as_the_original(name: str, copied: str) -> None:
    """NumPy's pickles forget that an array is read-only, and a wrench or a model must never change."""
    own = objects()[name]
    other = COPIES[copied](own)
    assert type(other) is type(own)
    for part in dataclasses.fields(own) if dataclasses.is_dataclass(own) else ():
        x, y = getattr(own, part.name), getattr(other, part.name)
        if isinstance(x, np.ndarray):
            np.testing.assert_array_equal(x, y)
            assert x.flags.writeable == y.flags.writeable


@pytest.mark.parametrize("name", NAMES)
def test_objects_can_be_compared_and_shown(name: str) -> None:
    own = objects()[name]
    assert own == own and own != "something else"
    assert isinstance(own == COPIES["deepcopy"](own), bool)
    assert len(repr(own)) < LONGEST and " at 0x" not in repr(own)


AS_DATA = (
    *(
        "Validation",
        "Validation of nan",
        "StateReport",
        "StateReport of nan",
        "WorstCase",
        "LawReport",
        "Inspection",
        "LoadReport",
    ),
    *("Diagnosis", "Diagnosis of a cause", "LogDiagnosis", "Conformance", "Conformance of nan"),
    *("MutationScore", "MutationScore of huge errors"),
    *("Comparison", "Derivation", "Derivation in steps", "AuditResult", "Enclosures", "BaseParameters"),
    "JointWrenches",
)


@pytest.mark.parametrize("name", AS_DATA)
def test_results_are_data_for_any_json(name: str) -> None:
    """JSON has no NaN and no infinities, and NumPy's integers are no numbers of it."""
    own = objects()[name]
    data = own.to_dict()
    assert json.loads(json.dumps(data, allow_nan=False))["schema"] == data["schema"]
    if hasattr(own, "passed"):
        assert isinstance(own.passed, bool) and own.summary()


ERRORS = {
    "ShapeError": lambda robot: robot.mass_matrix([1.0]),
    "NumberError": lambda robot: robot.mass_matrix([np.nan] * 5),
    "MissingJointError": lambda robot: robot.mass_matrix({}),
    "UnknownNameError": lambda robot: robot.compile("nope"),
    "UrdfError": lambda robot: rttrr_pin.load("<robot/>"),
    "EquationError": lambda robot: rttrr_pin.read_publication("no/such/file.toml"),
    "InputError": lambda robot: robot.compile(()),
    "ImplementationError": lambda robot: rttrr_pin.validate(robot, subject="no_such_module:function"),
    "ModelMismatchError": lambda robot: (_ for _ in ()).throw(errors.ModelMismatchError("X", ["a", "b"])),
}


@pytest.mark.parametrize("copied", COPIES)
@pytest.mark.parametrize("kind", ERRORS)
def test_errors_come_back_from_other_processes(kind: str, copied: str) -> None:
    """A pool that cannot read the error of a worker breaks down."""
    with pytest.raises(getattr(errors, kind)) as caught:
        ERRORS[kind](objects()["Robot"])
    other = COPIES[copied](caught.value)
    assert type(other) is type(caught.value)
    assert str(other) == str(caught.value) and repr(vars(other)) == repr(vars(caught.value))


@pytest.mark.parametrize("package", PACKAGES)
def test_docstrings_name_errors_that_exist(package: str) -> None:
    module = import_module(package)
    for name in module.__all__:
        thing = getattr(module, name)
        members = vars(thing).values() if inspect.isclass(thing) else ()
        for own in (thing, *members):
            text = inspect.getdoc(own) if callable(own) else None
            raised = re.search(r"^Raises:\n((?: {4}.*\n?)+)", text or "", re.MULTILINE)
            for line in raised[1].splitlines() if raised else ():
                named = re.match(r" {4}((?:[A-Z]\w+, )*[A-Z]\w+):", line)
                for error in named[1].split(", ") if named else ():
                    assert hasattr(errors, error) or hasattr(builtins, error), f"{package}.{name}: {error}"


def test_another_model_is_another_robot() -> None:
    """Kernels that are compiled are those of the model."""
    robot = rttrr_pin.load("rttrr")
    with pytest.raises(AttributeError):
        robot.model = robot.model.with_gravity(np.zeros(3))  # type: ignore[misc]


def test_a_joint_of_several_rates_is_read_by_its_name() -> None:
    robot = rttrr_pin.load("rttrr", base="floating")
    state = Sampler(robot.model).draw(0, 4)
    result = robot.inverse_dynamics(state.q, state.v, state.a)
    np.testing.assert_array_equal(result.at("root_joint")["tau"], result.tau[:, :6])
    np.testing.assert_array_equal(result.at("root_joint.rz")["tau"], result.tau[:, 5])
