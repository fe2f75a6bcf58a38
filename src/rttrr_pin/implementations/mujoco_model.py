"""The model that MuJoCo built, link by link, and what in it differs from the file.

MuJoCo's importer reads the file on its own: names, tree, placements, axes, masses, centres of mass and tensors are
compared with the file as it read them. What its compiler would do to them next is kept away:

- Fixed links are fused into what carries them, the root into the world: `fusestatic` is off, and every link is a body.
- Shapes, meshes and a `<mujoco>` section are left out of the text: dynamics take `<inertial>` alone.
- A moving body without mass, a tensor that no body has: refused. So it compiles placeholders, and the masses, centres
  and tensors that it read are written into the compiled model.
- Tensors are diagonalised by an iteration that stops at 1e-12: here by LAPACK. MuJoCo computes with those axes.
- Quaternions and axes are divided by their length where that is off by more than 1e-14: here always.
- `<mimic>` becomes a soft constraint (in older versions nothing): left out, once it is compared. Followers are driven
  along, as for every library.
- A floating joint must hang on the world: three slides and a ball are the same joint, and may hang anywhere.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import mujoco
import numpy as np
from lxml import etree

from rttrr_pin.core.arrays import Array, norm
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import CONTINUOUS, FIXED, FLOATING, PLANAR, PRISMATIC, REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.errors import ModelMismatchError, RefusalError
from rttrr_pin.implementations import library

PREFIX = "link "
"""Before the name of each link: MuJoCo has a body of its own that is called world."""

END = "."
"""Behind the name of each joint: MuJoCo appends to those of planar joints, and drops what is called so already."""

MARKED = (
    ("link", "name", PREFIX, ""),
    ("joint/parent", "link", PREFIX, ""),
    ("joint/child", "link", PREFIX, ""),
    ("joint", "name", "", END),
    ("joint/mimic", "joint", "", END),
)
"""Elements and attributes that are names of links or joints, and what is put before and behind."""

DROPPED = ("mujoco", "visual", "collision")

SLIDE, HINGE, BALL = mujoco.mjtJoint.mjJNT_SLIDE, mujoco.mjtJoint.mjJNT_HINGE, mujoco.mjtJoint.mjJNT_BALL

MADE_OF = {
    REVOLUTE: (HINGE,),
    CONTINUOUS: (HINGE,),
    PRISMATIC: (SLIDE,),
    PLANAR: (SLIDE, SLIDE, HINGE),
    FLOATING: (SLIDE, SLIDE, SLIDE, BALL),
    FIXED: (),
}
"""MuJoCo's joints that make one of each type, in the order in which they move their body."""

PARTS = {PLANAR: ("_TX", "_TY", "_RZ"), FIXED: ()}
"""What MuJoCo appends to the name of a joint that it makes of several, and of one that it does not make."""


def build(model: Model) -> Any:
    """MuJoCo's compiled model: body 1 is the root of the file, then every other link.

    Raises:
        RefusalError: MuJoCo refuses the file.
        ModelMismatchError: it read something else than we did.
    """
    with without_log():
        try:
            spec = mujoco.MjSpec.from_string(_bare(library.urdf_of(model, "MuJoCo")))
            bodies = {body.name: body for body in spec.bodies}
            if lines := [*_differences(model, bodies), *_mimic_differences(model, spec)]:
                raise ModelMismatchError("MuJoCo", lines)
            inertials = {name: _inertial(body) for name, body in bodies.items() if name.startswith(PREFIX)}
            _prepare(spec, model, bodies)
            compiled = spec.compile()
        except ValueError as error:
            raise RefusalError(f"MuJoCo refuses the URDF of {model.name!r}: {str(error).strip()}") from error
    for name, inertial in inertials.items():
        _write(compiled, compiled.body(name).id, *inertial)
    compiled.opt.gravity[:] = model.gravity
    _complete(compiled)
    return compiled


