"""xacro files: programs that write a URDF.

Their expressions are evaluated as Python, which `eval` does not confine, and may read files and the environment. So a
file is expanded only where the user asks for it (`Reading.xacro`), and never because it lies in a folder.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from rttrr_pin.errors import InputError, UrdfError
from rttrr_pin.urdf.files import note_read
from rttrr_pin.urdf.packages import find_package, not_found

SUFFIX = ".xacro"

NAMESPACE = b"xmlns:xacro"
"""What a file declares that has xacro in it, whatever its name ends in."""

FIND, ARGUMENT = (re.compile(rf"\$\({word}\s+([^\s()$]+)\s*\)") for word in ("find", "arg"))
"""Where a package's folder, or the value of an argument, is asked for."""

DECLARED = re.compile(r"<xacro:arg\b[^>]*?\sname\s*=\s*[\"']([^\"']*)")
"""Where an argument has its default."""

TWICE = re.compile(r"<class '[^']*'>: (.+?) \1(?= |$)")
"""How xacro tells an error of its functions."""


class PackageNotFoundError(LookupError):
    """A package that neither we nor ROS know; its name is the argument."""


def is_xacro(path: Path, text: bytes) -> bool:
    """Whether a file is to be expanded before it is a URDF, if that is asked for."""
    return has_suffix(path) or NAMESPACE in text


def has_suffix(path: Path) -> bool:
    """Whether a file is xacro by its name, in capitals too."""
    return path.suffix.lower() == SUFFIX


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


def expanded(path: Path, values: Mapping[str, object], packages: Mapping[str, Path]) -> bytes:
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
    folder, before = path.absolute().parent, len(getattr(xacro, "all_includes", ()))

    def find(name: str) -> Path | None:
        """A package, from the folder of the file, or of one that it includes."""
        included = (Path(file).absolute().parent for file in getattr(xacro, "filestack", ()) if file)
        places = (find_package(name, start, packages) for start in dict.fromkeys([folder, *included]))
        return next((place for place in places if place is not None), None)

    try:
        with _packages_of(substitution_args, find):
            text: str = xacro.process_file(str(path), mappings=dict(values)).toprettyxml(indent="  ")
        for included in xacro.all_includes[before:]:
            note_read(Path(included))
        return text.encode()
    except RecursionError:
        raise UrdfError("xacro cannot expand it: a macro calls itself without end", source=str(path)) from None
    except (Exception, SystemExit) as error:  # the file's own expressions run here, and may raise anything
        files = [path, *map(Path, getattr(xacro, "all_includes", ())[before:])]
        reason = _reason(error, _texts(files), values, folder, find)
        raise UrdfError(f"xacro cannot expand it: {reason}", source=str(path)) from error


@contextmanager
def _packages_of(substitution: Any, find: Callable[[str], Path | None]) -> Iterator[None]:
    """Let xacro's `$(find ...)` look where we do, and ask ROS only then."""
    ask_ros = substitution._eval_find

    def find_or_ask(name: str) -> str:
        if (package := find(name)) is not None:
            return str(package)
        try:
            return str(ask_ros(name))
        except Exception:  # ROS is not there, or does not know it either
            raise PackageNotFoundError(name) from None

    substitution._eval_find = substitution._eval_dict["find"] = find_or_ask
    try:
        yield
    finally:
        substitution._eval_find = substitution._eval_dict["find"] = ask_ros


def _reason(
    error: BaseException,
    text: str,
    given: Mapping[str, object],
    folder: Path,
    find: Callable[[str], Path | None],
) -> str:
    """What stops xacro, and the fix; of packages and arguments all that are missing, as far as it has read."""
    for cause in _causes(error):
        if isinstance(cause, PackageNotFoundError):
            missing = [name for name in FIND.findall(text) if find(name) is None]
            return not_found(dict.fromkeys([*cause.args, *missing]), folder)
        if type(cause).__name__ == "ArgException":  # of xacro, which may not be installed
            known = {*given, *DECLARED.findall(text)}
            names = dict.fromkeys([*cause.args, *(name for name in ARGUMENT.findall(text) if name not in known)])
            options = " ".join(f"--xacro-arg {name}:=VALUE" for name in names)
            return (
                f"Undefined substitution argument: no value for {', '.join(names)}; add {options} "
                f"(load(..., xacro_args={{{', '.join(f'{name!r}: VALUE' for name in names)}}}))"
            )
        if isinstance(cause, OSError) and cause.filename:
            return (
                f"it reads {cause.filename}: {cause.strerror}; check that name, the arguments that it is made of "
                "(--xacro-arg NAME:=VALUE), and the folder of its package (--package NAME=FOLDER)"
            )
    return TWICE.sub(r"\1", " ".join(str(error).split())) or repr(error)


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    """An error, and those that it wraps."""
    while error is not None:
        yield error
        error = error.__cause__ or error.__context__


def _texts(files: Iterable[Path]) -> str:
    """The texts of the files that can be read."""
    texts = []
    for file in dict.fromkeys(files):
        with suppress(OSError, ValueError):
            texts.append(file.read_text(encoding="utf-8", errors="replace"))
    return "\n".join(texts)
