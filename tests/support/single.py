"""Inverse dynamics in single precision: our recursion on float32, and Featherstone's in spatial vectors, in NumPy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from rttrr_pin.conformance import Case
from rttrr_pin.core.arrays import norm
from rttrr_pin.core.batch import split_columns
from rttrr_pin.core.dynamics import dynamics
from rttrr_pin.core.joints import CONTINUOUS, FIXED, FLOATING, PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import payloads_of
from rttrr_pin.core.scalars import Arithmetic
from rttrr_pin.core.wrench import QUANTITIES
from rttrr_pin.implementations import Batch, Evaluation, default_allowance
from rttrr_pin.implementations.allowance import SINGLE as PRECISION

Array = Any

SINGLE = Arithmetic(
    number=lambda value, error: np.float32(value),
    column=lambda values: np.asarray(values, dtype=np.float32),
    sincos=lambda q: (np.sin(q), np.cos(q)),
    sign=np.sign,
)
"""float32 throughout: numbers of the robot are rounded first."""


class SingleRecursion:
    """The recursion of the core on float32."""

    name, version, quantities = "single", "", QUANTITIES

    def __init__(self, model: Model) -> None:
        self.model = model

    def evaluate(self, batch: Batch) -> Evaluation:
        q, v, a = ([SINGLE.column(column) for column in x.T] for x in (batch.q, batch.v, batch.a))
        result = dynamics(self.model, SINGLE, q, v, a, payloads_of(batch.loads, SINGLE))
        scalars = [np.broadcast_to(np.asarray(x, dtype=np.float32), len(batch)) for x in result.scalars(QUANTITIES)]
        return Evaluation(split_columns(self.model, np.stack(scalars, axis=1).astype(np.float64)))


class SingleSpatial:
    """Featherstone's RNEA in spatial vectors of each link's frame; driving forces alone, no payload."""

    name, version, quantities = "spatial", "", ("tau",)

    def __init__(self, model: Model) -> None:
        self.model = model

    def evaluate(self, batch: Batch) -> Evaluation:
        if batch.loads:
            raise NotImplementedError("payloads")
        return Evaluation({"tau": spatial(self.model, *(x.astype(np.float32) for x in (batch.q, batch.v, batch.a)))})


def cross(x: Array) -> Array:
    """The matrices of cross products, (..., 3, 3)."""
    out = np.zeros((*x.shape, 3), dtype=np.float32)
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        out[..., i, j], out[..., j, i] = -x[..., k], x[..., k]
    return out


def spatial(model: Model, q: Array, v: Array, a: Array) -> Array:
    """Tau, (N, nv), of a batch of float32 states."""
    rows, one = len(q), np.float32(1)
    starts = _starts(model)
    V: list[Array] = []
    A: list[Array] = []
    forces: list[Array] = []
    turns: list[tuple[Array, Array]] = []
    axes: list[Array] = []
    gravity = np.concatenate([np.zeros(3, np.float32), -model.gravity.astype(np.float32)])
    for i, (joint, link) in enumerate(zip(model.joints, model.links, strict=True)):
        followed, factor, offset = i, one, np.float32(0)
        if joint.mimic is not None:
            followed, factor, offset = (
                joint.mimic.joint,
                np.float32(joint.mimic.multiplier),
                np.float32(joint.mimic.offset),
            )
        kq, kv = starts.get(followed, (0, 0))
        R_j, p_j, S = _motion(joint, q[:, kq : kq + joint.nq] * factor + offset if joint.nq else q[:, :0], rows)
        qd, qdd = (x[:, kv : kv + joint.nv] * factor for x in (v, a))
        R = joint.R.astype(np.float32) @ R_j
        p = joint.p.astype(np.float32) + np.einsum("ij,nj->ni", joint.R.astype(np.float32), p_j)
        V_p, A_p = (
            (V[joint.parent], A[joint.parent])
            if joint.parent >= 0
            else (np.zeros((rows, 6), np.float32), np.tile(gravity, (rows, 1)))
        )
        V_j = qd @ S.T
        V.append(_moved(R, p, V_p) + V_j)
        A.append(_moved(R, p, A_p) + qdd @ S.T + _cross_motion(V[i], V_j))
        m, c, I = np.float32(link.mass), link.com.astype(np.float32), link.inertia.astype(np.float32)
        C = cross(c)
        spatial_inertia = np.block([[I + m * C @ C.T, m * C], [m * C.T, m * np.eye(3, dtype=np.float32)]])
        forces.append(A[i] @ spatial_inertia.T + _cross_force(V[i], V[i] @ spatial_inertia.T))
        turns.append((R, p))
        axes.append(S)
    tau = np.zeros((rows, model.nv), np.float32)
    for i in reversed(range(len(model.links))):
        joint = model.joints[i]
        leader = i if joint.mimic is None else joint.mimic.joint
        factor = one if joint.mimic is None else np.float32(joint.mimic.multiplier)
        if joint.nv:
            kq, kv = starts[leader]
            own = forces[i] @ axes[i]
            qd, qdd = (x[:, kv : kv + joint.nv] * factor for x in (v, a))
            e = joint.effects
            own = own + np.float32(e.armature) * qdd + np.float32(e.damping) * qd + np.float32(e.friction) * np.sign(qd)
            tau[:, kv : kv + joint.nv] += own * factor
        if joint.parent >= 0:
            R, p = turns[i]
            f = np.einsum("nij,nj->ni", R, forces[i][:, 3:])
            n = np.einsum("nij,nj->ni", R, forces[i][:, :3]) + np.cross(p, f)
            forces[joint.parent] = forces[joint.parent] + np.hstack([n, f])
    assert tau.dtype == np.float32
    return tau.astype(np.float64)


def _starts(model: Model) -> dict[int, tuple[int, int]]:
    """Where q and v of each moving joint begin."""
    found, kq, kv = {}, 0, 0
    for i in model.independent:
        found[i] = (kq, kv)
        kq, kv = kq + model.joints[i].nq, kv + model.joints[i].nv
    return found


def _motion(joint: Any, q: Array, rows: int) -> tuple[Array, Array, Array]:
    """Rotation, position and axes (6, nv) of a joint."""
    eye, none = np.tile(np.eye(3, dtype=np.float32), (rows, 1, 1)), np.zeros((rows, 3), np.float32)
    axis = joint.axis.astype(np.float32)
    if joint.type == FIXED:
        return eye, none, np.zeros((6, 0), np.float32)
    if joint.type == PRISMATIC:
        return eye, q * axis, np.concatenate([np.zeros(3, np.float32), axis])[:, None]
    if joint.type in (REVOLUTE, CONTINUOUS):
        s, c, K = np.sin(q)[..., None], np.cos(q)[..., None], cross(axis)
        return (
            eye + s * K + (np.float32(1) - c) * (K @ K),
            none,
            np.concatenate([axis, np.zeros(3, np.float32)])[:, None],
        )
    assert joint.type == FLOATING
    x, y, z, w = (q[:, k] for k in range(3, 7))
    V = cross(np.stack([x, y, z], axis=1))
    S = np.zeros((6, 6), np.float32)
    S[3:, :3] = S[:3, 3:] = np.eye(3)
    return eye + np.float32(2) * (w[:, None, None] * V + V @ V), q[:, :3], S


def _moved(R: Array, p: Array, x: Array) -> Array:
    """A motion of the parent's frame in that of the child."""
    w, v = x[:, :3], x[:, 3:]
    back = np.swapaxes(R, 1, 2)
    return np.hstack([np.einsum("nij,nj->ni", back, w), np.einsum("nij,nj->ni", back, v + np.cross(w, p))])


