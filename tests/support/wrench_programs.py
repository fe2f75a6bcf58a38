"""What programs themselves say of the wrenches of joints, by link, in their own axes, about their own point, in their own order.

Each takes a robot and a batch, and returns the accelerations that the program had, (N, nv), and (N, 6) by link; links that it merges into
others are left out. Programs that simulate are given a state, and find the accelerations themselves.
"""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from rttrr_pin import Robot
from rttrr_pin.core.joint import Joint
from rttrr_pin.core.joints import FLOATING
from rttrr_pin.implementations import Batch
from support.pinocchio_states import pin_model, pin_q

Told = tuple[np.ndarray, dict[str, np.ndarray]]


def joint_slices(robot: Robot) -> Iterator[tuple[Joint, slice, slice]]:
    """Each moving joint with its part of q and of v."""
    q = v = 0
    for joint in robot.model.moving:
        yield joint, slice(q, q + joint.nq), slice(v, v + joint.nv)
        q, v = q + joint.nq, v + joint.nv


def pinocchio(robot: Robot, batch: Batch) -> Told:
    import pinocchio as pin

    model = pin_model(robot)
    data = model.createData()
    carrying = {joint.name: link.name for joint, link in zip(robot.model.joints, robot.model.links, strict=True)}
    out: dict[str, list[np.ndarray]] = {carrying[name]: [] for name in list(model.names)[1:]}
    for q, v, a in zip(batch.q, batch.v, batch.a, strict=True):
        pin.rnea(model, data, pin_q(robot, q), v, a)
        for name, link in carrying.items():
            if link in out:
                out[link].append(np.array(data.f[model.getJointId(name)].vector))
    return batch.a, {link: np.array(x) for link, x in out.items()}


def mujoco(robot: Robot, batch: Batch, compiled: Any = None) -> Told:
    """Of what MuJoCo compiles of the robot's text, as its users do, unless a compiled model is passed."""
    import mujoco as mj

    from rttrr_pin.implementations.mujoco_model import without_log

    if compiled is None:
        with without_log():
            compiled = mj.MjModel.from_xml_string(robot.model.urdf)
        compiled.opt.gravity[:] = robot.model.gravity
    compiled.opt.disableflags |= int(mj.mjtDisableBit.mjDSBL_CONTACT)
    data = mj.MjData(compiled)
    names = [compiled.body(i).name for i in range(1, compiled.nbody)]
    out = np.empty((len(batch), compiled.nbody - 1, 6))
    for k in range(len(batch)):
        for joint, at_q, at_v in joint_slices(robot):
            q, v, a = batch.q[k, at_q], batch.v[k, at_v], batch.a[k, at_v]
            if joint.type == FLOATING:
                R = Rotation.from_quat(q[3:]).as_matrix()
                q = q[[0, 1, 2, 6, 3, 4, 5]]
                v, a = np.r_[R @ v[:3], v[3:]], np.r_[R @ (a[:3] + np.cross(v[3:], v[:3])), a[3:]]
            own = compiled.joint(joint.name)
            data.qpos[own.qposadr[0] :][: len(q)] = q
            data.qvel[own.dofadr[0] :][: len(v)], data.qacc[own.dofadr[0] :][: len(v)] = v, a
        mj.mj_inverse(compiled, data)
        mj.mj_rnePostConstraint(compiled, data)
        out[k] = data.cfrc_int[1:]
    return batch.a, {name: out[:, i] for i, name in enumerate(names)}


def drake(robot: Robot, batch: Batch) -> Told:
    """Driven by forces that give the accelerations of the batch, to rounding."""
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import MultibodyForces

    model = robot.model
    plant = MultibodyPlant(0.0)
    (instance,) = Parser(plant).AddModelsFromString(model.urdf, "urdf")
    if not model.floating:
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(model.root.name))
    plant.mutable_gravity_field().set_gravity_vector(model.gravity)
    plant.Finalize()
    context, forces = plant.CreateDefaultContext(), MultibodyForces(plant)
    joints = [plant.get_joint(index) for index in plant.GetJointIndices(instance)]
    of_link = {joint.child_body().name(): joint for joint in joints if joint.child_body().name() in robot.link_names}
    links = {joint.name: link.name for joint, link in zip(model.joints, model.links, strict=True)}
    accelerations, out = np.empty_like(batch.a), {name: np.empty((len(batch), 6)) for name in of_link}
    for k in range(len(batch)):
        q, v, a = (np.zeros(n) for n in (plant.num_positions(), plant.num_velocities(), plant.num_velocities()))
        turns = {}
        for joint, at_q, at_v in joint_slices(robot):
            own, x, y, z = of_link[links[joint.name]], batch.q[k, at_q], batch.v[k, at_v], batch.a[k, at_v]
            if joint.type == FLOATING:
                R = turns[joint.name] = Rotation.from_quat(x[3:]).as_matrix()
                x = x[[6, 3, 4, 5, 0, 1, 2]]
                y, z = np.r_[R @ y[3:], R @ y[:3]], np.r_[R @ z[3:], R @ (z[:3] + np.cross(y[3:], y[:3]))]
            q[own.position_start() :][: len(x)] = x
            v[own.velocity_start() :][: len(y)], a[own.velocity_start() :][: len(z)] = y, z
        plant.SetPositionsAndVelocities(context, np.r_[q, v])
        plant.CalcForceElementsContribution(context, forces)
        tau = plant.CalcInverseDynamics(context, a, forces)
        plant.get_applied_generalized_force_input_port().FixValue(context, tau)
        found = plant.get_generalized_acceleration_output_port().Eval(context)
        for joint, _, at_v in joint_slices(robot):
            own = of_link[links[joint.name]]
            z = found[own.velocity_start() :][: joint.nv]
            if joint.type == FLOATING:
                R, y = turns[joint.name].T, batch.v[k, at_v]
                z = np.r_[R @ z[3:] - np.cross(y[3:], y[:3]), R @ z[:3]]
            accelerations[k, at_v] = z
        reactions = plant.get_reaction_forces_output_port().Eval(context)
        for name, joint in of_link.items():
            out[name][k] = reactions[int(joint.index())].get_coeffs()
    return accelerations, out


