"""Programs with a fault of a kind that public threads are about, written by hand on Pinocchio or in plain NumPy.

Each is f(q, v, a) of one state, or takes payloads too; none uses anything of the catalogue that is to name the fault.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from rttrr_pin.implementations import Batch, Evaluation

Array = NDArray[np.float64]
Program = Callable[[Array, Array, Array], Array]

FOLDER = Path(__file__).parents[1] / "data" / "torques_differ"

GRAVITY = np.array([0.0, 0.0, -9.81])


def text(robot: str) -> str:
    """The URDF of a robot of tests/data/torques_differ."""
    return (FOLDER / f"{robot}.urdf").read_text()


def edited(robot: str, old: str, new: str) -> str:
    """The same with one number, or element, written otherwise."""
    own = text(robot)
    assert own.count(old) == 1
    return own.replace(old, new)


def model(urdf: str, floating: bool = False) -> pin.Model:
    """Pinocchio's of a URDF."""
    return pin.buildModelFromXML(urdf, pin.JointModelFreeFlyer()) if floating else pin.buildModelFromXML(urdf)


def rnea(urdf: str | pin.Model, floating: bool = False) -> Program:
    """Pinocchio's own algorithm, without a fault but for those of the model."""
    own = model(urdf, floating) if isinstance(urdf, str) else urdf
    data = own.createData()

    def program(q: Array, v: Array, a: Array) -> Array:
        return np.array(pin.rnea(own, data, q, v, a))

    return program


def with_gravity(urdf: str, gravity: tuple[float, float, float]) -> Program:
    """Pinocchio under another gravity."""
    own = model(urdf)
    own.gravity.linear = np.array(gravity)
    return rnea(own)


def masses_in_grams(urdf: str) -> Program:
    """Masses of a file in g taken for kg; tensors about centres of mass stay. Of a robot without fixed links."""
    own = model(urdf)
    for body in own.inertias:
        body.mass *= 1e3
    return rnea(own)


def merged_without_turning(urdf: str, fixed_joint: str) -> Program:
    """A fixed link's tensor added to that of the link which carries it, and not turned to its axes."""
    own = model(urdf)
    frame = own.frames[own.getFrameId(fixed_joint)]
    right = frame.placement.act(frame.inertia)
    wrong = pin.Inertia(right.mass, right.lever, frame.inertia.inertia)
    total = own.inertias[frame.parentJoint]
    own.inertias[frame.parentJoint] = total - right + wrong
    return rnea(own)


class Loaded:
    """A program that takes payloads, as Pinocchio takes forces on joints: about and along what it is told."""

    version = ""
    quantities = ("tau",)

    def __init__(self, urdf: str, wrench_on_joint: Callable[[pin.SE3, Array, Array, Array], pin.Force]) -> None:
        """`wrench_on_joint` of the link's placement in the world, f, n of the payload, and the link's COM."""
        self.name = "loaded"
        self.model = model(urdf)
        self.wrench_on_joint = wrench_on_joint

    def evaluate(self, batch: Batch) -> Evaluation:
        """Tau, state by state; the payload acts on a link that a moving joint carries."""
        own, data = self.model, self.model.createData()
        tau = np.empty_like(batch.v)
        for k in range(len(batch)):
            pin.forwardKinematics(own, data, batch.q[k])
            forces = pin.StdVec_Force([pin.Force.Zero() for _ in range(own.njoints)])
            for load in batch.loads:
                joint = own.getJointId(batch.model.joints[load.link].name)
                f, n = (np.broadcast_to(x, (len(batch), 3))[k] for x in (load.f, load.n))
                forces[joint] = self.wrench_on_joint(data.oMi[joint], f, n, own.inertias[joint].lever)
            tau[k] = pin.rnea(own, data, batch.q[k], batch.v[k], batch.a[k], forces)
        return Evaluation({"tau": tau})


def newton_euler(robot: str, partly_turned: bool = False, lever_of_next: bool = False) -> Program:
    """A serial arm whose joints turn about z, after Craig; with what `rne_python` of modified DH did until 2026.

    Args:
        robot: its name.
        partly_turned: R^T reaches the first of three terms of the acceleration of the origin alone.
        lever_of_next: F acts at the origin of the next link, that of the last link at its own.
    """
    own = model(text(robot))
    placements, bodies = list(own.jointPlacements)[1:], list(own.inertias)[1:]
    z = np.array([0.0, 0.0, 1.0])

    def program(q: Array, v: Array, a: Array) -> Array:
        w, w_dot, v_dot = np.zeros(3), np.zeros(3), -GRAVITY
        F, N, R, p = [], [], [], []
        for j, (placement, body) in enumerate(zip(placements, bodies, strict=True)):
            R.append(placement.rotation @ pin.utils.rotate("z", q[j]))
            p.append(placement.translation)
            turning, centripetal = np.cross(w_dot, p[j]), np.cross(w, np.cross(w, p[j]))
            if partly_turned:
                v_dot = R[j].T @ turning + centripetal + v_dot
            else:
                v_dot = R[j].T @ (turning + centripetal + v_dot)
            w_dot = R[j].T @ w_dot + np.cross(R[j].T @ w, z * v[j]) + z * a[j]
            w = R[j].T @ w + z * v[j]
            c, I = body.lever, body.inertia
            F.append(body.mass * (v_dot + np.cross(w_dot, c) + np.cross(w, np.cross(w, c))))
            N.append(I @ w_dot + np.cross(w, I @ w))
        f, n, tau = np.zeros(3), np.zeros(3), np.zeros(len(bodies))
        R.append(np.eye(3))
        p.append(np.zeros(3))
        for j in reversed(range(len(bodies))):
            lever = p[j + 1] if lever_of_next else bodies[j].lever
            n = N[j] + R[j + 1] @ n + np.cross(lever, F[j]) + np.cross(p[j + 1], R[j + 1] @ f)
            f = F[j] + R[j + 1] @ f
            tau[j] = n[2]
        return tau

    return program


def two_links(velocity_sign: float = 1.0, two: float = 2.0, gravity_sign_at_elbow: float = 1.0) -> Program:
    """The textbooks' closed form of `two_links`, with what a newcomer gets wrong.

    Args:
        velocity_sign: of the velocity terms in tau of the shoulder.
        two: the factor of v_1 v_2 there.
        gravity_sign_at_elbow: of gravity in tau of the elbow.
    """
    m1, m2, l, c1, c2, I1, I2, g = 2.0, 1.5, 0.5, 0.25, 0.2, 0.05, 0.02, 9.81

    def program(q: Array, v: Array, a: Array) -> Array:
        h = m2 * l * c2 * np.sin(q[1])
        m12 = I2 + m2 * (c2**2 + l * c2 * np.cos(q[1]))
        m22 = I2 + m2 * c2**2
        m11 = I1 + m1 * c1**2 + m2 * l**2 + m22 + 2.0 * m2 * l * c2 * np.cos(q[1])
        of_lower = m2 * c2 * g * np.cos(q[0] + q[1])
        of_both = (m1 * c1 + m2 * l) * g * np.cos(q[0]) + of_lower
        velocity = -h * (two * v[0] * v[1] + v[1] ** 2)
        return np.array(
            [
                m11 * a[0] + m12 * a[1] + velocity_sign * velocity + of_both,
                m12 * a[0] + m22 * a[1] + h * v[0] ** 2 + gravity_sign_at_elbow * of_lower,
            ]
        )

    return program
