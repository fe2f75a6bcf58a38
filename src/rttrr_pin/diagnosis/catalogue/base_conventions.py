"""Hypotheses on joints with six degrees of freedom: quaternion, axes and order of the twist, kind of acceleration."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.kinematics import on_parents, turned, turned_back
from rttrr_pin.diagnosis.catalogue.slots import Slots, slots
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Input, Output, Values, Variant
from rttrr_pin.implementations.protocol import Batch


@dataclass(frozen=True, slots=True)
class BaseSlip:
    """What a program may make of q, v, a and tau of `{joint}`; None where it takes or gives them as they are."""

    id: str
    sentence: str
    repair: str
    input: Callable[[Model, Slots, Batch], Batch] | None = None
    output: Callable[[Model, Slots, Batch, Values], Values] | None = None


def base_conventions(model: Model) -> Iterator[Hypothesis]:
    """All of them, for each joint with six rates and a unit quaternion."""
    for own in slots(model):
        if not own.quaternions or len(own.v) != 6:
            continue
        for slip in SLIPS:
            yield Hypothesis(
                id=slip.id,
                kind="convention",
                sentence=slip.sentence.format(joint=own.name),
                repair=slip.repair.format(joint=own.name),
                apply=partial(_apply, slip=slip, own=own),
                joint=own.name,
            )


def _apply(variant: Variant, x: Sequence[float], slip: BaseSlip, own: Slots) -> Variant:
    model, altered = variant.model, variant
    if slip.input is not None:
        input: Input = partial(slip.input, model, own)
        altered = altered.with_input(input)
    if slip.output is not None:
        output: Output = partial(slip.output, model, own)
        altered = altered.with_output(output)
    return altered


def _quaternion(order: Sequence[int], sign: Sequence[float] = (1, 1, 1, 1)) -> Callable[[Model, Slots, Batch], Batch]:
    """(x, y, z, w) taken from these of the four numbers."""

    def inputs(model: Model, own: Slots, batch: Batch) -> Batch:
        q, first = batch.q.copy(), own.quaternions[0]
        q[:, first : first + 4] = batch.q[:, [first + k for k in order]] * np.array(sign)
        return replace(batch, q=q)

    return inputs


def _parts(x: Array, own: Slots) -> tuple[Array, Array]:
    """The linear and the angular half."""
    return x[:, own.v[:3]], x[:, own.v[3:]]


def _with(x: Array, own: Slots, linear: Array, angular: Array) -> Array:
    new = x.copy()
    new[:, own.v[:3]], new[:, own.v[3:]] = linear, angular
    return new


def _R(model: Model, own: Slots, batch: Batch) -> Array:
    """Of the joint's frame in that of what it floats in."""
    return on_parents(model, batch)[0][:, own.index]


def _world_twist(angular_too: bool) -> Callable[[Model, Slots, Batch], Batch]:
    """V and a as components in the world: v_i = R^T v, and the derivative of its components."""

    def inputs(model: Model, own: Slots, batch: Batch) -> Batch:
        R = _R(model, own, batch)
        (v, w), (a, w_dot) = _parts(batch.v, own), _parts(batch.a, own)
        w_i, w_dot_i = (turned_back(R, w), turned_back(R, w_dot)) if angular_too else (w, w_dot)
        v_i = turned_back(R, v)
        a_i = turned_back(R, a) - np.cross(w_i, v_i)
        return replace(batch, v=_with(batch.v, own, v_i, w_i), a=_with(batch.a, own, a_i, w_dot_i))

    return inputs


def _turned_twist(rates: bool) -> Callable[[Model, Slots, Batch], Batch]:
    """The numbers turned by R^T, and nothing else."""

    def inputs(model: Model, own: Slots, batch: Batch) -> Batch:
        R = _R(model, own, batch)
        a = _with(batch.a, own, *(turned_back(R, x) for x in _parts(batch.a, own)))
        v = _with(batch.v, own, *(turned_back(R, x) for x in _parts(batch.v, own))) if rates else batch.v
        return replace(batch, v=v, a=a)

    return inputs


