"""MJCF files, MuJoCo's own format: MuJoCo compiles them, and its model is read like any that a user holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rttrr_pin.errors import UrdfError, shortened


def compiled_mjcf(path: Path) -> Any:
    """The `mujoco.MjModel` of an MJCF file, with the files that it names.

    Raises:
        UrdfError: MuJoCo is not installed, or refuses the file.
    """
    source = shortened(str(path))
    try:
        import mujoco
    except ImportError:
        raise UrdfError(
            "is MJCF, which MuJoCo reads: pip install 'rttrr-pin[mujoco]', or pass a URDF", source=source
        ) from None
    from rttrr_pin.implementations.mujoco_model import without_log

    try:
        with without_log():
            return mujoco.MjModel.from_xml_path(str(path))
    except ValueError as error:
        raise UrdfError(f"MuJoCo refuses the file: {str(error).strip()}", source=source) from error
