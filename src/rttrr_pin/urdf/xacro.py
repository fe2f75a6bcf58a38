"""xacro files: expanded by the package `xacro` of PyPI, which is ROS's own (github.com/ros/xacro).

A xacro file is a program: its expressions are evaluated as Python, and may read other files and the environment. Expand
only what you would run.
"""

from __future__ import annotations

from pathlib import Path

from rttrr_pin.errors import UrdfError


def expanded(path: Path) -> bytes:
    """The URDF that a xacro file stands for, line by line what the command `xacro FILE` prints.

    Raises:
        UrdfError: the package is missing, or cannot expand the file.
    """
    try:
        import xacro
    except ImportError:
        raise UrdfError(
            "is a xacro file, which needs the package xacro: pip install 'rttrr-pin[xacro]'", source=str(path)
        ) from None
    try:
        text: str = xacro.process_file(str(path)).toprettyxml(indent="  ")
        return text.encode()
    except RecursionError:
        raise UrdfError("xacro cannot expand it: a macro calls itself without end", source=str(path)) from None
    except Exception as error:  # the file's own expressions run here, and may raise anything
        reason = " ".join(str(error).split()) or repr(error)
        raise UrdfError(f"xacro cannot expand it: {reason}{_fix(reason)}", source=str(path)) from error


def _fix(reason: str) -> str:
    """What to do about the commonest causes."""
    if "ament_index_python" in reason:
        return ": $(find ...) asks ROS; source its setup first, or run xacro there and pass the URDF"
    if "Undefined substitution argument" in reason:
        return ": run `xacro FILE NAME:=VALUE` yourself and pass the URDF, or give the argument a default"
    return ""
