"""Ratings of gears, and the lives that follow from them."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from rttrr_pin.core.arguments import not_negative, path_of
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, UnknownNameError, shortened
from rttrr_pin.loads.parts import GearLife
from rttrr_pin.urdf.files import read_limited

LARGEST_FILE = 2**20
"""Bytes."""

RPM = 60.0 / (2.0 * math.pi)
"""Revolutions per minute in one radian per second."""

EXAMPLE = """[joint_1]
ratio = 100
rated_torque = 67     # N m, of the output
rated_speed = 2000    # rpm, of the input
rated_life = 35000    # h"""


@dataclass(frozen=True, slots=True)
class GearRating:
    """What the maker of a gear says.

    Attributes:
        ratio: turns of the input for one of the output.
        rated_torque: T_N, of the output at the rated speed [N m].
        rated_speed: n_N, of the input [rpm].
        rated_life: L_n, hours at both that half of the gears outlive [h].
    """

    ratio: float
    rated_torque: float
    rated_speed: float
    rated_life: float

    def life(self, mean_speed: float, torque: float | None) -> GearLife:
        """The life where the joint runs at a mean speed [rad/s] under a cubic-mean torque [N m], None at rest.

        L50 = L_n (n_N / n_av) (T_N / T_av)^3,   L10 = L50 / 5
        """
        speed = abs(self.ratio) * mean_speed * RPM
        if torque is None or torque == 0.0 or speed == 0.0:
            l50 = math.inf
        else:
            l50 = self.rated_life * (self.rated_speed / speed) * (self.rated_torque / torque) ** 3
        return GearLife(self.ratio, self.rated_torque, self.rated_speed, self.rated_life, speed, l50, l50 / 5.0)


NUMBERS = tuple(own.name for own in fields(GearRating))


Ratings = Mapping[str, GearRating]
"""By name of the joint."""


def read_ratings(path: str | Path, model: Model) -> dict[str, GearRating]:
    """The ratings in a TOML file: a table for each joint, with ratio, rated_torque, rated_speed and rated_life.

    Raises:
        InputError: the file cannot be read, or a table lacks a number, or has another, or one that is not positive.
        UnknownNameError: no joint is called as a table is.
    """
    where = path_of("ratings", path)
    try:
        content = read_limited(where, LARGEST_FILE)
    except (OSError, ValueError) as error:  # of a name that no file has, too
        raise InputError(f"{where} cannot be read: {getattr(error, 'strerror', None) or error}") from error
    try:
        data = tomllib.loads(content.decode())
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as error:
        raise InputError(f"{where} is no TOML: {error}; write, for each joint with a gear:\n{EXAMPLE}") from error
    if not data:
        raise InputError(f"{where} is empty: write, for each joint with a gear:\n{EXAMPLE}")
    return checked_ratings(data, model, f"{where}: ")


def checked_ratings(data: Mapping[str, Any], model: Model, where: str = "") -> dict[str, GearRating]:
    """Ratings by joint, each a `GearRating` or a dict with its numbers; `where` stands before messages.

    Raises:
        InputError, UnknownNameError: as in `read_ratings`.
    """
    if not isinstance(data, Mapping):
        raise InputError(
            f"ratings is a {type(data).__name__}: pass a dict from joint name to GearRating(...), or a path"
        )
    turning = {joint.name for joint in model.moving if joint.type.rotates}
    checked = {}
    for name, own in data.items():
        if name not in turning:
            raise _no_gear(name, model, turning, where)
        if isinstance(own, GearRating):
            own = {number: getattr(own, number) for number in NUMBERS}
        checked[name] = _rating(own, f"{where}{name}")
    return checked


def _no_gear(name: object, model: Model, turning: set[str], where: str) -> InputError:
    joint = next((own for own in model.joints if own.name == name), None)
    if joint is None:
        return UnknownNameError("joint", name, sorted(turning), f"{where}a table is called as a joint that turns")
    if joint.mimic is not None:
        leader = model.joints[joint.mimic.joint].name
        return InputError(f"{where}{name} follows {leader}, whose torque counts both: rate the gear of {leader}")
    return InputError(f"{where}{name} is {joint.type}: the life of a gear is that of a joint that turns; leave it out")


def _rating(own: Any, where: str) -> GearRating:
    if not isinstance(own, Mapping):
        raise InputError(f"{where} is {shortened(repr(own))}: expected a table with {', '.join(NUMBERS)}")
    for key in own:
        if key not in NUMBERS:
            raise UnknownNameError("rating", key, NUMBERS, f"in {where}")
    missing = [number for number in NUMBERS if number not in own]
    if missing:
        raise InputError(f"{where} lacks {', '.join(missing)}: a gear has {', '.join(NUMBERS)}")
    values = {number: not_negative(f"{number} of {where}", own[number], number) for number in NUMBERS}
    for number, value in values.items():
        if value == 0.0:
            raise InputError(f"{number} of {where} is 0: expected a positive number")
    return GearRating(**values)
