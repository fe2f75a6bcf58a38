"""What is viewed: one state of a robot, and what sliders can set of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load

NO_LIMIT = 1e9
"""Beyond it a limit says that there is none."""

OPEN = {"rad": math.pi, "m": 1.0}
"""Half range of a coordinate, and the largest rate, where the file leaves them open."""

ACCELERATION = 10.0
"""Largest acceleration of a slider, per second squared."""

STEPS = 500
"""Steps of a slider, at least."""


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """One state of a robot.

    Attributes:
        q: coordinates, (nq,) [rad or m].
        v: rates, (nv,).
        a: accelerations, (nv,).
        loads: payloads, each with vectors (3,).
    """

    q: Array
    v: Array
    a: Array
    loads: tuple[Load, ...] = ()


def at_rest(model: Model) -> State:
    """At coordinate zero where the limits allow it, else at the limit that is next to zero."""
    displacement = np.array([min(max(0.0, slider.low), slider.high) for slider in sliders(model)["q"]])
    q = model.coordinates_at(displacement.reshape(1, model.nv))[0]
    return State(q, np.zeros(model.nv), np.zeros(model.nv))


@dataclass(frozen=True, slots=True)
class Slider:
    """A number that a slider sets: of q the displacement along one degree of freedom.

    Attributes:
        label: what it is called.
        unit: of the number.
        low: its least value, a multiple of `step`.
        high: its largest.
        step: a power of ten.
    """

    label: str
    unit: str
    low: float
    high: float
    step: float

    @property
    def digits(self) -> int:
        """Digits behind the point."""
        return max(0, -round(math.log10(self.step)))

    def shown(self, value: float) -> float:
        """The value where a slider can show it: the nearest step within its ends."""
        return min(max(round(value, self.digits), self.low), self.high)


def slider(label: str, unit: str, low: float, high: float) -> Slider:
    """A slider within limits; its ends are multiples of its step, so that zero can be set."""
    span = high - low
    if not span > 0.0:
        return Slider(label, unit, low, high, 1.0)
    step = 10.0 ** math.floor(math.log10(span / STEPS))
    slack = 1e-6  # a limit that is a multiple itself, but for rounding
    digits = max(0, -round(math.log10(step)))
    low, high = math.ceil(low / step - slack) * step, math.floor(high / step + slack) * step
    return Slider(label, unit, round(low, digits) + 0.0, round(high, digits) + 0.0, step)


def sliders(model: Model) -> dict[str, tuple[Slider, ...]]:
    """For q, v and a, a slider for each degree of freedom; of a floating joint's rotation the rotation vector."""
    out: dict[str, list[Slider]] = {"q": [], "v": [], "a": []}
    for joint in model.moving:
        for label, rotates in zip(joint.v_labels(), joint.type.rotations, strict=True):
            unit = "rad" if rotates else "m"
            out["q"].append(slider(label, unit, *_range(joint, OPEN[unit])))
            rate = joint.limits.velocity
            rate = rate if 0.0 < rate < NO_LIMIT else OPEN[unit]
            out["v"].append(slider(label, f"{unit}/s", -rate, rate))
            out["a"].append(slider(label, f"{unit}/s²", -ACCELERATION, ACCELERATION))
    return {name: tuple(own) for name, own in out.items()}


def _range(joint: Joint, half: float) -> tuple[float, float]:
    """The limits of a coordinate; finite ones where the file has none."""
    low, high = joint.limits.lower, joint.limits.upper
    if joint.nv > 1 or low >= high:
        return -half, half
    low = low if low > -NO_LIMIT else min(-half, high - 2.0 * half)
    return low, high if high < NO_LIMIT else max(half, low + 2.0 * half)


def displacement(model: Model, q: Array) -> Array:
    """The displacement from zero along each degree of freedom that leads to coordinates: `coordinates_at` reversed.

    Args:
        model: the robot.
        q: coordinates, (nq,).

    Returns:
        (nv,); of a quaternion the rotation vector, of at most pi.
    """
    out: list[float] = []
    at = 0
    while at < model.nq:
        if at in model.quaternions:
            out += rotation_vector(q[at : at + 4]).tolist()
            at += 4
        else:
            out.append(float(q[at]))
            at += 1
    return np.array(out)


def rotation_vector(quaternion: Array) -> Array:
    """The rotation vector of a unit quaternion (x, y, z, w), of at most pi [rad]."""
    axis, w = quaternion[:3], float(quaternion[3])
    if w < 0.0:
        axis, w = -axis, -w
    sine = float(np.linalg.norm(axis))
    return axis * (2.0 * math.atan2(sine, w) / sine) if sine > 0.0 else np.zeros(3)


def moved(model: Model, state: State, name: str, k: int, value: float) -> State:
    """The state with one number set by its slider: of q, v or a, by its place among the degrees of freedom."""
    if name == "q":
        own = displacement(model, state.q)
        own[k] = value
        return replace(state, q=model.coordinates_at(own.reshape(1, model.nv))[0])
    numbers = np.array(getattr(state, name))
    numbers[k] = value
    return replace(state, v=numbers) if name == "v" else replace(state, a=numbers)
