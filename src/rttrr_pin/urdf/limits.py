"""The limits of joints, those that the file sets and those that other parsers ask for; damping and friction."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from rttrr_pin.core.joints import JointType
from rttrr_pin.urdf.decimals import Number
from rttrr_pin.urdf.elements import Element
from rttrr_pin.urdf.vocabulary import ATTRIBUTES, LIMITS_1_2

UNLIMITED = "1e9"
"""What is written for a limit that the file does not set, and urdfdom asks for."""


def read_limit(joint: Element, joint_type: JointType, version: tuple[int, int]) -> dict[str, Number] | None:
    """Those limits that the file sets; of a joint that has no use for them they may be anything."""
    used = joint_type.has_direction
    limit = joint.child("limit", used)
    written = [key for key in ATTRIBUTES["limit"] if limit is not None and key in limit.xml.attrib]
    if joint.log.lenient:
        _complete_limit(joint, limit, joint_type, version)
    if limit is None:
        return None
    limits_1_2 = [key for key in LIMITS_1_2 if version >= (1, 2) and key in limit.xml.attrib]
    _check_unused(limit, limits_1_2 if used else [*written, *limits_1_2], limits_1_2)
    numbers = {key: limit.number(key) for key in written if used or not limit.problem(key)}
    if not used:
        return numbers
    for key in ("velocity", "effort"):
        if key in numbers and float(numbers[key]) < 0.0:
            limit.assume(
                "limit", f"{key} limit is {float(numbers[key])}: expected a positive number", f"no {key} limit", key
            )
            limit.write(**{key: UNLIMITED})
            del numbers[key]
    lower, upper = (numbers.get(key, Number("0")) for key in ("lower", "upper"))
    if joint_type.limits != "none" and float(lower) > float(upper):
        message = f"lower limit {float(lower)} is above the upper one, {float(upper)}: "
        one = "" if {"lower", "upper"} <= numbers.keys() else "lower" if "lower" in numbers else "upper"
        message += "write both, since 0 stands for none" if one else "exchange them"
        limit.assume("range", message, f"a range from {float(upper)} to {float(lower)}", one)
        limit.write(lower=upper.text, upper=lower.text)
        numbers |= {"lower": upper, "upper": lower}
    return numbers


def read_dynamics(joint: Element) -> dict[str, Number]:
    """Damping and friction, where given, are numbers that are not negative."""
    dynamics = joint.child("dynamics")
    numbers = {key: Number("0") for key in ATTRIBUTES["dynamics"]}
    for key in numbers:
        if dynamics is not None and key in dynamics.xml.attrib:
            numbers[key] = dynamics.number(key)
            if float(numbers[key]) < 0.0:
                message = f"{key} is {numbers[key].text}: expected a number that is not negative"
                dynamics.assume("dynamics", message, f"{key} 0", key)
                dynamics.write(**{key: "0"})
                numbers[key] = Number("0")
    return numbers


def _check_unused(limit: Element, keys: Iterable[str], positive: Collection[str]) -> None:
    """Limits that the model has no use for: urdfdom refuses what it cannot read of them."""
    for key in keys:
        problem = limit.problem(key)
        if not problem and key in positive and float(limit.xml.get(key)) < 0.0:
            problem = f"{key} limit is negative"
        if problem:
            limit.note("unused", problem, key)


def _complete_limit(joint: Element, limit: Element | None, joint_type: JointType, version: tuple[int, int]) -> None:
    """Write out what urdfdom asks for: what the file does not limit is unlimited."""
    if limit is None:
        if joint_type.limits == "required":
            message = f'a {joint_type.name} joint has no <limit>: write <limit lower="..." upper="..." .../>'
            joint.assume("asked", message, "no limits")
            joint.added("limit", lower=f"-{UNLIMITED}", upper=UNLIMITED, effort=UNLIMITED, velocity=UNLIMITED)
        return
    missing = [key for key in ("effort", "velocity") if key not in limit.xml.attrib]
    if missing and version < (1, 2):
        limit.assume("asked", f"its <limit> has no {' and no '.join(missing)}", f"no {' and '.join(missing)} limit")
        limit.write(**dict.fromkeys(missing, UNLIMITED))