def own_refusal(urdf: str) -> str:
    """Why MuJoCo refuses a text from whose compilation nothing is kept away; empty where it takes it.

    Meshes, which need not be there, are spheres in this: a link without <inertial> gets its mass from its shape.
    """
    root = _parsed(urdf)
    for element in list(root.iter("visual", "material")):  # MuJoCo leaves them out
        element.getparent().remove(element)
    for mesh in list(root.iter("mesh")):
        mesh.getparent().replace(mesh, etree.Element("sphere", radius="1"))
    with without_log():
        try:
            mujoco.MjModel.from_xml_string(etree.tostring(root, encoding="unicode"))
        except ValueError as error:
            return " ".join(str(error).split())
    return ""


def mujoco_joints(model: Model, compiled: Any) -> list[library.LibraryJoint]:
    """The moving joints, in our order."""

    def slices(joint: Joint, link: Link) -> tuple[slice, slice]:
        first = compiled.body_jntadr[compiled.body(PREFIX + link.name).id]  # of those that MuJoCo makes one of
        q, v = int(compiled.jnt_qposadr[first]), int(compiled.jnt_dofadr[first])
        return slice(q, q + joint.nq), slice(v, v + joint.nv)

    return library.library_joints(model, slices)


def rotation_of(quaternion: Any) -> Array:
    """The rotation matrix of MuJoCo's quaternion (w, x, y, z)."""
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, unit(quaternion))
    return matrix.reshape(3, 3)


def unit(x: Any) -> Array:
    """Divided by its length."""
    vector = np.array(x, dtype=float)
    divided: Array = vector / norm(vector)
    return divided


def _inertial(body: Any) -> tuple[float, Array, Array]:
    """Mass [kg], centre [m] and tensor about it [kg m^2] of a body, in link axes, as MuJoCo read them."""
    xx, yy, zz, xy, xz, yz = np.nan_to_num(np.array(body.fullinertia))  # nan: the file has no <inertial>
    R = rotation_of(body.iquat)
    turned = R @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ R.T
    return float(body.mass), np.nan_to_num(np.array(body.ipos)), (turned + turned.T) / 2


def _write(compiled: Any, body: int, mass: float, com: Array, tensor: Array) -> None:
    """Into the compiled model."""
    moments, axes = np.linalg.eigh(tensor)
    if not (tensor - np.diag(np.diag(tensor))).any():
        moments, axes = np.diag(tensor), np.eye(3)
    axes[:, 2] *= np.sign(np.linalg.det(axes))
    quaternion = np.empty(4)
    mujoco.mju_mat2Quat(quaternion, axes.ravel())
    compiled.body_mass[body], compiled.body_ipos[body] = mass, com
    compiled.body_inertia[body], compiled.body_iquat[body] = moments, unit(quaternion)


@contextmanager
def without_log() -> Iterator[None]:
    """MuJoCo's warnings (two limits are equal, ...) go to a file in the current folder unless someone takes them.

    That its compiler finds inertias singular is no news of placeholders, and of a file for `inspect` to say.
    """
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda message: None)
    try:
        with warnings.catch_warnings(action="ignore", category=UserWarning):
            yield
    finally:
        mujoco.set_mju_user_warning(before)


def _parsed(urdf: str) -> Any:
    return etree.fromstring(urdf.encode(), etree.XMLParser(encoding="utf-8"))


def _bare(urdf: str) -> str:
    """The text without what dynamics do not need, and with the names of links and joints marked."""
    root = _parsed(urdf)
    for element in list(root.iter(*DROPPED)):
        element.getparent().remove(element)
    for path, key, before, behind in MARKED:
        for element in root.iterfind(path):
            element.set(key, before + element.get(key, "") + behind)
    text: str = etree.tostring(root, encoding="unicode")
    return text


def _differences(model: Model, bodies: dict[str, Any]) -> Iterator[str]:
    """One line for each number of MuJoCo's that is not what the file says."""
    built = {name.removeprefix(PREFIX) for name in bodies if name.startswith(PREFIX)}
    expected = {model.root.name, *model.link_names} if not model.floating else set(model.link_names)
    if built != expected:
        yield f"links: {', '.join(sorted(built))}, the file has {', '.join(sorted(expected))}"
        return
    for i, (joint, link) in enumerate(zip(model.joints, model.links, strict=True)):
        body = bodies[PREFIX + link.name]
        yield from library.inertia_differences(link, (link.mass, link.com, link.inertia), _inertial(body))
        if not (model.floating and i == 0):
            yield from _joint_differences(model, joint, body)