def _acceleration(sign: float) -> Callable[[Model, Slots, Batch], Batch]:
    """A + sign w x v: the derivative of components is the acceleration of the point minus w x v."""

    def inputs(model: Model, own: Slots, batch: Batch) -> Batch:
        (v, w), (a, w_dot) = _parts(batch.v, own), _parts(batch.a, own)
        return replace(batch, a=_with(batch.a, own, a + sign * np.cross(w, v), w_dot))

    return inputs


def _angular_first(model: Model, own: Slots, batch: Batch) -> Batch:
    v, a = (_with(x, own, *_parts(x, own)[::-1]) for x in (batch.v, batch.a))
    return replace(batch, v=v, a=a)


def _tau_angular_first(model: Model, own: Slots, batch: Batch, values: Values) -> Values:
    tau = values["tau"]
    return {**values, "tau": _with(tau, own, *_parts(tau, own)[::-1])}


def _tau_in_world(angular_too: bool) -> Callable[[Model, Slots, Batch, Values], Values]:
    def outputs(model: Model, own: Slots, batch: Batch, values: Values) -> Values:
        R, tau = _R(model, own, batch), values["tau"]
        f, n = _parts(tau, own)
        return {**values, "tau": _with(tau, own, turned(R, f), turned(R, n) if angular_too else n)}

    return outputs


BODY = "v, a and tau of {joint} are components in its own frame"

SLIPS = (
    BaseSlip(
        "quaternion taken as w, x, y, z", "the quaternion of {joint} is taken for (w, x, y, z)",
        "pass it as (w, x, y, z), or take (x, y, z, w)", _quaternion((1, 2, 3, 0)),
    ),
    BaseSlip(
        "quaternion given as w, x, y, z",
        "the quaternion of {joint} is given as (w, x, y, z) and taken for (x, y, z, w)",
        "pass it as (x, y, z, w)", _quaternion((3, 0, 1, 2)),
    ),
    BaseSlip(
        "quaternion conjugated", "the quaternion of {joint} is conjugated: the rotation is R^T",
        "negate x, y and z of the quaternion of {joint}", _quaternion((0, 1, 2, 3), (-1, -1, -1, 1)),
    ),
    BaseSlip(
        "base twist in world axes", "v and a of {joint} are taken as components in world axes", BODY,
        _world_twist(angular_too=True),
    ),
    BaseSlip(
        "base twist and tau in world axes", "v, a and tau of {joint} are components in world axes", BODY,
        _world_twist(angular_too=True), _tau_in_world(angular_too=True),
    ),
    BaseSlip(
        "base linear rates in world axes",
        "the linear rates, accelerations and forces of {joint} are in world axes, the angular ones in its own",
        BODY, _world_twist(angular_too=False), _tau_in_world(angular_too=False),
    ),
    BaseSlip(
        "base twist turned", "v and a of {joint} are turned by R^T, without w x v in a", BODY, _turned_twist(rates=True)
    ),
    BaseSlip(
        "base acceleration in world axes", "a of {joint} is taken in world axes, v in its own", BODY,
        _turned_twist(rates=False),
    ),
    BaseSlip(
        "base tau in world axes", "tau of {joint} is in world axes", BODY, output=_tau_in_world(angular_too=True)
    ),
    BaseSlip(
        "base acceleration of the point",
        "a of {joint} is taken for the acceleration of its origin, not for the derivative of components of v",
        "add w x v to the linear part of a, or subtract it within", _acceleration(-1.0),
    ),
    BaseSlip(
        "base acceleration of the point, inverted",
        "w x v is added to the linear part of a of {joint}, which is the derivative of components of v already",
        "use a of {joint} as it is", _acceleration(1.0),
    ),
    BaseSlip(
        "base, angular first", "v, a and tau of {joint} have the angular part before the linear one",
        "give the linear part first", _angular_first, _tau_angular_first,
    ),
    BaseSlip(
        "base tau, angular first", "tau of {joint} has the moment before the force", "give the force first",
        output=_tau_angular_first,
    ),
)  # fmt: skip
