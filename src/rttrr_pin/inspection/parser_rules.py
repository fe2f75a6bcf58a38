"""Where the rules of parsers apply that take more than a glance at a joint: names of joints and links.

A *test* yields names and how the parser's test of each comes out. Thresholds and tolerances are the parsers'. Where a
tensor lies nearer to a threshold than the parser's own rounding, no rule can say what it does: the test comes out as
"rounding", for which there is a rule with the verdict "either".
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.inspection.bodies import principal
from rttrr_pin.inspection.merged import anchored, merged_links
from rttrr_pin.urdf.decimals import Number, NumberList
from rttrr_pin.urdf.document import UrdfDocument, UrdfJoint
from rttrr_pin.urdf.inertial import Placement, UrdfInertial

EPS = float(np.finfo(np.float64).eps)

SMALLEST_EIGENVALUE, SMALLEST_MOVING, SMALLEST_PRODUCT = 1e-14, 1e-15, 1e-12
"""MuJoCo's mjEPS, mjMINVAL and, before version 3.14, kEigEPS."""

NEGLIGIBLE = 1e-6
"""Of the trace: what MuJoCo drops or leaves unturned of a tensor is reported where it is more. Half a turn by 3.141593
is written as half a turn."""

JACOBI = 4e-12
"""MuJoCo's Jacobi iteration stops, before version 3.14, at products of 1e-12, or at rotations of 1.4e-6: its
eigenvalues err by that much."""

DRAKE_EPS, GAZEBO_EPS = 16.0 * EPS, 5.0 * EPS
"""Of max(1, trace / 2), and of the trace."""

GAZEBO_DIAGONAL, GAZEBO_ROUNDING = 1e-6, 1e-7
"""gz-math takes products below a millionth of the largest moment for zero; else its moments come from an arccosine,
which loses half of the digits where two moments are equal."""


def inertials(document: UrdfDocument, moving: bool = False) -> Iterator[tuple[str, UrdfInertial]]:
    """Of all links that have one, or of those that do not belong to the world."""
    left_out = anchored(document) if moving else ()
    for name, link in document.links.items():
        if link.inertial is not None and name not in left_out:
            yield name, link.inertial


def _products(tensor: Array) -> float:
    """The largest product of inertia."""
    return float(max(abs(tensor[0, 1]), abs(tensor[0, 2]), abs(tensor[1, 2])))


def _sorted_moments(tensor: Array, negligible: float = 0.0) -> Array:
    """Principal moments, ascending; the diagonal itself, not rounded, where all products are negligible."""
    if _products(tensor) <= negligible:
        return np.sort(tensor.diagonal())
    return principal(tensor)[0]


CUT_OFF = re.compile(r"\S[\t\n]|[\t\n]( |$)")
"""In a vector, which urdfdom splits at spaces: a tab or line end that does not lead a number."""


def _unparsed(numbers: Iterable[Number], vectors: Iterable[NumberList]) -> bool:
    """Whether urdfdom takes a number for none: it lets blanks stand before a number, and none behind it."""
    blank_behind = any(number.text != number.text.rstrip() for number in numbers)
    return blank_behind or any(CUT_OFF.search(vector.text) for vector in vectors)


def _turn(origin: Placement) -> NumberList:
    """The angles or the quaternion."""
    return origin.quaternion or origin.rpy


def unparsed_joint(joint: UrdfJoint) -> bool:
    """Whether urdfdom takes a number of the joint for none, although XML allows the blanks around it."""
    numbers = [joint.damping, joint.friction, *(joint.limit or {}).values()]
    numbers += [joint.mimic.multiplier, joint.mimic.offset] if joint.mimic else []
    vectors = [joint.origin.xyz, _turn(joint.origin), joint.axis]
    return _unparsed(numbers, vectors)


def unparsed_inertial(inertial: UrdfInertial) -> str:
    """What of an <inertial> urdfdom drops for that, and goes on; empty where it reads all."""
    if _unparsed((inertial.mass,), (inertial.origin.xyz, _turn(inertial.origin))):
        return "the whole <inertial> is dropped, mass too"
    return "the tensor is 0" if _unparsed(inertial.entries.values(), ()) else ""


