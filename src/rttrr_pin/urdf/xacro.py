"""xacro files: programs that write a URDF.

Their expressions are evaluated as Python, which `eval` does not confine, and may read files and the environment. So a
file is expanded only where the user asks for it (`Reading.xacro`), and never because it lies in a folder.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rttrr_pin.errors import InputError, UrdfError
from rttrr_pin.urdf.packages import find_package

SUFFIX = ".xacro"

NAMESPACE = b"xmlns:xacro"
"""What a file declares that has xacro in it, whatever its name ends in."""


def is_xacro(path: Path, text: bytes) -> bool:
    """Whether a file is to be expanded before it is a URDF, if that is asked for."""
    return path.suffix == SUFFIX or NAMESPACE in text


def refusal(path: Path) -> UrdfError:
    """The error of a file that nobody asked to expand."""
    return UrdfError(
        "is a xacro file, and expanding it runs the Python expressions in it: if you trust it, "
        "add --xacro (load(..., xacro=True)), or run xacro yourself and pass the URDF",
        source=str(path),
    )


def arguments(words: Mapping[str, object]) -> dict[str, str]:
    """The values of <xacro:arg>, as xacro takes them.

    Raises:
        InputError: a name is empty.
    """
    if not isinstance(words, Mapping):
        raise InputError(f"xacro_args is a {type(words).__name__}: pass a dict, such as {{'dof': 7}}")
    if not all(isinstance(name, str) and name for name in words):
        raise InputError("an argument of xacro has no name: write NAME:=VALUE")
    return {name: str(value).lower() if isinstance(value, bool) else str(value) for name, value in words.items()}


def expanded(path: Path, given: Mapping[str, object], packages: Mapping[str, Path]) -> bytes:
    """The URDF that a xacro file stands for, line by line what the command `xacro FILE NAME:=VALUE ...` prints.

    Raises:
        UrdfError: xacro is not installed, or cannot expand the file.
    """
    try:
        import xacro
        from xacro import substitution_args
    except ImportError:
        raise UrdfError(
            "is a xacro file, which needs the package xacro: pip install 'rttrr-pin[xacro]'", source=str(path)
        ) from None
    try:
        with _packages_of(substitution_args, path.absolute().parent, packages):
            text: str = xacro.process_file(str(path), mappings=dict(given)).toprettyxml(indent="  ")
        return text.encode()
    except RecursionError:
        raise UrdfError("xacro cannot expand it: a macro calls itself without end", source=str(path)) from None
    except Exception as error:  # the file's own expressions run here, and may raise anything
        reason = " ".join(str(error).split()) or repr(error)
        raise UrdfError(f"xacro cannot expand it: {reason}{_fix(reason)}", source=str(path)) from error


@contextmanager
def _packages_of(substitution: Any, folder: Path, packages: Mapping[str, Path]) -> Iterator[None]:
    """Let xacro's `$(find ...)` look where `find_package` does, and ask ROS only then."""
    ask_ros = substitution._eval_find

    def find_or_ask(name: str) -> str:
        package = find_package(name, folder, packages)
        return ask_ros(name) if package is None else str(package)

    substitution._eval_find = substitution._eval_dict["find"] = find_or_ask
    try:
        yield
    finally:
        substitution._eval_find = substitution._eval_dict["find"] = ask_ros


def _fix(reason: str) -> str:
    if "ament_index_python" in reason:
        return ": a package was not found; name its folder by --package NAME=FOLDER, packages={...}"
    if "Undefined substitution argument" in reason:
        return ": add --xacro-arg NAME:=VALUE (load(..., xacro_args={'NAME': 'VALUE'})), or give it a default"
    return ""