def _cross_motion(x: Array, y: Array) -> Array:
    return np.hstack([np.cross(x[:, :3], y[:, :3]), np.cross(x[:, :3], y[:, 3:]) + np.cross(x[:, 3:], y[:, :3])])


def _cross_force(x: Array, y: Array) -> Array:
    return np.hstack([np.cross(x[:, :3], y[:, :3]) + np.cross(x[:, 3:], y[:, 3:]), np.cross(x[:, :3], y[:, 3:])])


def with_mass(model: Model, link: int, factor: float) -> Model:
    """A robot with another mass of one link."""
    from dataclasses import replace

    links: Sequence[Any] = model.links
    own = [replace(x, mass=x.mass * factor) if k == link else x for k, x in enumerate(links)]
    return replace(model, links=tuple(own), document=None)


def single_ratios(case: Case, program: Any) -> list[float]:
    """The largest error / allowance of each quantity, against the recursion in doubles and its bound."""
    batch = case.batch
    allowed, (values, bounds) = default_allowance(batch, PRECISION), batch.recursion
    found = []
    for key, x in program(case.robot.model).evaluate(batch).values.items():
        error, bound = x - getattr(values, key), getattr(bounds, key)
        error, bound = (np.abs(y) if key == "tau" else norm(y) for y in (error, bound))
        found.append(float((error / (allowed[key] + bound)).max()))
    return found
