"""Strategies of Hypothesis: robots, and states of one, that shrink to few links and round numbers.

A test that takes a robot with a state draws both by `robots_in_motion`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from rttrr_pin.conformance.kit.drawn import AXES, DrawnBody, DrawnJoint, DrawnRobot, text_of
from rttrr_pin.core.arguments import choice, whole_number
from rttrr_pin.core.arrays import Array
from rttrr_pin.errors import InputError, UnknownNameError
from rttrr_pin.loading import load
from rttrr_pin.robot import Robot
from rttrr_pin.validation.sampling import ACCELERATION, Ranges
from rttrr_pin.validation.states import model_of

if TYPE_CHECKING:
    from hypothesis.strategies import SearchStrategy

__all__ = ["TYPES", "State", "robots", "robots_in_motion", "states"]

TYPES = ("revolute", "prismatic", "continuous", "planar", "floating", "fixed")
"""Types of joints, the simplest first."""

MOST = 60
"""Links of a robot."""

REACH, TURN, HALF = 5, 31, 6
"""Tenths: of positions [m], of angles [rad], of what a body extends to about its centre of mass [m sqrt(kg)]."""

SIX, RANGES = 6, (20, 30, 100)
"""Degrees of freedom of a joint at most, and the largest tenths of q, v and a."""

BALL = (1, 0, 1, 0, 0, 1)
"""Tenths: the lower triangle of the simplest factor of second moments."""


class State(NamedTuple):
    """One state: q, v, a. Coordinates (nq,) [rad or m], rates (nv,) and accelerations (nv,)."""

    q: Array
    v: Array
    a: Array


def robots(
    most_links: int = 6,
    types: Sequence[str] = TYPES,
    trees: bool = True,
    mimic: bool = True,
    base: Literal["fixed", "floating"] = "fixed",
) -> SearchStrategy[Robot]:
    """Robots, each read from the text of a URDF that Hypothesis shows with a failing example.

    Every inertia is that of a possible body. The simplest robot has one link on one joint of the first of the types,
    and numbers of few digits.

    Args:
        most_links: how many links there are at most, besides the base.
        types: of joints, some of `TYPES`, the simplest first.
        trees: whether links may carry several others; else each carries one.
        mimic: whether joints may follow others.
        base: "fixed" or "floating", as in `load`.

    Raises:
        InputError: an argument cannot be used, or hypothesis is not installed.
        UnknownNameError: there is no such type of joint.
    """
    drawn = _drawn(most_links, types, trees, mimic, base, moving=False)
    return drawn.map(lambda parts: _robot(parts, base))  # type: ignore[no-any-return]


def robots_in_motion(
    most_links: int = 6,
    types: Sequence[str] = TYPES,
    trees: bool = True,
    mimic: bool = True,
    base: Literal["fixed", "floating"] = "fixed",
) -> SearchStrategy[tuple[Robot, State]]:
    """Robots as `robots` draws them, each with a state: a link that is left out takes its part of the state with it.

    So what fails shrinks further than by `states` of a robot that was drawn before.

    Args:
        most_links: as in `robots`, and so are the others.
        types: of joints.
        trees: whether links may carry several others.
        mimic: whether joints may follow others.
        base: "fixed" or "floating".

    Raises:
        InputError: an argument cannot be used, or hypothesis is not installed.
        UnknownNameError: there is no such type of joint.
    """
    drawn = _drawn(most_links, types, trees, mimic, base, moving=True)

    def made(parts: DrawnRobot) -> tuple[Robot, State]:
        robot = _robot(parts, base)
        return robot, _state(robot, parts)

    return drawn.map(made)  # type: ignore[no-any-return]


def _drawn(most_links: int, types: Sequence[str], trees: bool, mimic: bool, base: str, moving: bool) -> Any:
    """The parts of a robot, with their motion or without."""
    st = _strategies()
    most = whole_number("most_links", most_links, 1, MOST, str(MOST))
    choice("base", base, "fixed", "floating")
    own = [types] if isinstance(types, str) else list(types)
    for kind in own:
        if kind not in TYPES:
            raise UnknownNameError("type of joint", kind, TYPES)
    if base == "fixed" and not set(own) - {"fixed"}:
        raise InputError(f"types are {own}: expected at least one that moves, such as 'revolute'")
    body = st.builds(
        DrawnBody,
        st.integers(-9, 40).map(lambda k: 10 + k),
        _tenths(REACH),
        st.just(BALL) | st.tuples(*(st.integers(1 if own else -HALF, HALF) for own in BALL)),
    )
    joints = st.builds(
        DrawnJoint,
        st.sampled_from(own),
        st.integers(0, most if trees else 0),
        st.integers(0, most if mimic else 0),
        _tenths(REACH),
        _tenths(TURN),
        st.sampled_from(AXES) | st.tuples(*[st.integers(-2, 2)] * 3).filter(any),
        body,
        _motion() if moving else st.just(()),
    )
    chains = st.lists(joints, min_size=1, max_size=most).filter(lambda all: base == "floating" or _moves(all))
    if base != "floating":
        return st.builds(DrawnRobot, st.none(), st.just(()), chains)
    return st.builds(DrawnRobot, body, _motion() if moving else st.just(()), chains)


def states(robot: Robot) -> SearchStrategy[State]:
    """States of a robot within the limits of its file, in round numbers: q, v, a, to be called as f(*state).

    Coordinates and rates are within the limits of the file; where it has none, within half a turn and half a turn per
    second [m, m/s]. The simplest state is at zero, or as near to it as the limits allow, and at rest.

    Raises:
        InputError: the robot has no joint, or hypothesis is not installed.
    """
    st = _strategies()
    model = model_of(robot, "there is nothing to draw")
    ranges = Ranges.of(model)

    def made(q: Sequence[float], v: Sequence[float], a: Sequence[float]) -> State:
        return State(model.coordinates_at(np.array([q], dtype=float))[0], np.array(v, float), np.array(a, float))

    acceleration = np.full(model.nv, ACCELERATION)
    pairs = ((ranges.lower, ranges.upper), (-ranges.rate, ranges.rate), (-acceleration, acceleration))
    drawn: SearchStrategy[State] = st.builds(made, *(_numbers(*pair) for pair in pairs))
    return drawn


def _strategies() -> Any:
    """The module of Hypothesis."""
    try:
        from hypothesis import strategies
    except ImportError as error:
        raise InputError(
            "strategies need the package 'hypothesis', which is not installed: pip install 'rttrr-pin[hypothesis]'"
        ) from error
    return strategies


def _tenths(most: int, count: int = 3) -> Any:
    """Some numbers; often zero, to which all of them shrink at once."""
    st = _strategies()
    return st.just((0,) * count) | st.tuples(*[st.integers(-most, most)] * count)


def _motion() -> Any:
    """Tenths q, v, a of a joint of up to six."""
    return _strategies().tuples(*(_tenths(most, SIX) for most in RANGES))


def _state(robot: Robot, parts: DrawnRobot) -> State:
    """The numbers of each joint, in the order of the model."""
    own = {f"joint_{i + 1}": joint.motion for i, joint in enumerate(parts.joints)}
    rows = [(own.get(joint.name, parts.motion), joint.nv) for joint in robot.model.moving]
    q, v, a = (np.array([x / 10 for motion, nv in rows for x in motion[k][:nv]], dtype=float) for k in range(3))
    return State(robot.model.coordinates_at(q[None])[0], v, a)


def _numbers(lower: Array, upper: Array) -> Any:
    """A number for each degree of freedom."""
    return _strategies().tuples(*(_round(*pair) for pair in zip(lower.tolist(), upper.tolist(), strict=True)))


def _round(lower: float, upper: float) -> SearchStrategy[float]:
    """Numbers of few digits within a range, those near zero the simplest; its lower end where there is none."""
    st, digits = _strategies(), 1
    if upper > lower:
        digits = max(1, 1 - math.floor(math.log10(upper - lower)))
    scale = 10**digits
    first, last = math.ceil(lower * scale), math.floor(upper * scale)
    return st.integers(first, last).map(lambda k: k / scale) if first <= last else st.just(lower)  # type: ignore[no-any-return]


def _moves(joints: Sequence[DrawnJoint]) -> bool:
    return any(own.kind != "fixed" for own in joints)


def _robot(parts: DrawnRobot, base: Literal["fixed", "floating"]) -> Robot:
    """The robot of what was drawn; a failing example shows its text."""
    text = text_of(parts.root, parts.joints)
    from hypothesis import currently_in_test_context, note

    if currently_in_test_context():
        note(text)
    return load(text, base=base)
