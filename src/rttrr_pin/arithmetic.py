"""One recursion, many arithmetics: what it takes to run the specification on one kind of scalar.

An `Arithmetic` says how a number of the model, a column of a batch and a sine become scalars of its kind. `FLOAT` is
the readable reference: Python floats for one state, NumPy arrays for a batch, the same operations in the same order,
hence the same bits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from rttrr_pin.algebra import Matrix, Scalar, Vector
from rttrr_pin.model import Joint, Link, Model
from rttrr_pin.newton_euler import Body, Payload, SinCos, Wrenches, newton_euler

Array = NDArray[np.float64]

UNIT_ROUNDOFF = 2.0**-53
"""u: the relative error of one correctly rounded float64 operation; eps is 2 u."""

ROTATION_ERROR = 8 * UNIT_ROUNDOFF
"""Of an entry of a rotation matrix made from rpy: a sum of two products of sines and cosines, each within an ulp."""

AXIS_ERROR = 4 * UNIT_ROUNDOFF
"""Of a component of an axis that was divided by its length."""


@dataclass(frozen=True, slots=True)
class Arithmetic:
    """How to compute with one kind of scalar.

    Attributes:
        number: from a float of the model, and a bound on how far rounding took it from what the file says.
        column: from the values of one coordinate: a float (one state) or an array (a batch).
        sincos: sine and cosine of such a column.
    """

    number: Callable[[float, float], Scalar]
    column: Callable[[float | Array], Scalar]
    sincos: SinCos


def _float_sincos(q: float | Array) -> tuple[float | Array, float | Array]:
    """NumPy's sine and cosine also for one float, since the bits must not depend on the batch."""
    if isinstance(q, float):
        return float(np.sin(q)), float(np.cos(q))
    return np.sin(q), np.cos(q)


FLOAT = Arithmetic(number=lambda value, error: value, column=lambda values: values, sincos=_float_sincos)


@dataclass(frozen=True, slots=True)
class Load:
    """A payload of a batch: what the robot exerts on its surroundings at one link.

    Attributes:
        link: index of the link.
        f: force, (3,) or (N, 3) [N].
        n: moment about the origin of the link's frame, (3,) or (N, 3) [N m].
        in_base: whether both are in base axes; else in the link's.
    """

    link: int
    f: Array
    n: Array
    in_base: bool = False

    def block(self, part: slice) -> Load:
        """The same for some states of the batch."""
        f, n = (x if x.ndim == 1 else x[part] for x in (self.f, self.n))
        return Load(self.link, f, n, self.in_base)


@lru_cache(maxsize=32)
def bodies(model: Model, arithmetic: Arithmetic) -> list[Body]:
    """The links and joints of a model with their numbers as scalars; both are frozen, so the last few are kept."""
    return [_body(*pair, arithmetic) for pair in zip(model.joints, model.links, strict=True)]


def evaluate(
    model: Model, arithmetic: Arithmetic, q: Array, v: Array, a: Array, loads: Sequence[Load] = ()
) -> Wrenches:
    """The specification on a batch.

    Args:
        model: the robot.
        arithmetic: the kind of scalar.
        q: coordinates, (N, nv) [rad or m]; one state, (1, nv), is computed with Python floats.
        v: rates, (N, nv).
        a: accelerations, (N, nv).
        loads: payloads.

    Returns:
        tau, F, N, f, n in scalars of that kind; what no state changes may be a plain number.
    """
    q_, v_, a_ = ([arithmetic.column(column) for column in _columns(x)] for x in (q, v, a))
    payloads = [
        Payload(load.link, _vector(load.f, arithmetic), _vector(load.n, arithmetic), load.in_base) for load in loads
    ]
    gravity = Vector.of(model.gravity, lambda value: arithmetic.number(value, 0.0))
    return newton_euler(bodies(model, arithmetic), q_, v_, a_, gravity, payloads, arithmetic.sincos)


def _body(joint: Joint, link: Link, arithmetic: Arithmetic) -> Body:
    """One link with its joint."""

    def number(error: float) -> Callable[[float], Scalar]:
        return lambda value: arithmetic.number(value, error)

    # Rotation matrices from rpy, axes divided by their length and turned tensors are rounded; the rest is as written.
    turned = ROTATION_ERROR if joint.rotated else 0.0
    normalised = AXIS_ERROR if np.count_nonzero(joint.axis) > 1 else 0.0
    turned_tensor = 8 * ROTATION_ERROR * float(np.linalg.norm(link.inertia)) if link.rotated else 0.0
    return Body(
        parent=joint.parent,
        type=joint.type,
        axis=Vector.of(joint.axis, number(normalised)),
        R=Matrix.of(joint.R, number(turned)),
        p=Vector.of(joint.p, number(0.0)),
        M=arithmetic.number(link.mass, 0.0),
        r_C=Vector.of(link.com, number(0.0)),
        I=Matrix.of(link.inertia, number(turned_tensor)),
    )


def _columns(x: Array) -> list[float | Array]:
    """The columns of (N, n); floats where there is one state."""
    if len(x) == 1:
        return [float(value) for value in x[0]]
    return [np.ascontiguousarray(column) for column in x.T]


def _vector(x: Array, arithmetic: Arithmetic) -> Vector:
    """(3,) or (N, 3) as a vector of scalars."""
    return Vector(*(arithmetic.column(column) for column in _columns(np.atleast_2d(x))))
