"""The table of all checks, in the order of their ids."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rttrr_pin.errors import UnknownNameError
from rttrr_pin.inspection import joints, mirrored_links, physics, plausibility
from rttrr_pin.inspection.check import Check, Observation, Subject
from rttrr_pin.inspection.results import Severity


def root_inertia(subject: Subject) -> Iterator[Observation]:
    """The root has an <inertial>, and is no link of its own that stands for the world."""
    root = subject.document.links[subject.document.root]
    if root.inertial is not None and root.inertial.mass.exact != 0:
        yield Observation(
            root, float(root.inertial.mass), "kg",
            "the root link has a mass: a fixed base does not feel it, and KDL leaves it out",
            "for KDL, add a root link without mass and fix this one to it",
        )  # fmt: skip


CHECKS = (
    *physics.CHECKS,
    *plausibility.CHECKS,
    *mirrored_links.CHECKS,
    *joints.CHECKS,
    Check("C501", Severity.NOTE, "The root link has no mass.", root_inertia),
)


def chosen(select: Iterable[str] = (), ignore: Iterable[str] = ()) -> tuple[Check, ...]:
    """The checks whose ids begin with one of the prefixes.

    Args:
        select: prefixes of the checks to run, such as `"P"` or `"P105"`; none means all.
        ignore: prefixes of checks to leave out of those.

    Raises:
        UnknownNameError: a prefix fits no check.
    """
    wanted, unwanted = tuple(select), tuple(ignore)
    for prefix in (*wanted, *unwanted):
        if not prefix or not any(check.id.startswith(prefix) for check in CHECKS):
            raise UnknownNameError("check", prefix, [check.id for check in CHECKS])
    kept = (check for check in CHECKS if not wanted or check.id.startswith(wanted))
    return tuple(check for check in kept if not (unwanted and check.id.startswith(unwanted)))
