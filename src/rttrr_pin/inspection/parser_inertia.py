"""Where the rules of parsers about mass and inertia apply: each function yields the names of links.

Thresholds and tolerances are the parsers'. Where a tensor lies nearer to a threshold than the parser's own
rounding, no rule can say what it does, and a rule with the verdict "either" says so.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.inspection.bodies import principal
from rttrr_pin.inspection.merged_links import merged_links
from rttrr_pin.urdf.decimals import blank_behind, other_blanks
from rttrr_pin.urdf.document import UrdfDocument, UrdfInertial

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


def _inertials(document: UrdfDocument) -> Iterator[tuple[str, UrdfInertial]]:
    return ((name, link.inertial) for name, link in document.links.items() if link.inertial is not None)


def _products(tensor: Array) -> float:
    """The largest product of inertia."""
    return float(max(abs(tensor[0, 1]), abs(tensor[0, 2]), abs(tensor[1, 2])))


def _sorted_moments(tensor: Array, negligible: float) -> Array:
    """Principal moments, ascending; the diagonal itself, not rounded, where all products are negligible."""
    if _products(tensor) <= negligible:
        return np.sort(tensor.diagonal())
    return principal(tensor)[0]


def unparsed(document: UrdfDocument) -> Iterator[str]:
    """Links with a blank behind a number of the <inertial>, or other blanks than spaces between numbers."""
    for name, inertial in _inertials(document):
        numbers = (inertial.mass, *inertial.entries.values())
        vectors = (inertial.origin.xyz, inertial.origin.rpy)
        if any(map(blank_behind, numbers)) or any(map(other_blanks, vectors)):
            yield name


def pinocchio_sum(document: UrdfDocument) -> Iterator[str]:
    """Moving links whose mass, with what is fixed to them, is below eps, and matters."""
    for name, merged in merged_links(document).items():
        inertials = [document.links[member].inertial for member in merged.members]
        massive = sum(inertial is not None and inertial.mass.exact != 0 for inertial in inertials)
        if name != document.root and merged.mass < EPS and (massive > 1 or merged.moment.any()):
            yield name


def _mujoco_margins(tensor: Array) -> tuple[float, float, float]:
    """How far MuJoCo's two tests are fulfilled, and by how much its rounding may move that."""
    low, mid, high = (float(x) for x in _sorted_moments(tensor, 0.0))
    slack = JACOBI * (1.0 + abs(low) + abs(mid) + abs(high)) if _products(tensor) else 0.0
    return low - SMALLEST_EIGENVALUE, (low + mid) - high, slack


def _mujoco_tested(document: UrdfDocument) -> Iterator[tuple[str, float, float, float]]:
    """Tensors that MuJoCo diagonalises: all but those of six zeros."""
    for name, inertial in _inertials(document):
        if inertial.tensor.any():
            yield (name, *_mujoco_margins(inertial.tensor))


def mujoco_eigenvalue(document: UrdfDocument) -> Iterator[str]:
    """A principal moment is surely too small."""
    return (name for name, smallest, _, slack in _mujoco_tested(document) if smallest < -slack)


def mujoco_triangle(document: UrdfDocument) -> Iterator[str]:
    """The triangle inequality is surely violated."""
    return (
        name for name, smallest, triangle, slack in _mujoco_tested(document) if smallest >= -slack and triangle < -slack
    )


def mujoco_rounding(document: UrdfDocument) -> Iterator[str]:
    """One of the two tests is open, and the other is not surely failed."""
    for name, smallest, triangle, slack in _mujoco_tested(document):
        if slack and min(smallest, triangle) >= -slack and min(smallest, triangle) < slack:
            yield name


def mujoco_minimum(document: UrdfDocument) -> Iterator[str]:
    """Moving links with too little mass or inertia; collision shapes stand in for a missing <inertial>."""
    for name, merged in merged_links(document, massive_only=True).items():
        if name == document.root or any(_from_shapes(document, member) for member in merged.members):
            continue
        smallest = SMALLEST_MOVING if len(merged.members) == 1 else SMALLEST_EIGENVALUE
        if merged.mass < SMALLEST_MOVING or float(_sorted_moments(merged.inertia, 0.0)[0]) < smallest:
            yield name


def _from_shapes(document: UrdfDocument, name: str) -> bool:
    """Whether MuJoCo takes mass and inertia of a link from its collision shapes."""
    link = document.links[name]
    return link.inertial is None and any(shape.role == "collision" for shape in link.shapes)


