"""From a file, a folder or a name to robots."""

from __future__ import annotations

import os
from typing import Literal

from numpy.typing import ArrayLike

from rttrr_pin.core.inputs import vectors
from rttrr_pin.core.model import STANDARD_GRAVITY
from rttrr_pin.errors import InputError, ShapeError
from rttrr_pin.robot import Robot
from rttrr_pin.urdf.sources import AnySource, robots_in


def load(
    source: AnySource,
    gravity: ArrayLike = STANDARD_GRAVITY,
    base: Literal["fixed", "floating"] = "fixed",
    friction: bool = False,
) -> Robot:
    """Load a robot.

    Args:
        source: the name of a bundled robot (`"rttrr"`) or of an example robot (`"example:panda"`, with the extra
            `robots`); the path of a URDF, of a xacro file (with the extra `xacro`), or of a folder with one of them;
            the text of a URDF; or a `yourdfpy.URDF`.
        gravity: the gravity field in the base frame, (3,) [m/s^2]: a free body accelerates by it.
        base: `"floating"` puts the root link on a floating joint (Pinocchio's `root_joint`): seven more coordinates,
            position and quaternion (x, y, z, w), and six more rates, the twist in the root link's frame.
        friction: whether damping and friction of `<dynamics>` take part in tau. Pinocchio's `rnea` leaves them out.

    Returns:
        The robot, its links and joints in Pinocchio's order for the same file.

    Raises:
        UnknownNameError: there is neither such a file nor such a bundled robot, or no such example robot.
        UrdfError: the file cannot be used; the message says where and why.
        ShapeError, NumberError: gravity is no vector of three finite numbers.
        InputError: the source is of another type, an extra is missing, or base is neither "fixed" nor "floating".
    """
    from rttrr_pin.urdf.parser import read_document  # loads lxml, which a robot made from numbers does not need
    from rttrr_pin.urdf.reader import model_of

    field = vectors("gravity", gravity)
    if field.ndim != 1:
        raise ShapeError(
            f"gravity has shape {field.shape}, expected (3,): pass one vector, such as {STANDARD_GRAVITY}",
            name="gravity",
            got=field.shape,
            wanted="(3,)",
        )
    if base not in ("fixed", "floating"):
        raise InputError(f"base is {base!r}: expected 'fixed' (bolted down) or 'floating'")
    model = model_of(read_document(source)).with_gravity(field)
    if base == "floating":
        model = model.with_floating_base()
    return Robot(model if friction else model.without_joint_effects())


def load_all(
    folder: str | os.PathLike[str],
    gravity: ArrayLike = STANDARD_GRAVITY,
    base: Literal["fixed", "floating"] = "fixed",
    friction: bool = False,
) -> dict[str, Robot]:
    """Load every robot in a folder and below, its `.urdf` and `.xacro` files, each as `load` does.

    Returns:
        The robots by the paths of their files from the folder, such as `"arms/panda.urdf"`.

    Raises:
        UrdfError: it is no folder, it holds no such file, or one of them cannot be used.
        ShapeError, NumberError, InputError: as in `load`.
    """
    return {name: load(path, gravity, base, friction) for name, path in robots_in(folder).items()}
