"""Pinocchio's RNEA compiled for this processor from the headers of the wheel, in a C++ loop over all states."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np
from compiled import ROWS, build
from protocol import Array, Job, Work, serve

DEFINES = (
    "-std=c++17",
    "-DNDEBUG",
    "-DBOOST_MPL_LIMIT_LIST_SIZE=30",
    "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",
    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS",
    "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
)
"""As Pinocchio's own build has them."""


def prepare(job: Job) -> Work:
    import pinocchio as pin

    model = pin.buildModelFromXML(job.bare_urdf())
    if model.nq != model.nv:
        raise SystemExit("continuous joints have two coordinates in Pinocchio: not measured here")
    names = list(model.names)[1:]
    include = next(parent for parent in Path(pin.__file__).parents if parent.name == "cmeel.prefix") / "include"
    source = Path(__file__).with_suffix(".cpp").read_text()
    options = [*DEFINES, f"-I{include}", f"-I{include / 'eigen3'}"]
    library = build(source, options, "g++")
    library.make.restype, library.make.argtypes = ctypes.c_void_p, [ctypes.c_char_p]
    library.run.argtypes = [ctypes.c_void_p, ctypes.c_long, ctypes.c_int, ROWS, ROWS, ROWS, ROWS]
    robot = library.make(described(model, job.gravity).encode())
    q, v, a = job.columns(names)
    tau: Array = np.empty_like(v)
    return Work(
        run=lambda: library.run(robot, len(q), job.threads, q, v, a, tau),
        result=lambda: job.torques(names, tau),
        note="templates compiled with g++ -O3 -march=native, loop in C++, OpenMP",
    )


def described(model: Any, gravity: Array) -> str:
    """The model as the text that the C++ reads."""
    lines = [_numbers(gravity)]
    for k in range(1, model.njoints):
        joint, placement, body = model.joints[k], model.jointPlacements[k], model.inertias[k]
        kind = joint.shortname()
        axis = joint.extract().axis if kind.endswith("Unaligned") else np.zeros(3)
        parts = (axis, placement.rotation, placement.translation, body.mass, body.lever, body.inertia)
        lines.append(f"{model.parents[k]} {kind} " + " ".join(_numbers(part) for part in parts))
    return "\n".join(lines)


def _numbers(values: Any) -> str:
    return " ".join(f"{value:.17g}" for value in np.ravel(values))


if __name__ == "__main__":
    serve(["pin"], prepare)
