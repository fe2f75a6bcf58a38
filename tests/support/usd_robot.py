"""A robot in a state as USD text, for PhysX.

On the child's side each joint has a frame of its own, shifted along the axis, and turned so that the axis is x.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy.spatial.transform import Rotation

from rttrr_pin.core.joint import Joint
from rttrr_pin.core.model import Link, Model
from rttrr_pin.core.placements import in_base

LEAST_MASS, LEAST_MOMENT = 1e-3, 1e-6
"""PhysX takes others for links without."""

SHIFT = 0.2
"""Of the joint's frame along its axis, from the origin of the child link [m]."""

KINDS = {"revolute": "Revolute", "continuous": "Revolute", "prismatic": "Prismatic", "fixed": "Fixed"}


def usd_of(model: Model, q: np.ndarray, v: np.ndarray) -> str:
    """Fixed, revolute and prismatic joints; the root is welded to the world."""
    R, p = (x[0] for x in in_base(model, q[None]))
    size = float(np.linalg.norm(model.gravity))
    bodies = [_body(Link("root", 1.0, np.zeros(3), np.eye(3)), np.eye(3), np.zeros(3))]
    bodies += [_body(link, R[i], p[i]) for i, link in enumerate(model.links)]
    joints, k = [], 0
    for joint, link in zip(model.joints, model.links, strict=True):
        parent = "root" if joint.parent < 0 else model.links[joint.parent].name
        joints.append(_joint(joint, parent, link.name, *((q[k], v[k]) if joint.nv else ())))
        k += joint.nv
    return f"""#usda 1.0
(
    defaultPrim = "robot"
    metersPerUnit = 1
    kilogramsPerUnit = 1
    upAxis = "Z"
)
def PhysicsScene "scene" (prepend apiSchemas = ["PhysxSceneAPI"])
{{
    vector3f physics:gravityDirection = {_tuple(model.gravity / size)}
    float physics:gravityMagnitude = {size}
    bool physxScene:enableGPUDynamics = 0
    uniform token physxScene:broadphaseType = "MBP"
}}
def Xform "robot" (prepend apiSchemas = ["PhysicsArticulationRootAPI", "PhysxArticulationAPI"])
{{
    bool physxArticulation:enabledSelfCollisions = 0
    def PhysicsFixedJoint "root_to_world"
    {{
        rel physics:body1 = </robot/root>
    }}
{"".join(bodies)}{"".join(joints)}}}
"""


def child_frame(joint: Joint) -> tuple[np.ndarray, np.ndarray]:
    """`localRot1` as a matrix R and `localPos1`, p: they map from the joint's frame to that of the child link."""
    x = np.array(joint.axis)
    y = np.cross(np.eye(3)[np.abs(x).argmin()], x)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)]), SHIFT * x


def as_physx_has_it(link: Link) -> tuple[float, np.ndarray]:
    """Mass and principal moments: those that are not zero."""
    return max(link.mass, LEAST_MASS), np.maximum(np.linalg.eigvalsh(link.inertia), LEAST_MOMENT)


def _tuple(numbers: Iterable[float]) -> str:
    return f"({', '.join(f'{float(x):.9g}' for x in numbers)})"


def _quaternion(R: np.ndarray) -> str:
    return _tuple(Rotation.from_matrix(R).as_quat()[[3, 0, 1, 2]])


def _body(link: Link, R: np.ndarray, p: np.ndarray) -> str:
    mass, moments = as_physx_has_it(link)
    axes = np.linalg.eigh(link.inertia)[1]
    axes[:, 2] *= np.linalg.det(axes)
    return f"""
    def Xform "{link.name}" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI", "PhysxRigidBodyAPI"])
    {{
        float physics:mass = {mass:.9g}
        point3f physics:centerOfMass = {_tuple(link.com)}
        float3 physics:diagonalInertia = {_tuple(moments)}
        quatf physics:principalAxes = {_quaternion(axes)}
        float physxRigidBody:angularDamping = 0
        float physxRigidBody:linearDamping = 0
        double3 xformOp:translate = {_tuple(p)}
        quatf xformOp:orient = {_quaternion(R)}
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]
    }}"""


def _joint(joint: Joint, parent: str, child: str, *state: float) -> str:
    kind, schemas, moves = KINDS[joint.type.name], "", ""
    if state:
        word, unit = ("angular", np.degrees(1.0)) if kind == "Revolute" else ("linear", 1.0)
        schemas = f'(prepend apiSchemas = ["PhysxJointAPI", "PhysicsJointStateAPI:{word}"])'
        moves = f"""
        uniform token physics:axis = "X"
        float physxJoint:jointFriction = 0
        float physxJoint:maxJointVelocity = 1000000
        float state:{word}:physics:position = {state[0] * unit:.9g}
        float state:{word}:physics:velocity = {state[1] * unit:.9g}"""
    R, p = child_frame(joint)
    return f"""
    def Physics{kind}Joint "{joint.name}" {schemas}
    {{
        rel physics:body0 = </robot/{parent}>
        rel physics:body1 = </robot/{child}>
        point3f physics:localPos0 = {_tuple(joint.p + joint.R @ p)}
        quatf physics:localRot0 = {_quaternion(joint.R @ R)}
        point3f physics:localPos1 = {_tuple(p)}
        quatf physics:localRot1 = {_quaternion(R)}{moves}
    }}
"""