def dart(robot: Robot, batch: Batch) -> Told:
    """Gazebo's engine: `getBodyForce`, the wrench that `GetTransmittedWrench` of gz-physics takes to the joint's frame."""
    import dartpy

    skeleton = dartpy.utils.DartLoader().parseSkeletonString(robot.model.urdf, "")
    skeleton.setGravity(np.array(robot.model.gravity))
    out = {name: np.empty((len(batch), 6)) for name in robot.link_names}
    for k in range(len(batch)):
        for joint, at_q, at_v in joint_slices(robot):
            own = skeleton.getJoint(joint.name)
            own.setPositions(batch.q[k, at_q])
            own.setVelocities(batch.v[k, at_v])
            own.setAccelerations(batch.a[k, at_v])
        skeleton.computeInverseDynamics(False, False)
        for name in out:
            out[name][k] = skeleton.getBodyNode(name).getBodyForce()
    return batch.a, out


def free_accelerations(robot: Robot, batch: Batch) -> np.ndarray:
    """Of joints that nothing drives."""
    rest = robot.nonlinear_effects(batch.q, batch.v)
    return np.linalg.solve(robot.mass_matrix(batch.q), -rest[..., None])[..., 0]


def newton(robot: Robot, batch: Batch) -> Told:
    """`SolverFeatherstone`, whose wrenches are those of no acceleration."""
    import newton as nt
    import warp

    warp.config.quiet = True
    builder = nt.ModelBuilder(gravity=tuple(robot.model.gravity))
    builder.add_urdf(robot.model.urdf)
    model = builder.finalize(device="cpu")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model.request_state_attributes("body_parent_f")
    before, after, control = model.state(), model.state(), model.control()
    solver = nt.solvers.SolverFeatherstone(model, angular_damping=0.0)
    joints = [label.rpartition("/")[2] for label in model.joint_label]
    bodies = [label.rpartition("/")[2] for label in model.body_label]
    starts = model.joint_q_start.numpy(), model.joint_qd_start.numpy()
    out = {name: np.empty((len(batch), 6)) for name in bodies if name in robot.link_names}
    for k in range(len(batch)):
        q, v = model.joint_q.numpy(), model.joint_qd.numpy()
        for joint, at_q, at_v in joint_slices(robot):
            i = joints.index(joint.name)
            q[starts[0][i]], v[starts[1][i]] = batch.q[k, at_q][0], batch.v[k, at_v][0]
        before.joint_q.assign(q)
        before.joint_qd.assign(v)
        nt.eval_fk(model, before.joint_q, before.joint_qd, before)
        solver.step(before, after, control, None, 1e-4)
        told = after.body_parent_f.numpy()
        for name, x in out.items():
            x[k] = told[bodies.index(name)]
    return 0.0 * batch.a, out


def physx(robot: Robot, batch: Batch) -> Told:
    """Each state in a scene of its own, stepped once; the joints are free.

    PhysX says it in the frame that the joint has on the child's side, from which it is taken to the link's here.
    """
    import ovphysx
    import ovstage
    from ovphysx.samples.python_samples.schema_support import physx_schema_paths

    from support.usd_robot import child_frame, usd_of

    ovstage.population.register_usd_schemas([*map(str, physx_schema_paths()), str(ovphysx.newton_schema_root())])
    out = {name: np.empty((len(batch), 6)) for name in robot.link_names}
    for k in range(len(batch)):
        with tempfile.NamedTemporaryFile("w", suffix=".usda") as file:
            file.write(usd_of(robot.model, batch.q[k], batch.v[k]))
            file.flush()
            stage = ovstage.Stage("robot")
            ovstage.population.open_usd(stage, file.name, ordinal=1, domains=ovstage.PopulationDomain.ALL)
        stage.advance_write_floor(ordinal=1).wait()
        engine = ovphysx.PhysX()
        engine.wait_task(engine.attach_ovstage(stage, read_ordinal=1))
        engine.step_sync(1e-4)
        numbers = _incoming(engine)
        for i, name in enumerate(robot.link_names):
            R, p = child_frame(robot.model.joints[i])
            f, n = R @ numbers[1 + i, :3], R @ numbers[1 + i, 3:]
            out[name][k] = np.r_[f, n + np.cross(p, f)]
        engine.wait_task(engine.detach_ovstage())
        engine.destroy()
        stage.destroy()
    return free_accelerations(robot, batch), out


def _incoming(engine: Any) -> np.ndarray:
    """The wrench of each link as PhysX has it, in a copy: its own arrays must be gone before the engine is."""
    from ovphysx.types import ObjectScope, SimObjectType

    with engine.read_sync(SimObjectType.ARTICULATION_LINK, ["linkIncomingJointForce"], scope=ObjectScope.ALL) as told:
        return np.concatenate([np.array(group.tensors[0].numpy()) for group in told.groups if group.tensors])
