"""The model that Pinocchio built, link by link, and what in it differs from the file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from rttrr_pin.core.algebra import Vector
from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.inertia import point_tensor
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import FLOATING
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.scalars import EPS
from rttrr_pin.errors import ImplementationError, listed
from rttrr_pin.implementations import library
from rttrr_pin.implementations.library import norms
from rttrr_pin.implementations.pinocchio_links import PinLinks

SHOWN = 4
"""Messages of urdfdom that are repeated in full."""

MERGING = 8
"""Roundings of an inertia that is turned, moved and added to another."""

SNAPPED = 1e-12
"""Pinocchio takes an axis so near to x, y or z as that (`isApprox` of Eigen); -x, -y and -z are axes like any other."""


def built_model(urdf: str, *root: Any, **options: Any) -> tuple[Any, str]:
    """What Pinocchio builds from a text, and what urdfdom, its reader, printed meanwhile, as a sentence.

    Raises:
        ImplementationError: Pinocchio refuses the text; with that sentence.
    """
    said: list[str] = []
    try:
        with library.captured_stderr() as said:
            pin_model = pin.buildModelFromXML(urdf, *root, **options)
    except (ValueError, RuntimeError) as error:
        raise ImplementationError("; ".join(filter(None, [str(error).strip(), _printed(said)]))) from error
    return pin_model, _printed(said)


def _printed(lines: Sequence[str]) -> str:
    """How many messages urdfdom printed, and the first of them, without the lines of its own source; empty if none."""
    messages = [line.partition(":")[2].strip() for line in lines if line.startswith(("Error:", "Warning:"))]
    if not messages:
        return ""
    number = "1 message" if len(messages) == 1 else f"{len(messages)} messages"
    return f"urdfdom, which reads the file for Pinocchio, printed {number}: {listed(messages, SHOWN, '; ')}"


def pin_joints(model: Model, pin_model: Any) -> list[library.LibraryJoint]:
    """The moving joints, in our order."""

    def slices(joint: Joint, link: Link) -> tuple[slice, slice]:
        built = pin_model.joints[pin_model.getJointId(joint.name)]
        return slice(built.idx_q, built.idx_q + built.nq), slice(built.idx_v, built.idx_v + built.nv)

    return library.library_joints(model, slices)


COLUMNS: tuple[tuple[type, tuple[int, ...]], ...] = (
    (bool, ()), (np.int64, ()), (float, (3, 3)), (float, (3,)), (float, ()), (float, (3,)), (float, (3, 3)),
)  # fmt: skip
"""Of each field of `PinLinks` the type, and the shape for one link; a robot of one link that stands still has none."""


class Assembly:
    """A file's model and what Pinocchio built of it, with what both are compared by.

    Attributes:
        model: the file's.
        pin_model, data: Pinocchio's.
        frames: Pinocchio's by type and name; it would look through all of them for each.
        placed: where each link is on its body.
        merged: by index of a link that a moving joint carries, the links that are one body with it, itself first.
        inertias: of each such body by the file, with what each adds up.
    """

    def __init__(self, model: Model, pin_model: Any) -> None:
        self.model, self.pin_model, self.data = model, pin_model, pin_model.createData()
        self.frames = {(frame.type, frame.name): frame for frame in pin_model.frames}
        self.placed = _placed(model)
        self.merged = _merged(model, self.placed)
        self.inertias = {i: _inertia(model, parts) for i, parts in self.merged.items()}


def pin_links(assembly: Assembly) -> PinLinks:
    """The links of the file with Pinocchio's placements and inertias.

    Pinocchio keeps the inertia of a link apart unless massive links are fixed to it; then only the sum is there, and
    the link's own part is the file's (that the sum is right, `differences` has shown).
    """
    model, frames, links = assembly.model, assembly.frames, []
    for i, (joint, link) in enumerate(zip(model.joints, model.links, strict=True)):
        fixed = joint.nv == 0
        frame = frames[pin.FrameType.BODY, link.name]
        if fixed:
            inertia = frames[pin.FrameType.FIXED_JOINT, joint.name].inertia
        elif any(
            model.links[part.link].mass or model.links[part.link].inertia.any() for part in assembly.merged[i][1:]
        ):
            inertia = None  # pin.Inertia refuses tensors that Pinocchio's own reader takes
        else:
            inertia = assembly.pin_model.inertias[frame.parentJoint]
        mass, com, tensor = link.mass, link.com, link.inertia
        if inertia is not None:
            mass, com, tensor = inertia.mass, inertia.lever, inertia.inertia
        M = frame.placement
        links.append((fixed, frame.parentJoint, M.rotation, M.translation, mass, com, tensor))
    columns = zip(*links, strict=True) if links else [()] * len(COLUMNS)
    return PinLinks(*(np.array(x, kind).reshape(-1, *shape) for x, (kind, shape) in zip(columns, COLUMNS, strict=True)))


def differences(assembly: Assembly) -> list[str]:
    """One line for each number of Pinocchio's model that is not what the file says."""
    model = assembly.model
    built = [name for name in assembly.pin_model.names if name != "universe"]
    expected = [joint.name for joint in model.joints if joint.nv]
    if sorted(built) != sorted(expected):  # an object's joints keep their order, which may be another
        return [f"moving joints: {', '.join(built)}, the file has {', '.join(expected)}"]
    lines: list[str] = []
    for joint, link, place in zip(model.joints, model.links, assembly.placed, strict=True):
        if joint.nv:
            lines += _moving_differences(assembly, place)
            continue
        frame = assembly.frames[pin.FrameType.FIXED_JOINT, joint.name]
        lines += _placement_differences(joint, place, frame.placement)
        lines += _inertia_differences(link, _inertia(model, [_itself(place.link)]), frame.inertia)
    return [*lines, *_mimic_differences(model)]


