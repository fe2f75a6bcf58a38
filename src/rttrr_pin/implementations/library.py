"""What every dynamics library that builds its own model has in common.

It reads the same URDF text, and what it built is compared with the file before it is asked: comparing results of two
models would mislead. It lets every joint move by itself, so that joints that follow another are driven along here, and
their forces are summed up by virtual work.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from tempfile import TemporaryFile
from threading import Lock
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.dynamics import generalised_forces, joint_effects, joint_states
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints.base import JointState
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.scalars import EPS, FLOAT
from rttrr_pin.errors import RefusalError
from rttrr_pin.implementations.protocol import Batch

TOLERANCE = 64 * EPS
"""Relative; merging inertias over fixed joints and turning them by rpy rounds a few times."""


@dataclass(frozen=True, slots=True)
class LibraryJoint:
    """A moving joint of a robot, where a library has it.

    Attributes:
        joint: the robot's.
        q: where its coordinates are in the library's q.
        v: where its rates are in the library's v, a, tau.
    """

    joint: Joint
    q: slice
    v: slice


@dataclass(frozen=True, slots=True)
class Motion:
    """A batch in a library's coordinates: q (N, nq), v and a (N, nv), every joint moving by itself."""

    q: Array
    v: Array
    a: Array

    @classmethod
    def of(
        cls, joints: Sequence[LibraryJoint], states: Sequence[Any], rows: int, nq: int, nv: int, convert: Convert
    ) -> Motion:
        """From our coordinates, each joint's by `convert`."""
        motion = cls(*(np.empty((rows, width)) for width in (nq, nv, nv)))
        for joint, state in zip(joints, states, strict=True):
            q, v, a = convert(joint, *(np.stack(x, axis=1) for x in (state.q, state.v, state.a)))
            motion.q[:, joint.q], motion.v[:, joint.v], motion.a[:, joint.v] = q, v, a
        return motion


Convert = Callable[[LibraryJoint, Array, Array, Array], tuple[Array, Array, Array]]
"""From a joint's q, v, a in our convention to those in the library's."""


def library_joints(model: Model, slices: Callable[[Joint, Link], tuple[slice, slice]]) -> list[LibraryJoint]:
    """The moving joints, in our order; `slices` says where a library has q and v of the joint that carries a link."""
    pairs = zip(model.joints, model.links, strict=True)
    return [LibraryJoint(joint, *slices(joint, link)) for joint, link in pairs if joint.nv]


def own_states(model: Model, batch: Batch) -> list[Any]:
    """q, v, a of each moving joint by coordinate and rate, (N,) each; a follower's from those of its leader."""
    states = joint_states(model, FLOAT, *(list(x.T) for x in (batch.q, batch.v, batch.a)))
    return [state for joint, state in zip(model.joints, states, strict=True) if joint.nv]


def driving_forces(
    model: Model, joints: Sequence[LibraryJoint], states: Sequence[JointState], tau: Array, has_armature: bool
) -> tuple[Array, Array]:
    """Tau with what the joints take themselves, and that alone, along our degrees of freedom, (N, nv) each.

    The library's tau, (N, its nv), lacks damping and friction, and armature unless it `has_armature`.
    """
    own = _joint_forces(joints, states, tau)
    missing = _joint_forces(joints, states, tau, armature=False) if has_armature else own
    whole, tau_joint = (_reduced(model, joints, forces) for forces in (tau + missing, own))
    return whole, tau_joint


def _joint_forces(
    joints: Sequence[LibraryJoint], states: Sequence[JointState], like: Array, armature: bool = True
) -> Array:
    """The forces that joints take themselves, in the columns of the library's tau."""
    out = np.zeros_like(like)
    for joint, state in zip(joints, states, strict=True):
        effects = joint.joint.effects if armature else replace(joint.joint.effects, armature=0.0)
        forces: list[Any] = joint_effects(effects, state, FLOAT)
        for column, force in zip(out[:, joint.v].T, forces, strict=True):
            column[:] = force
    return out


def _reduced(model: Model, joints: Sequence[LibraryJoint], forces: Array) -> Array:
    """Forces of a library's joints as forces along the degrees of freedom of the robot."""
    columns = iter([*forces[:, joint.v].T] for joint in joints)
    by_joint: list[Any] = [next(columns) if joint.nv else [] for joint in model.joints]
    return np.array(generalised_forces(model, FLOAT, by_joint)).reshape(model.nv, len(forces)).T.copy()


def norms(arrays: Iterable[ArrayLike]) -> Array:
    """The Euclidean norm of each array."""
    return np.array([norm(np.ravel(x)) for x in arrays])


