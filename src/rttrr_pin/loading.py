"""From a file, a folder or a name to robots."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from numpy.typing import ArrayLike

from rttrr_pin.core.arguments import choice
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.inputs import vectors
from rttrr_pin.core.joints import FLOATING
from rttrr_pin.core.model import STANDARD_GRAVITY, Model
from rttrr_pin.errors import InputError, LoadWarning, ShapeError
from rttrr_pin.robot import Robot
from rttrr_pin.urdf.catalogue import robots_in
from rttrr_pin.urdf.packages import named_packages
from rttrr_pin.urdf.sources import AnySource, Reading, mjcf_path


def load(
    source: AnySource,
    gravity: ArrayLike | None = None,
    base: Literal["fixed", "floating"] = "fixed",
    friction: bool = False,
    xacro: bool = False,
    xacro_args: Mapping[str, object] | None = None,
    lenient: bool = False,
    mimic: bool = True,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
) -> Robot:
    """Load a robot.

    An object is read as it stands: joints keep their order, armature is part of tau, gravity is the object's. What it
    has and a tree of links and joints has not (springs, closed loops, ...) takes no part, and a `LoadWarning` says so;
    `robot.model.notes` has all that there is to say, and the reports of `validate` show it.

    Args:
        source: the name of a bundled robot (`"rttrr"`) or of an example robot (`"example:panda"`, with the extra
            `robots`); the path of a URDF, of a xacro file (see `xacro`), of an MJCF file (with the extra `mujoco`), or
            of a folder with one such file; the text of a URDF; or an object: `pinocchio.Model`, `mujoco.MjModel`,
            `yourdfpy.URDF`.
        gravity: the gravity field in the base frame, (3,) [m/s^2]: a free body accelerates by it. Without it that of
            the object or MJCF file, and (0, 0, -9.81) of a URDF.
        base: `"floating"` puts the root link on a floating joint (Pinocchio's `root_joint`): seven more coordinates,
            position and quaternion (x, y, z, w), and six more rates, the twist in the root link's frame. An object
            that floats already stays as it is.
        friction: whether damping and friction of the joints take part in tau. Pinocchio's `rnea` leaves them out;
            MuJoCo's `mj_inverse` has them.
        xacro: whether a xacro file is expanded (with the extra `xacro`). That runs the Python expressions in it: only
            for files that you trust.
        xacro_args: values of the file's <xacro:arg>, such as `{"dof": 7}`; with some, a xacro file is expanded.
        lenient: whether to go on where a URDF does not say what a number is, or says it in two ways: a joint without
            axis or limits, unequal duplicates, missing entries, ... What is assumed stands in `robot.model.notes`, in
            the reports of `validate`, and in the text that other programs are handed.
        mimic: whether joints with <mimic> follow others; without it each moves by itself, as in Pinocchio unless it is
            asked.
        packages: folders by the names of ROS packages, for `$(find ...)` and `package://...`. Others are looked for
            by their `package.xml`: upwards from the file, beside it, and in ROS_PACKAGE_PATH.

    Returns:
        The robot, its links and joints in Pinocchio's order for the same file, or in the object's.

    Raises:
        UnknownNameError: there is neither such a file nor such a bundled robot, or no such example robot.
        UrdfError: the file or object cannot be used; the message says where and why.
        ShapeError, NumberError: gravity is no vector of three finite numbers.
        InputError: the source is of another type, an extra is missing, or base is neither "fixed" nor "floating".
    """
    from rttrr_pin.urdf.reader import read_urdf  # loads lxml, which a robot made from numbers does not need

    choice("base", base, "fixed", "floating", option="--base")
    field = None if gravity is None else _field(gravity)
    file = mjcf_path(source)
    if file is not None:
        from rttrr_pin.implementations.mjcf import mjcf_source

        source = mjcf_source(file)
    arguments = {} if xacro_args is None else xacro_args
    model = read_urdf(
        source, Reading(xacro, arguments, lenient, mimic, named_packages({} if packages is None else packages))
    )
    if field is not None:
        model = model.with_gravity(field)
    if base == "floating":
        model = _floating(model)
    if not friction:
        model = model.without_friction()
    model = replace(model, notes=tuple(note for note in model.notes if not (friction and note.friction)))
    left_out = [note.text for note in model.notes if note.left_out]
    if left_out:
        source = getattr(model.document, "source", model.name)
        warnings.warn(f"{source}: {'; '.join(left_out)}", LoadWarning, stacklevel=2)
    return Robot(model)


def _field(gravity: ArrayLike) -> Array:
    field = vectors("gravity", gravity)
    if field.ndim != 1:
        raise ShapeError(
            f"gravity has shape {field.shape}, expected (3,): pass one vector, such as {STANDARD_GRAVITY}",
            name="gravity",
            got=field.shape,
            wanted="(3,)",
        )
    return field


def _floating(model: Model) -> Model:
    """The robot on a floating base, unless it is an object's that floats already."""
    library = getattr(model.document, "made_from", "")
    if library and model.joints and all(joint.type == FLOATING for joint in model.joints if joint.parent < 0):
        return model
    if library == "mujoco.MjModel":
        raise InputError(
            f"base is 'floating', and {model.name!r} stands in MuJoCo's world, which has no mass that could float: "
            "add a <freejoint/> to the body that floats, or pass the URDF",
            options={"base": "--base"},
        )
    return model.with_floating_base()


def load_all(
    folder: str | os.PathLike[str],
    gravity: ArrayLike | None = None,
    base: Literal["fixed", "floating"] = "fixed",
    friction: bool = False,
    xacro: bool = False,
    xacro_args: Mapping[str, object] | None = None,
    lenient: bool = False,
    mimic: bool = True,
    packages: Mapping[str, str | os.PathLike[str]] | None = None,
) -> dict[str, Robot]:
    """Load every robot in a folder and below, its `.urdf` and `.xacro` files, each as `load` does.

    Returns:
        The robots by the paths of their files from the folder, such as `"arms/panda.urdf"`.

    Raises:
        UrdfError: it is no folder, it holds no such file, or one of them cannot be used.
        ShapeError, NumberError, InputError: as in `load`.
    """
    options = (gravity, base, friction, xacro, xacro_args, lenient, mimic, packages)
    return {name: load(path, *options) for name, path in robots_in(folder).items()}