def _moving_differences(assembly: Assembly, placed: _Placed) -> Iterator[str]:
    """Placement, axis and limits of a joint that moves; mass, centre and tensor of the body that it carries."""
    model, pin_model, data = assembly.model, assembly.pin_model, assembly.data
    joint, link = model.joints[placed.link], model.links[placed.link]
    number = pin_model.getJointId(joint.name)
    parent = pin_model.getJointId(model.joints[placed.on].name) if placed.on >= 0 else 0
    if pin_model.parents[number] != parent:
        hanging_on = pin_model.names[pin_model.parents[number]]
        yield f"joint {joint.name!r}: hangs on {hanging_on!r}, not where the file has it"
    built = pin_model.joints[number]
    yield from _placement_differences(joint, placed, pin_model.jointPlacements[number])
    if _snapped_axis(joint, data.joints[number].S) is None:
        yield from library.differs(f"joint {joint.name!r} axis", _subspace(joint), data.joints[number].S, 1.0)
    if joint.type.has_axis:
        yield from library.limit_differences(joint, _limits(pin_model, built.idx_q, built.idx_v))
    yield from _inertia_differences(link, assembly.inertias[placed.link], pin_model.inertias[number])


def _placement_differences(joint: Joint, expected: _Placed, built: Any) -> Iterator[str]:
    return library.placement_differences(
        joint, (expected.R, expected.p), built.rotation, built.translation, expected.length, expected.turns
    )


def merged_apart(assembly: Assembly) -> dict[int, library.Scales]:
    """By Pinocchio's joint, how far mass, centre and tensor of a body of several links may be from the file's.

    What merging rounds is some eps of the longest length, in any direction: here as it is, and what our own sum rounds.
    """
    apart, pin_model = {}, assembly.pin_model
    for i, (expected, scales) in assembly.inertias.items():
        if len(assembly.merged[i]) > 1:
            number = pin_model.getJointId(assembly.model.joints[i].name)
            inertia = pin_model.inertias[number]
            built = zip(expected, (inertia.mass, inertia.lever, inertia.inertia), scales, strict=True)
            mass, com, tensor = (float(norm(np.ravel(x - y))) + MERGING * EPS * float(scale) for x, y, scale in built)
            apart[number] = mass, com, tensor
    return apart


def _limits(pin_model: Any, q: int, v: int) -> dict[str, float]:
    return {
        "damping": pin_model.damping[v],
        "friction": pin_model.upperDryFrictionLimit[v],
        "velocity limit": pin_model.velocityLimit[v],
        "effort limit": pin_model.effortLimit[v],
        "lower limit": pin_model.lowerPositionLimit[q],
        "upper limit": pin_model.upperPositionLimit[q],
    }


def _inertia_differences(link: Link, expected: tuple[library.Inertia, library.Scales], built: Any) -> Iterator[str]:
    inertia, scales = expected
    yield from library.inertia_differences(link, inertia, (built.mass, built.lever, built.inertia), scales)