def _joint_differences(model: Model, joint: Joint, body: Any) -> Iterator[str]:
    """Placement, type, axis, damping, friction and limits of a joint; MuJoCo has no limit on rates."""
    here = f"joint {joint.name!r}"
    parent = model.links[joint.parent].name if joint.parent >= 0 else model.root.name
    if body.parent.name != PREFIX + parent:
        yield f"{here}: hangs on {body.parent.name.removeprefix(PREFIX)!r}, the file says {parent!r}"
    yield from library.placement_differences(joint, (joint.R, joint.p), rotation_of(body.quat), body.pos)
    made_of = MADE_OF[joint.type] if joint.type != FLOATING else (mujoco.mjtJoint.mjJNT_FREE,)
    types, names = tuple(built.type for built in body.joints), [built.name for built in body.joints]
    if names != [joint.name + END + part for part in PARTS.get(joint.type, ("",))]:
        carried_by = ", ".join(name.replace(END, "") for name in names) or "no joint"
        yield f"link {body.name.removeprefix(PREFIX)!r}: carried by {carried_by}, the file says {joint.name}"
    elif types != made_of:
        yield f"{here}: made of {', '.join(map(str, types)) or 'none'}, the file says {joint.type}"
    elif joint.type.has_axis:
        (built,) = body.joints
        yield from library.differs(f"{here} axis", joint.axis, unit(built.axis), 1.0)
        limits = {"damping": np.ravel(built.damping)[0], "friction": built.frictionloss}
        limits |= {"lower limit": built.range[0], "upper limit": built.range[1]}
        if joint.limits.effort > 0.0:  # at 0 MuJoCo sets none
            limits["effort limit"] = built.actfrcrange[1]
        yield from library.limit_differences(joint, limits)


def _mimic_differences(model: Model, spec: Any) -> Iterator[str]:
    """Whom followers follow, and how, where MuJoCo reads it."""
    read = {equality.name1.removesuffix(END): equality for equality in spec.equalities}
    for joint in library.followers(model):
        if joint.mimic is not None and joint.name in read:
            built, leader = read[joint.name], model.joints[joint.mimic.joint].name
            if built.name2 != leader + END:
                follows = built.name2.removesuffix(END)
                yield f"joint {joint.name!r} mimic: follows {follows!r}, the file says {leader!r}"
            yield from library.mimic_differences(joint, built.data[1], built.data[0])


def _prepare(spec: Any, model: Model, bodies: dict[str, Any]) -> None:
    """Settings and placeholders with which the compiler alters nothing."""
    spec.compiler.fusestatic = False
    spec.compiler.balanceinertia = False
    spec.compiler.boundmass = spec.compiler.boundinertia = 0.0
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    for equality in list(spec.equalities):
        spec.delete(equality)
    for joint, link in zip(model.joints, model.links, strict=True):
        if joint.type == FLOATING:
            _make_floating(bodies[PREFIX + link.name])
    for body in bodies.values():
        if body.name.startswith(PREFIX):
            body.mass, body.inertia, body.fullinertia = 1.0, np.ones(3), np.full(6, np.nan)
            body.ipos, body.iquat, body.explicitinertial = np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]), True
            body.quat = unit(body.quat)
            for built in body.joints:
                built.axis = unit(built.axis)


def _make_floating(body: Any) -> None:
    """Slides along x, y, z and a ball in place of the free joint, if there is one."""
    first = body.joints[0] if body.joints else body.add_joint()
    parts = [first, *(body.add_joint() for _ in range(3))]
    for part, joint_type, axis in zip(parts, MADE_OF[FLOATING], [*np.eye(3), np.array([0.0, 0.0, 1.0])], strict=True):
        part.type, part.axis = joint_type, axis


def _complete(compiled: Any) -> None:
    """What the compiler had worked out from the placeholders: masses of subtrees, frames that are the same."""
    compiled.body_sameframe[:] = 0
    compiled.body_subtreemass[:] = compiled.body_mass
    for number in reversed(range(1, compiled.nbody)):
        compiled.body_subtreemass[compiled.body_parentid[number]] += compiled.body_subtreemass[number]
