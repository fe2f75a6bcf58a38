"""Pinocchio as the oracle: each of the five quantities from Pinocchio's own numbers.

| quantity | from |
|---|---|
| tau | the return value of `rnea` |
| f, n | `data.f` of a moving joint, `computeSupportedForceByFrame` of a fixed one |
| F, N | `data.a_gf`, `data.v` and the inertia, taken to the centre of mass |

The payload enters through `fext`, with the opposite sign: `fext` is what the surroundings exert on the robot.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from rttrr_pin.arithmetic import Load
from rttrr_pin.errors import ModelMismatchError, OracleError
from rttrr_pin.model import JointType, LinkWrenches, Model
from rttrr_pin.oracles import Evaluation
from rttrr_pin.oracles.pinocchio_model import differences, pin_links
from rttrr_pin.oracles.pinocchio_rounding import EPS, OPERATIONS, rounding

Array = NDArray[np.float64]


class PinocchioOracle:
    """Pinocchio's RNEA on the model that Pinocchio built from the same text."""

    name = "pinocchio"
    version: str = pin.__version__

    def __init__(self, model: Model) -> None:
        """Build Pinocchio's model, and hold it against what the file says.

        Raises:
            OracleError: the model has no URDF text, or Pinocchio refuses it.
            ModelMismatchError: Pinocchio built something else.
        """
        if not model.urdf:
            raise OracleError(
                f"robot {model.name!r} was made from numbers, and Pinocchio builds from a URDF: load it from a file"
            )
        try:
            self.pin_model = pin.buildModelFromXML(model.urdf)
        except (ValueError, RuntimeError) as error:
            raise OracleError(f"Pinocchio refuses the URDF of {model.name!r}: {str(error).strip()}") from error
        found = differences(model, self.pin_model)
        if found:
            raise ModelMismatchError("Pinocchio", found)
        self.pin_model.gravity.linear = np.array(model.gravity)
        self.model = model
        self.links = pin_links(model, self.pin_model)
        self.data = self.pin_model.createData()
        self._supported = [self._supported_force(i) for i in range(len(self.links))]

    def evaluate(self, q: Array, v: Array, a: Array, loads: Sequence[Load] = ()) -> Evaluation:
        """tau, F, N, f, n of a batch by Pinocchio, in the frames and signs of `Robot.inverse_dynamics`.

        Args:
            q: coordinates, (N, nv) [rad or m]; a continuous joint's is its angle.
            v: rates, (N, nv).
            a: accelerations, (N, nv).
            loads: payloads.
        """
        record = self._run(q, v, a, loads)
        F, N = self._net(record)
        f, n = self._across_joints(record, loads)
        wrenches = LinkWrenches(record.tau, F, N, f, n, self.model.link_names, self.model.joint_names)
        return Evaluation(wrenches, self._rounding(record, q, loads))

    def _run(self, q: Array, v: Array, a: Array, loads: Sequence[Load]) -> _Record:
        """Call `rnea` on each state and keep what it leaves in `data`, whose entries the next call overwrites."""
        model, data = self.pin_model, self.data
        record = _Record.empty(len(q), model.njoints, model.nv, len(self.links))
        views = [x.vector for name in ("f", "v", "a_gf") for x in getattr(data, name)]
        external = pin.StdVec_Force([pin.Force.Zero()] * model.njoints)
        external_views = [x.vector for x in external]
        configuration = self._configuration(q)
        on_joints = self._on_joints(loads, len(q))
        turned = [load for load in loads if load.in_base]
        needs_kinematics = bool(turned) or any(self._supported)
        spatial = record.spatial.reshape(len(q), -1)
        for k in range(len(q)):
            if needs_kinematics:  # rnea fills neither data.oMi nor data.a
                pin.forwardKinematics(model, data, configuration[k], v[k], a[k])
            for load in turned:
                link = self.links[load.link]
                record.base_to_link[k, load.link] = (data.oMi[link.joint].rotation @ link.R).T
            for joint, force in self._external(on_joints, loads, record, k):
                external_views[joint][:] = force
            record.tau[k] = pin.rnea(model, data, configuration[k], v[k], a[k], external)
            np.concatenate(views, out=spatial[k])
            for i, supported in enumerate(self._supported):
                if supported is not None:
                    record.supported[k, i] = supported()
        return record

    def _configuration(self, q: Array) -> Array:
        """Pinocchio's q: the cosine and sine of a continuous joint's angle."""
        out = np.empty((len(q), self.pin_model.nq))
        for column, joint in enumerate(self.model.moving):
            at = self.pin_model.joints[self.pin_model.getJointId(joint.name)].idx_q
            if joint.type is JointType.CONTINUOUS:
                out[:, at], out[:, at + 1] = np.cos(q[:, column]), np.sin(q[:, column])
            else:
                out[:, at] = q[:, column]
        return out

    def _on_joints(self, loads: Sequence[Load], rows: int) -> list[Array]:
        """Each load, in link axes, as a spatial force on the joint that carries the link: (N, 6), force first."""
        moved = []
        for load in loads:
            link = self.links[load.link]
            f = np.broadcast_to(load.f, (rows, 3))
            n = np.broadcast_to(load.n, (rows, 3))
            moved.append(np.concatenate([f, n], axis=1) if load.in_base else link.to_joint(f, n))
        return moved

    def _external(
        self, on_joints: list[Array], loads: Sequence[Load], record: _Record, k: int
    ) -> list[tuple[int, Array]]:
        """`fext` of state k by joint: minus the sum of the loads."""
        total: dict[int, Array] = {}
        for load, forces in zip(loads, on_joints, strict=True):
            link, force = self.links[load.link], forces[k]
            if load.in_base:
                turn = record.base_to_link[k, load.link]
                force = link.to_joint((turn @ force[:3])[None], (turn @ force[3:])[None])[0]
            total[link.joint] = total.get(link.joint, 0.0) - force
        return list(total.items())

    def _net(self, record: _Record) -> tuple[Array, Array]:
        """F, N: mass times acceleration of the centre of mass, and Euler's equation about it."""
        F, N = (np.empty((len(record.tau), len(self.links), 3)) for _ in "FN")
        for i, link in enumerate(self.links):
            v, w = np.split(record.spatial[:, 1, link.joint], 2, axis=-1)
            v_dot, w_dot = np.split(record.spatial[:, 2, link.joint], 2, axis=-1)
            c = link.p + link.R @ link.com
            # a_gf is a spatial acceleration: w x v makes it that of the point at the origin.
            at_com = v_dot + np.cross(w, v) + np.cross(w_dot, c) + np.cross(w, np.cross(w, c))
            F[:, i] = link.mass * at_com @ link.R
            w, w_dot = w @ link.R, w_dot @ link.R
            N[:, i] = w_dot @ link.inertia + np.cross(w, w @ link.inertia)
        return F, N

    def _across_joints(self, record: _Record, loads: Sequence[Load]) -> tuple[Array, Array]:
        """f, n: what crosses each joint, moving or fixed."""
        out = np.zeros((len(record.tau), len(self.links), 6))
        for i, link in enumerate(self.links):
            if not link.fixed:
                out[:, i] = record.spatial[:, 0, link.joint]
                continue
            out[:, i] = record.supported[:, i]
            for load in loads:  # fext acts on the joint as a whole; a fixed joint inside it does not see it
                if self._rigidly_carries(i, load.link):
                    out[:, i] += self._carried(load, i, record)
        return out[..., :3], out[..., 3:]

    def _rigidly_carries(self, i: int, outer: int) -> bool:
        """Whether link `outer` is link i, or is held to it by fixed joints further out."""
        return self.links[outer].joint == self.links[i].joint and i in self.model.path(outer)

    def _rounding(self, record: _Record, q: Array, loads: Sequence[Load]) -> dict[str, Array]:
        """What Pinocchio's formulas round beyond ours, and what passing a payload through `fext` does."""
        out = rounding(self.pin_model, self.links, record.spatial, self._reach(q))
        for i, link in enumerate(self.links):
            if link.fixed and self._supported[i] is None:  # nothing but loads acts there
                out["f"][:, i] = out["n"][:, i] = 0.0
        for load in loads:
            size = np.linalg.norm(np.atleast_2d(load.f), axis=-1)
            for i, link in enumerate(self.links):
                if link.fixed and i != load.link and self._rigidly_carries(i, load.link):
                    arms = np.linalg.norm(link.p) + np.linalg.norm(self.links[load.link].p)
                    out["n"][:, i] += OPERATIONS * EPS * arms * size
        return out

    def _reach(self, q: Array) -> Array:
        """At most how far each joint's origin is from that of the joint further in, (N, njoints) [m]."""
        out = np.tile([np.linalg.norm(x.translation) for x in self.pin_model.jointPlacements], (len(q), 1))
        for column, joint in enumerate(self.model.moving):
            if joint.type is JointType.PRISMATIC:
                out[:, self.pin_model.getJointId(joint.name)] += np.abs(q[:, column])
        return out

    def _carried(self, load: Load, i: int, record: _Record) -> Array:
        """A load further out on the same rigid body, as a force and moment at link i, (N, 6)."""
        f, n = (np.broadcast_to(x, (len(record.tau), 3)) for x in (load.f, load.n))
        if load.link == i and not load.in_base:
            return np.concatenate([f, n], axis=1)
        if load.in_base:
            turn = record.base_to_link[:, load.link]
            f, n = (np.einsum("kij,kj->ki", turn, x) for x in (f, n))
        return self.links[i].from_joint(self.links[load.link].to_joint(f, n))

    def _supported_force(self, i: int) -> Callable[[], Array] | None:
        """What reads f, n of a fixed joint from `data`; None for a moving one, or where nothing but loads acts."""
        link = self.links[i]
        beyond = [k for k in range(len(self.links)) if i in self.model.path(k)]
        if not link.fixed or not any(self.links[k].mass or not self.links[k].fixed for k in beyond):
            return None
        frame = self.pin_model.getFrameId(self.model.joints[i].name)
        model, data = self.pin_model, self.data
        if link.joint:
            return lambda: pin.computeSupportedForceByFrame(model, data, frame).vector.copy()
        placement = pin.SE3(link.R, link.p)
        outer = [self.links[k].joint for k in beyond if not self.links[k].fixed]
        hanging = [joint for joint in outer if model.parents[joint] == 0]

        def on_the_root() -> Array:
            """For a frame of the universe Pinocchio leaves out the joints that hang on it."""
            total = pin.computeSupportedForceByFrame(model, data, frame)
            for joint in hanging:
                total += placement.actInv(data.liMi[joint].act(data.f[joint]))
            return np.array(total.vector)

        return on_the_root


@dataclass(slots=True)
class _Record:
    """What is kept of a batch.

    Attributes:
        tau: (N, nv).
        spatial: data.f, data.v, data.a_gf of each joint, linear before angular, (N, 3, njoints, 6).
        supported: supported force of each fixed joint, (N, links, 6).
        base_to_link: rotation from base to link axes, (N, links, 3, 3); filled where a load is in base axes.
    """

    tau: Array
    spatial: Array
    supported: Array
    base_to_link: Array

    @classmethod
    def empty(cls, rows: int, joints: int, nv: int, links: int) -> _Record:
        return cls(
            np.empty((rows, nv)),
            np.empty((rows, 3, joints, 6)),
            np.zeros((rows, links, 6)),
            np.empty((rows, links, 3, 3)),
        )