def urdf_of(model: Model, program: str) -> str:
    """The text that a program builds its own model from.

    Raises:
        RefusalError: the model was made from numbers.
    """
    if not model.urdf:
        raise RefusalError(
            f"robot {model.name!r} was made from numbers, and {program} builds from a URDF: load it from a file"
        )
    return model.urdf


_CAPTURING = Lock()
"""Stderr is the whole process's: whoever captures it waits for the one before."""


@contextmanager
def captured_stderr() -> Iterator[list[str]]:
    """A list that has, once the block is left, the lines that C code wrote to stderr within it."""
    lines: list[str] = []
    with _CAPTURING, TemporaryFile() as file:
        try:
            kept = os.dup(2)
        except OSError:  # closed: nothing can be written there
            yield lines
            return
        os.dup2(file.fileno(), 2)
        try:
            yield lines
        finally:
            os.dup2(kept, 2)
            os.close(kept)
            file.seek(0)
            lines += file.read().decode(errors="replace").splitlines()


def differs(what: str, expected: ArrayLike, built: ArrayLike, scale: float = 0.0) -> Iterator[str]:
    """A line, if what a library built is apart from what is expected by more than rounding.

    `scale` is that of what was rounded on the way, where it is larger than the numbers themselves.
    """
    x, y = np.asarray(expected, dtype=float), np.asarray(built, dtype=float)
    if x.shape == y.shape and (x == y).all():  # most are, and norms take longer
        return
    if x.shape != y.shape or not norm(np.ravel(x - y)) <= TOLERANCE * max(float(norm(np.ravel(x))), scale):
        yield f"{what}: {shown(y)}, the file says {shown(x)}"


def shown(x: Array) -> str:
    """Numbers with all their digits, on one line."""
    return np.array2string(x, precision=17, separator=", ").replace("\n", "")


def placement_differences(
    joint: Joint, expected: tuple[Array, Array], R: Array, p: Array, scale: float = 0.0, turns: int = 1
) -> Iterator[str]:
    """What of a joint's placement R, p [m] is not as expected.

    `scale` is the sum of the lengths that p adds up, `turns` the number of rotations that R is the product of.
    """
    yield from differs(f"joint {joint.name!r} placement R", expected[0], R, turns)
    yield from differs(f"joint {joint.name!r} placement p", expected[1], p, scale * turns)


Inertia = tuple[float, Array, Array]
"""Mass [kg], centre of mass [m], and tensor about it [kg m^2]."""

Scales = tuple[float, float, float]
"""Of what an inertia's three parts were added up from."""


def inertia_differences(
    link: Link, expected: Inertia, built: Inertia, scales: Scales = (0.0, 0.0, 0.0)
) -> Iterator[str]:
    """What of mass, centre of mass and tensor about it is not as expected."""
    here = f"link {link.name!r}"
    (mass, com, tensor), (built_mass, built_com, built_tensor) = expected, built
    of_mass, of_com, of_tensor = scales
    yield from differs(f"{here} mass", mass, built_mass, of_mass)
    if mass:
        yield from differs(f"{here} centre of mass", com, built_com, of_com)
    yield from differs(f"{here} inertia", tensor, built_tensor, of_tensor)


def limit_differences(joint: Joint, built: Mapping[str, float]) -> Iterator[str]:
    """Damping, friction and limits, of those that a library has, where the file sets them.

    A continuous joint has no limit on its angle.
    """
    limits = joint.limits
    expected = {
        "damping": joint.dynamics.damping,
        "friction": joint.dynamics.friction,
        "velocity limit": limits.velocity,
        "effort limit": limits.effort,
    }
    if joint.type.limits != "none":
        expected |= {"lower limit": limits.lower, "upper limit": limits.upper}
    for what, number in expected.items():
        if what in built and np.isfinite(number):
            yield from differs(f"joint {joint.name!r} {what}", number, built[what])


def followers(model: Model) -> list[Joint]:
    """The joints whose multiplier and offset are numbers of the file, and not the product of a chain of mimics."""
    return [joint for joint in model.joints if joint.mimic is not None and not joint.mimic.rounded]


def mimic_differences(joint: Joint, multiplier: float, offset: float) -> Iterator[str]:
    """What of a follower's multiplier and offset is not as in the file."""
    assert joint.mimic is not None
    yield from differs(f"joint {joint.name!r} mimic multiplier", joint.mimic.multiplier, multiplier)
    yield from differs(f"joint {joint.name!r} mimic offset", joint.mimic.offset, offset)
