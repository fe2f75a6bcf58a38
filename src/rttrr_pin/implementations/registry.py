"""From what a user writes to an implementation: a name, an object, a function, a table of results, a command.

A new one is a module with a class that fulfils `Implementation` and takes a `Model`, and a line in `BUILT_IN`; from
another package, an entry point of the group `rttrr_pin.implementations` that names such a class. Each module is loaded
when one of its kind is asked for.
"""

from __future__ import annotations

import inspect
import os
import pkgutil
import shlex
import shutil
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from rttrr_pin.core.model import Model
from rttrr_pin.errors import ImplementationError, InputError, RefusalError, RttrrError, UnknownNameError, because, told
from rttrr_pin.implementations.protocol import Implementation

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint, EntryPoints

BUILT_IN = {
    "kernel": "rttrr_pin.implementations.own:CompiledKernel",
    "kernel32": "rttrr_pin.implementations.kernel32:Kernel32",
    "recursion": "rttrr_pin.implementations.own:Recursion",
    "pinocchio": "rttrr_pin.implementations.pinocchio:Pinocchio",
    "mujoco": "rttrr_pin.implementations.mujoco:Mujoco",
    "lagrange": "rttrr_pin.implementations.lagrange:Lagrange",
}
"""Where the implementation of each name is."""

EXTRAS = ("mujoco",)
"""Implementations whose library comes with an extra of the same name."""

GROUP = "rttrr_pin.implementations"
"""The entry points by which other packages add theirs."""

Source: TypeAlias = str | os.PathLike[str] | Implementation | Callable[..., Any]
"""What stands for an implementation: see `make_implementation`."""


def names() -> list[str]:
    """The implementations that have a name here."""
    return [*BUILT_IN, *(point.name for point in _registered() if point.name not in BUILT_IN)]


def make_implementation(source: Source, model: Model) -> Implementation:
    """The implementation that a user means, for this robot.

    Args:
        source: a name (`"kernel"`, `"pinocchio"`, ...); an `Implementation`; a function f(q, v, a) of one state or a
            batch; a class or a function of one argument, the `Model`, that makes either; the path of a table of results
            (.csv, .parquet, .jsonl); `"my_module:my_function"`; or the command line of a program that reads states and
            writes results as JSON lines, such as `"./my_id"` or `"./my_id {urdf}"` (`program.PLACES`).
        model: the robot.

    Raises:
        UnknownNameError: it is none of these.
        RefusalError: it does not take the robot.
        ImplementationError: its library is not installed, or it fails.
        InputError: it is of another type.
    """
    if isinstance(source, Implementation) and not isinstance(source, type):
        return source
    if callable(source):
        from rttrr_pin.implementations.function import Function, name_of

        return _made(source, name_of(source), model) if _makes(source) else Function(source, model)
    if not isinstance(source, str | os.PathLike):
        raise InputError(
            f"an implementation is given as {type(source).__name__}: pass a name, a function f(q, v, a), "
            "an Implementation, the path of a table, or a command"
        )
    text = os.fspath(source)
    if text in BUILT_IN:
        return _imported(text)(model)
    for point in _registered():
        if point.name == text:
            return _of_package(point, model)
    if is_table(text):
        from rttrr_pin.implementations.table import Table

        return Table(Path(text), model)
    if _is_command(text):
        from rttrr_pin.implementations.program import Program

        return Program(text, model)
    if _is_in_module(text):
        return make_implementation(_of_module(text), model)
    raise UnknownNameError("implementation", text, names(), _hint(text))


def _hint(text: str) -> str:
    """What the user of a name that is none may have meant."""
    path = text.partition(" ")[0]
    if os.sep in path:
        return f"there is no file {path}"
    return "a program needs its path, such as ./my_id, and a table is a file .csv, .jsonl or .parquet"


def for_one_robot(source: Source) -> bool:
    """Whether it is bound to a robot: a function f(q, v, a), a table, a command that is not told which robot it is."""
    if isinstance(source, Implementation) and not isinstance(source, type):
        return False
    if callable(source):
        return not _makes(source)
    if not isinstance(source, str | os.PathLike) or os.fspath(source) in names():
        return False
    text = os.fspath(source)
    if is_table(text):
        return True
    if _is_command(text):
        from rttrr_pin.implementations.program import PLACES

        return not any(place in text for place in PLACES)
    return _is_in_module(text) and for_one_robot(_of_module(text))


def is_table(source: Source) -> bool:
    """Whether it is the path of a table of results."""
    from rttrr_pin.implementations.table_files import READERS

    if callable(source) or not isinstance(source, str | os.PathLike):
        return False
    text = os.fspath(source)
    return Path(text).suffix.lower() in READERS and (Path(text).is_file() or not _is_command(text))