def _moving(document: UrdfDocument) -> Iterator[tuple[str, UrdfInertial]]:
    """Links that do not belong to the world."""
    anchored = merged_links(document)[document.root].members
    return ((name, inertial) for name, inertial in _inertials(document) if name not in anchored)


def mujoco_negative(document: UrdfDocument) -> Iterator[str]:
    """Negative masses of links that are merged; of a link by itself, that is too little mass."""
    several = {name for merged in merged_links(document).values() if len(merged.members) > 1 for name in merged.members}
    return (name for name, inertial in _moving(document) if name in several and inertial.mass.exact < 0)


def mujoco_massless_tensor(document: UrdfDocument) -> Iterator[str]:
    """Inertia without mass that is merged into a link."""
    for name, inertial in _moving(document):
        massless = 0 <= inertial.mass.exact < SMALLEST_MOVING
        if massless and not document.carried_by[name].moves and inertial.tensor.any():
            yield name


def mujoco_geometry(document: UrdfDocument) -> Iterator[str]:
    """Links with collision shapes but without <inertial>, unless they belong to the world."""
    anchored = merged_links(document)[document.root].members
    return (name for name in document.links if name not in anchored and _from_shapes(document, name))


def mujoco_products(document: UrdfDocument) -> Iterator[str]:
    """Products below 1e-12 that are not negligible."""
    for name, inertial in _moving(document):
        largest = _products(inertial.tensor)
        if NEGLIGIBLE * abs(float(np.trace(inertial.tensor))) < largest < SMALLEST_PRODUCT:
            yield name


def mujoco_rpy(document: UrdfDocument) -> Iterator[str]:
    """Tensors that their rpy turns into others."""
    return (name for name, inertial in _moving(document) if _differ(inertial.inertia, inertial.tensor))


def _differ(turned: Array, tensor: Array) -> bool:
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
    return axes_turned or bool(inertial.origin.p.any()) or _differ(R @ tensor @ R.T, tensor)


def _beyond(moments: Array, tolerance: float, rounding: float) -> bool | None:
    """Whether triangle inequality or positivity is violated by more than a tolerance; None where rounding decides."""
    low, mid, high = (float(x) for x in moments)
    excess = max(high - mid - low, -low) - tolerance
    return None if abs(excess) <= rounding else excess > 0.0


def _drake(document: UrdfDocument) -> Iterator[tuple[str, bool | None]]:
    for name, inertial in _inertials(document):
        moments = _sorted_moments(inertial.tensor, 0.0)
        rounding = 8.0 * EPS * float(np.abs(inertial.tensor).max())
        yield name, _beyond(moments, DRAKE_EPS * max(1.0, float(moments.sum()) / 2.0), rounding)


def drake_inertia(document: UrdfDocument) -> Iterator[str]:
    """Impossible beyond Drake's tolerance."""
    return (name for name, beyond in _drake(document) if beyond)


def drake_rounding(document: UrdfDocument) -> Iterator[str]:
    """At Drake's tolerance."""
    return (name for name, beyond in _drake(document) if beyond is None)


def drake_mass(document: UrdfDocument) -> Iterator[str]:
    """Negative mass, or none with an inertia."""
    for name, inertial in _inertials(document):
        if inertial.mass.exact < 0 or (inertial.mass.exact == 0 and inertial.tensor.any()):
            yield name


def _gazebo(document: UrdfDocument) -> Iterator[tuple[str, bool | None]]:
    """What becomes an SDFormat link: neither the link called world, nor one without mass, nor what hangs on that."""
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
            yield name, _beyond(moments, GAZEBO_EPS * abs(float(moments.sum())), rounding)


def gazebo_inertia(document: UrdfDocument) -> Iterator[str]:
    """Invalid beyond gz-math's tolerance."""
    return (name for name, beyond in _gazebo(document) if beyond)


def gazebo_rounding(document: UrdfDocument) -> Iterator[str]:
    """At gz-math's tolerance, or a boundary case that merging has rounded."""
    return (name for name, beyond in _gazebo(document) if beyond is None)


def gazebo_massless(document: UrdfDocument) -> Iterator[str]:
    """Links whose mass, with what is fixed to them, is not above zero."""
    return (
        name for name, merged in merged_links(document, spare="world").items() if name != "world" and merged.mass <= 0.0
    )


def gazebo_empty(document: UrdfDocument) -> Iterator[str]:
    """The root among these."""
    return (name for name in gazebo_massless(document) if name == document.root)


def kdl_root(document: UrdfDocument) -> Iterator[str]:
    """The root, where it has an <inertial>."""
    if document.links[document.root].inertial is not None:
        yield document.root