def floating_on_moving(document: UrdfDocument) -> Iterator[str]:
    """Floating joints on links that are not fixed to the root."""
    still, joints = anchored(document), document.joints.values()
    return (joint.name for joint in joints if joint.type == "floating" and joint.parent not in still)


def pinocchio_sum(document: UrdfDocument) -> Iterator[str]:
    """Moving links whose mass, with what is fixed to them, is below eps, and matters."""
    for name, merged in merged_links(document).items():
        members = [document.links[member].inertial for member in merged.members]
        massive = sum(inertial is not None and inertial.mass.exact != 0 for inertial in members)
        if name != document.root and merged.mass < EPS and (massive > 1 or merged.moment.any()):
            yield name


def mujoco_test(document: UrdfDocument) -> Iterator[tuple[str, str]]:
    """The test of tensors that MuJoCo fails, first of the moments, then of the triangle; six zeros it does not test."""
    for name, inertial in inertials(document):
        if inertial.tensor.any():
            low, mid, high = (float(x) for x in _sorted_moments(inertial.tensor))
            slack = JACOBI * (1.0 + abs(low) + abs(mid) + abs(high)) if _products(inertial.tensor) else 0.0
            smallest, triangle = low - SMALLEST_EIGENVALUE, (low + mid) - high
            if smallest < -slack:
                yield name, "eigenvalue"
            elif triangle < -slack:
                yield name, "triangle"
            elif min(smallest, triangle) < slack:
                yield name, "rounding"


def mujoco_minimum(document: UrdfDocument) -> Iterator[str]:
    """Moving links with too little mass or inertia; collision shapes stand in for a missing <inertial>."""
    for name, merged in merged_links(document, massive_only=True).items():
        if name == document.root or any(_from_shapes(document, member) for member in merged.members):
            continue
        smallest = SMALLEST_MOVING if len(merged.members) == 1 else SMALLEST_EIGENVALUE
        if merged.mass < SMALLEST_MOVING or float(_sorted_moments(merged.inertia)[0]) < smallest:
            yield name


def _from_shapes(document: UrdfDocument, name: str) -> bool:
    """Whether MuJoCo takes mass and inertia of a link from its collision shapes."""
    link = document.links[name]
    return link.inertial is None and any(shape.role == "collision" for shape in link.shapes)


def mujoco_negative(document: UrdfDocument) -> Iterator[str]:
    """Negative masses of links that are merged; of a link by itself, that is too little mass."""
    several = {name for merged in merged_links(document).values() if len(merged.members) > 1 for name in merged.members}
    moving = inertials(document, moving=True)
    return (name for name, inertial in moving if name in several and inertial.mass.exact < 0)


def mujoco_massless_tensor(document: UrdfDocument) -> Iterator[str]:
    """Inertia without mass that is merged into a link."""
    for name, inertial in inertials(document, moving=True):
        massless = 0 <= inertial.mass.exact < SMALLEST_MOVING
        if massless and not document.carried_by[name].moves and inertial.tensor.any():
            yield name


def mujoco_geometry(document: UrdfDocument) -> Iterator[str]:
    """Links with collision shapes but without <inertial>, unless they belong to the world."""
    still = anchored(document)
    return (name for name in document.links if name not in still and _from_shapes(document, name))


def mujoco_products(inertial: UrdfInertial) -> bool:
    """Products below 1e-12 that are not negligible."""
    return NEGLIGIBLE * abs(float(np.trace(inertial.tensor))) < _products(inertial.tensor) < SMALLEST_PRODUCT


def differ(turned: Array, tensor: Array) -> bool:
    """Whether turning a tensor makes another one."""
    return bool(np.linalg.norm(turned - tensor) > NEGLIGIBLE * abs(float(np.trace(tensor))))