def _makes(source: Callable[..., Any]) -> bool:
    """Whether it is a class, or a function of one argument: what makes an implementation of a robot.

    Of a kernel q alone is required, and its other arguments say that it is a function f(q, v, a) all the same.
    """
    if isinstance(source, type):
        return True
    try:
        parameters = inspect.signature(source).parameters.values()
    except (TypeError, ValueError):  # of a function in C nothing is known
        return False
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    if [own.name for own in parameters][:3] == ["q", "v", "a"]:
        return False
    needed = [own for own in parameters if own.default is own.empty and own.kind in positional]
    return len(needed) == 1 and not any(own.kind is own.VAR_POSITIONAL for own in parameters)


def _made(factory: Callable[..., Any], name: str, model: Model) -> Implementation:
    """What a class or a function of the user's, or of another package, makes for a robot."""
    from rttrr_pin.implementations.function import Function

    try:
        with np.errstate():  # whatever it sets
            made = factory(model)
    except RttrrError:
        raise
    except NotImplementedError as error:
        raise RefusalError(f"{name} does not take robot {model.name!r}{because(error)}") from error
    except (Exception, SystemExit) as error:
        raise ImplementationError(f"implementation {name} cannot be made: {told(error)}") from error
    if isinstance(made, Implementation) and not isinstance(made, type):
        return made
    if callable(made):
        return Function(made, model, name)
    raise ImplementationError(
        f"implementation {name} is a {type(made).__name__}: "
        "expected one with name, version, quantities and evaluate, or a function f(q, v, a)"
    )


def _is_in_module(text: str) -> bool:
    """Whether it may name something in a module."""
    module, colon, attribute = text.partition(":")
    return bool(colon) and all(part.isidentifier() for part in (*module.split("."), *attribute.split(".")))


def _is_command(text: str) -> bool:
    """Whether it begins with the path of a file, or with a program that the shell would find, and arguments."""
    try:
        words = shlex.split(text)
    except ValueError:  # a quotation mark without its other half
        return False
    first = words[0] if words else ""
    return (os.sep in first and Path(first).is_file()) or (len(words) > 1 and shutil.which(first) is not None)


def _imported(name: str) -> Callable[..., Implementation]:
    module, attribute = BUILT_IN[name].split(":")
    try:
        factory: Callable[..., Implementation] = getattr(import_module(module), attribute)
    except ImportError as error:
        raise ImplementationError(
            f"implementation {name!r} needs the package {error.name!r}, which is not installed: "
            + (f"pip install 'rttrr-pin[{name}]'" if name in EXTRAS else "install it")
        ) from error
    return factory


def _registered() -> EntryPoints:
    """What other packages register."""
    from importlib.metadata import entry_points  # large, and no built-in name needs it

    return entry_points(group=GROUP)


def _of_package(point: EntryPoint, model: Model) -> Implementation:
    """What another package registered."""
    name = f"{point.name!r} ({point.value})"
    try:
        factory = point.load()
    except (Exception, SystemExit) as error:
        raise ImplementationError(f"implementation {name} cannot be loaded: {told(error)}") from error
    return _made(factory, name, model)


def _of_module(text: str) -> Any:
    """A name in a module of the user's, which may lie in the current folder."""
    folder = str(Path.cwd())
    if folder not in sys.path:
        sys.path.insert(0, folder)
    try:
        with np.errstate():  # whatever it sets
            named = pkgutil.resolve_name(text)
    except (Exception, SystemExit) as error:  # the user's own code runs here
        raise ImplementationError(f"{text} cannot be imported: {told(error)}") from error
    if not (callable(named) or isinstance(named, Implementation)):
        raise InputError(
            f"{text} is of type {type(named).__name__}: expected a function f(q, v, a) or an Implementation"
        )
    return named


def make_references(sources: Source | Sequence[Source], model: Model) -> list[Implementation]:
    """One implementation, or several, each once.

    Raises:
        InputError: there is none, or one twice.
    """
    several = isinstance(sources, Sequence) and not isinstance(sources, str)
    wanted: list[Source] = list(sources) if several else [sources]  # type: ignore[arg-type,list-item]
    if not wanted:
        raise InputError("no reference is named: name at least one, such as 'pinocchio'")
    twice = [source for source in wanted if isinstance(source, str) and wanted.count(source) > 1]
    if twice:
        raise InputError(f"reference {twice[0]!r} is named {wanted.count(twice[0])} times: once is enough")
    return [make_implementation(source, model) for source in wanted]