def _mimic_differences(model: Model) -> Iterator[str]:
    """Multiplier and offset of followers, where Pinocchio can build them: not if the followed joint sorts later."""
    joints = library.followers(model)
    if not joints:
        return
    try:
        pin_model, _ = built_model(model.urdf, mimic=True)
    except ImplementationError:
        return
    for joint in joints:
        number = pin_model.getJointId(joint.name)  # njoints for one that it did not build
        if number < pin_model.njoints and pin_model.joints[number].shortname() == "JointModelMimic":
            built = pin_model.joints[number].extract()
            yield from library.mimic_differences(joint, built.scaling, built.offset)


def snapped_axes(assembly: Assembly) -> dict[int, Array]:
    """By index of its joint, each axis that Pinocchio took as x, y or z though it lies apart by more than rounding."""
    number, built = assembly.pin_model.getJointId, assembly.data.joints
    moving = {i: joint for i, joint in enumerate(assembly.model.joints) if joint.nv}
    axes = {i: _snapped_axis(joint, built[number(joint.name)].S) for i, joint in moving.items()}
    return {i: axis for i, axis in axes.items() if axis is not None}


def _snapped_axis(joint: Joint, S: Any) -> Array | None:
    """x, y or z, where that is what Pinocchio took for an axis that is not it; S is what it built."""
    if not joint.type.has_axis:
        return None
    axis = np.ravel(S)[3:] if joint.type.rotations[0] else np.ravel(S)[:3]
    snapped = np.count_nonzero(axis) == 1 and axis.max() == 1.0 and (axis != joint.axis).any()
    return axis if snapped and norm(axis - joint.axis) <= SNAPPED else None


def _subspace(joint: Joint) -> Array:
    """The joint's motion per unit rate, linear before angular: (6,), or (6, nv) where there are several rates."""
    S = np.eye(6)[:, : joint.nv]  # of a floating joint all six, of a planar one x and y
    if joint.type != FLOATING:
        S[:, -1] = [0, 0, 0, *joint.axis] if joint.type.rotations[-1] else [*joint.axis, 0, 0, 0]
    return S.squeeze()


class _Placed(NamedTuple):
    """Where link i is on the nearest link further in that a moving joint carries.

    Attributes:
        link: i.
        R, p: there [m].
        length: what p adds up, in which it may cancel [m].
        turns: how many rotations R is the product of.
        on: the other link's index; -1 is the root.
    """

    link: int
    R: Array
    p: Array
    length: float
    turns: int
    on: int


def _itself(i: int) -> _Placed:
    return _Placed(i, np.eye(3), np.zeros(3), 0.0, 1, i)


def _placed(model: Model) -> list[_Placed]:
    """The place of each link."""
    placed: list[_Placed] = []
    for i, joint in enumerate(model.joints):
        place = _Placed(i, joint.R, joint.p, float(norm(joint.p)), 1, joint.parent)
        if place.on >= 0 and not model.joints[place.on].nv:
            _, R, p, length, turns, on = placed[place.on]
            place = _Placed(i, R @ place.R, p + R @ place.p, length + place.length, turns + 1, on)
        placed.append(place)
    return placed


def _merged(model: Model, placed: list[_Placed]) -> dict[int, list[_Placed]]:
    """Which links are one body, see `Assembly.merged`."""
    bodies = {i: [_itself(i)] for i, joint in enumerate(model.joints) if joint.nv}
    for place in placed:
        if not model.joints[place.link].nv and place.on >= 0:
            bodies[place.on].append(place)
    return bodies


def _inertia(model: Model, parts: list[_Placed]) -> tuple[library.Inertia, library.Scales]:
    """Mass, centre of mass and tensor about it of links together (parallel axis theorem), and what each adds up."""
    links = [model.links[part.link] for part in parts]
    masses = np.array([link.mass for link in links])
    centres = np.array([part.p + part.R @ link.com for part, link in zip(parts, links, strict=True)])
    mass, sizes = float(masses.sum()), np.abs(masses)
    weights = np.ldexp(masses, -np.frexp(sizes.max())[1])  # exact, and the products of the smallest doubles stay
    com = weights @ centres / weights.sum() if mass else centres[0]
    tensor = np.zeros((3, 3))
    for part, link, c in zip(parts, links, centres, strict=True):
        tensor += part.R @ link.inertia @ part.R.T + link.mass * point_tensor(Vector.of(c - com)).array
    lengths = np.array([part.length for part in parts]) + norms(link.com for link in links)
    moments = sizes @ lengths**2 + norms(link.inertia for link in links).sum()
    return (mass, com, tensor), (sizes.sum(), np.abs(weights) @ lengths / abs(weights.sum()) if mass else 0.0, moments)