def mujoco_fused(document: UrdfDocument) -> Iterator[str]:
    """Merged links of which MuJoCo exchanges the placement and the inertial frame, or turns the tensor twice."""
    for base, merged in merged_links(document).items():
        R, p = document.placements[base]
        for name in merged.members[1:] if base != document.root else ():
            inertial, (R_member, p_member) = document.links[name].inertial, document.placements[name]
            if inertial is None or inertial.mass.exact < SMALLEST_MOVING:
                continue
            if _misplaced(inertial, R.T @ R_member, R.T @ (p_member - p)):
                yield name


def _misplaced(inertial: UrdfInertial, R: Array, p: Array) -> bool:
    """Whether it matters that a link at R, p is merged in the wrong order, or turned twice.

    MuJoCo's inertial frame has principal axes, by falling moment: it is turned against the link where there are
    products, or where moments rise. Shifts alone can be exchanged.
    """
    tensor = inertial.tensor
    axes_turned = bool(_products(tensor)) or bool(np.any(np.diff(tensor.diagonal()) > 0.0))
    if np.allclose(R, np.eye(3), rtol=0.0, atol=NEGLIGIBLE):
        return axes_turned and bool(np.any(np.abs(p) > NEGLIGIBLE))
    return axes_turned or bool(inertial.origin.p.any()) or differ(R @ tensor @ R.T, tensor)


def _outcome(moments: Array, tolerance: float, rounding: float) -> str:
    """Whether triangle inequality or positivity is violated by more than a tolerance."""
    low, mid, high = (float(x) for x in moments)
    excess = max(high - mid - low, -low) - tolerance
    return "rounding" if abs(excess) <= rounding else "invalid" if excess > 0.0 else "valid"


def drake_test(document: UrdfDocument) -> Iterator[tuple[str, str]]:
    """Drake's test of tensors."""
    for name, inertial in inertials(document):
        moments = _sorted_moments(inertial.tensor)
        rounding = 8.0 * EPS * float(np.abs(inertial.tensor).max())
        yield name, _outcome(moments, DRAKE_EPS * max(1.0, float(moments.sum()) / 2.0), rounding)


def gazebo_test(document: UrdfDocument) -> Iterator[tuple[str, str]]:
    """gz-math's test of what becomes an SDFormat link: not the world, and none without mass or beyond one."""
    dropped = set(gazebo_massless(document))
    for _, name in document.walk():
        joint = document.carried_by.get(name)
        if joint is not None and joint.parent in dropped:
            dropped.add(name)
    for name, merged in merged_links(document, spare="world").items():
        if name != "world" and not dropped & set(merged.members):
            largest = float(np.abs(merged.inertia).max())
            diagonal = _products(merged.inertia) <= GAZEBO_DIAGONAL * largest
            moments = _sorted_moments(merged.inertia, GAZEBO_DIAGONAL * largest)
            rounding = (4.0 * EPS if diagonal and len(merged.members) == 1 else GAZEBO_ROUNDING) * largest
            yield name, _outcome(moments, GAZEBO_EPS * abs(float(moments.sum())), rounding)


def gazebo_massless(document: UrdfDocument) -> Iterator[str]:
    """Links whose mass, with what is fixed to them, is not above zero."""
    merged = merged_links(document, spare="world").items()
    return (name for name, body in merged if name != "world" and body.mass <= 0.0)


def gazebo_empty(document: UrdfDocument) -> Iterator[str]:
    """The root among these."""
    return (name for name in gazebo_massless(document) if name == document.root)


def kdl_root(document: UrdfDocument) -> Iterator[str]:
    """The root, where it has an <inertial>."""
    return (name for name, _ in inertials(document) if name == document.root)


def without_effort(document: UrdfDocument) -> Iterator[str]:
    """Joints with a <limit> that lacks effort or velocity, before version 1.2 of the format."""
    limited = ((joint.name, joint.limit) for joint in document.joints.values() if document.version < (1, 2))
    return (name for name, limit in limited if limit is not None and not {"effort", "velocity"} <= limit.keys())
