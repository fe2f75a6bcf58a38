"""What programs call the wrench of a joint: axes, point, sign and order. It stands here once.

`CONVENTIONS` is the table of docs/wrenches.md; `joint_wrenches.py` has numbers in its rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rttrr_pin.core.arrays import Array, product
from rttrr_pin.errors import UnknownNameError

AXES = {"link": "axes of the child link", "base": "axes of the world"}
POINTS = {
    "origin": "the child link's origin",
    "com": "the child link's centre of mass",
    "tree": "the centre of mass of the tree of bodies",
}


@dataclass(frozen=True, slots=True)
class Convention:
    """How a program says what crosses a joint.

    Attributes:
        name: what `in_convention` takes.
        program: the program, and the version that was read or run.
        quantity: what it is called there.
        axes: of the components: `"link"` is {i}, the frame of the child link; `"base"` is {0}, the world of a robot
            that stands at its origin.
        point: what the moment is about: `"origin"` of {i}, `"com"` of the link, or `"tree"`, the centre of mass of the
            tree of bodies that the link belongs to (see `tree_centres`).
        acts_on: `"child"`: what the parent exerts on the child, as f and n; `"parent"`: minus that.
        first: which three of the six numbers come first: `"force"` or `"moment"`.
        fixed: what it says of a fixed joint.
        remark: what else its users meet.
        source: where it says so.
        verified: how we know.
    """

    name: str
    program: str
    quantity: str
    axes: Literal["link", "base"]
    point: Literal["origin", "com", "tree"]
    acts_on: Literal["child", "parent"]
    first: Literal["force", "moment"]
    fixed: str
    remark: str
    source: tuple[str, ...]
    verified: str

    @property
    def words(self) -> str:
        """Axes, point, on whom and order in one line."""
        said = (
            AXES[self.axes],
            f"moment about {POINTS[self.point]}",
            f"exerted on the {self.acts_on}",
            f"{self.first} first",
        )
        return "; ".join(said)

    @property
    def sign(self) -> float:
        """1 where it is f and n, -1 where it is minus them."""
        return 1.0 if self.acts_on == "child" else -1.0

    def of_link(self, f: Array, n: Array, R: Array, r: Array) -> tuple[Array, Array]:
        """Force and moment as the program says them.

            force = s R f,   moment = s (R n - r x R f)

        Args:
            f: force in {i}, (..., 3) [N].
            n: moment about the origin of {i}, in {i}, (..., 3) [N m].
            R: maps vectors of {i} to the axes of the program, (..., 3, 3).
            r: from the origin of {i} to the program's point, in the axes of the program, (..., 3) [m].
        """
        force, moment = product(R, f), product(R, n)
        return self.sign * force + 0.0, self.sign * (moment - np.cross(r, force)) + 0.0  # no zero has a minus

    def to_link(self, force: Array, moment: Array, R: Array, r: Array) -> tuple[Array, Array]:
        """Force f and moment n of what the program says, the inverse of `of_link`.

        f = s R^T force,   n = s R^T (moment + r x force)
        """
        R_T = np.swapaxes(R, -1, -2)
        return self.sign * product(R_T, force), self.sign * product(R_T, moment + np.cross(r, force))


def convention(name: str) -> Convention:
    """The row of the table.

    Raises:
        UnknownNameError: there is none of this name.
    """
    named = {row.name: row for row in CONVENTIONS}
    if not isinstance(name, str) or name not in named:
        raise UnknownNameError("convention", name, tuple(named))
    return named[name]


GITHUB = "https://github.com"

CONVENTIONS = (
    Convention(
        name="pinocchio",
        program="Pinocchio 4.1",
        quantity="`data.f[i]` after `rnea`",
        axes="link",
        point="origin",
        acts_on="child",
        first="force",
        fixed="merged into the link that carries it; `computeSupportedForceByFrame` tells what crosses it",
        remark="`aba` leaves other numbers in `data.f`; armature is part of tau alone",
        source=(
            f"{GITHUB}/stack-of-tasks/pinocchio/blob/v4.1.0/include/pinocchio/src/algorithm/rnea.hxx#L75-L107",
            "https://docs.ros.org/en/jazzy/p/pinocchio/",
        ),
        verified="run: Pinocchio 4.1.0",
    ),
    Convention(
        name="mujoco",
        program="MuJoCo 4.0",
        quantity="`data.cfrc_int[body]` after `mj_rnePostConstraint`",
        axes="base",
        point="tree",
        acts_on="child",
        first="moment",
        fixed="a URDF's is merged into the link that carries it, that of an MJCF has a body unless `fusestatic` is set",
        remark="the point is `subtree_com[body_rootid[body]]`; contacts count too",
        source=(
            f"{GITHUB}/google-deepmind/mujoco/blob/a7255075/src/engine/engine_core_smooth.c#L2394",
            "https://mujoco.readthedocs.io/en/stable/APIreference/APItypes.html#c-frame-variables",
        ),
        verified="run: MuJoCo 4.0.0",
    ),
    Convention(
        name="drake",
        program="Drake 1.51",
        quantity="`get_reaction_forces_output_port()`, entry `joint.index()`",
        axes="link",
        point="origin",
        acts_on="child",
        first="moment",
        fixed="a weld, with a wrench of its own",
        remark="a discrete plant whose output ports are sampled gives zeros until its first step",
        source=(
            f"{GITHUB}/RobotLocomotion/drake/blob/be259df7/multibody/plant/multibody_plant.cc#L4458-L4556",
            "https://drake.mit.edu/doxygen_cxx/classdrake_1_1multibody_1_1_multibody_plant.html",
        ),
        verified="run: Drake 1.51.1",
    ),
    Convention(
        name="isaaclab",
        program="Isaac Lab 3.0, PhysX 5",
        quantity="`JointWrenchSensor`, `incoming_joint_frame`; `get_link_incoming_joint_force()`",
        axes="link",
        point="origin",
        acts_on="child",
        first="force",
        fixed="a joint, with a wrench of its own, unless the importer merges it",
        remark="the frame is the joint's `localPos1`, `localRot1`: {i} where these are none; the root has zeros",
        source=(
            f"{GITHUB}/NVIDIA-Omniverse/PhysX/blob/a3d8a641/physx/include/PxArticulationReducedCoordinate.h#L313-L324",
            f"{GITHUB}/isaac-sim/IsaacLab/blob/main/source/isaaclab/isaaclab/sensors/joint_wrench/"
            "joint_wrench_sensor_cfg.py",
        ),
        verified="run: PhysX of ovphysx 0.7.0, in float32",
    ),
    Convention(
        name="gazebo",
        program="Gazebo (gz-sim)",
        quantity="sensor `force_torque` of a joint",
        axes="link",
        point="origin",
        acts_on="parent",
        first="force",
        fixed="merged into the link that carries it, unless `<preserveFixedJoint>` is true",
        remark="with the defaults `child` (frame) and `child_to_parent`; `parent_to_child` has f and n",
        source=(
            f"{GITHUB}/gazebosim/gz-sensors/blob/9ba02f24/src/ForceTorqueSensor.cc#L210-L239",
            f"{GITHUB}/gazebosim/gz-sim/blob/93bbf3ed/src/systems/force_torque/ForceTorque.cc#L323-L335",
            f"{GITHUB}/gazebosim/sdformat/blob/2ace5362/sdf/1.12/forcetorque.sdf",
        ),
        verified="its engine run: DART 6.20.0 (`getBodyForce`, moment first, on the child); the sensor read",
    ),
    Convention(
        name="newton",
        program="Newton 1.8",
        quantity="`state.body_parent_f[body]`",
        axes="base",
        point="com",
        acts_on="child",
        first="force",
        fixed="a joint, with a wrench of its own, unless `collapse_fixed_joints` is set",
        remark="`SolverFeatherstone` leaves out what the joint accelerations add",
        source=(
            f"{GITHUB}/newton-physics/newton/blob/41a5392c/newton/_src/sim/state.py#L156-L164",
            f"{GITHUB}/newton-physics/newton/blob/41a5392c/newton/_src/solvers/mujoco/kernels.py#L3022-L3029",
        ),
        verified="run: Newton 1.8.0, `SolverFeatherstone`, in float32",
    ),
    Convention(
        name="featherstone",
        program="Featherstone's book, spatial_v2",
        quantity="f_i of the recursive Newton-Euler algorithm",
        axes="link",
        point="origin",
        acts_on="child",
        first="moment",
        fixed="none: bodies are joined by joints that move",
        remark="in the book's version in body coordinates",
        source=(
            "R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, section 5.3, table 5.1",
            f"{GITHUB}/ROAM-Lab-ND/spatial_v2_extended/blob/881988b9/v3/dynamics/ID.m#L34-L69",
            "https://royfeatherstone.org/spatial/v2/",
        ),
        verified="read; Drake and DART say the same, and were run",
    ),
)
"""Versions are those that were run or read."""
