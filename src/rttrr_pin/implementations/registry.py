"""From what a user writes to an implementation: a name, an object, a function, a table of results, a command.

A new one is a module with a class that fulfils `Implementation` and takes a `Model`, and a line in `BUILT_IN`; from
another package, an entry point of the group `rttrr_pin.implementations` that names such a class. Each module is loaded
when one of its kind is asked for.
"""

from __future__ import annotations

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
from rttrr_pin.errors import ImplementationError, InputError, RttrrError, UnknownNameError, told
from rttrr_pin.implementations.protocol import Implementation

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint, EntryPoints

BUILT_IN = {
    "kernel": "rttrr_pin.implementations.own:CompiledKernel",
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
            batch; the path of a table of results (.csv, .parquet, .jsonl); `"my_module:my_function"`; or the command
            line of a program that reads states and writes results as JSON lines, such as `"./my_id"`.
        model: the robot.

    Raises:
        UnknownNameError: it is none of these.
        ImplementationError: its library is not installed, or cannot take the robot.
        InputError: it is of another type.
    """
    if isinstance(source, Implementation) and not isinstance(source, type):
        return source
    if callable(source):
        from rttrr_pin.implementations.function import Function

        return Function(source, model)
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
    from rttrr_pin.implementations.table import Table
    from rttrr_pin.implementations.table_files import READERS

    if Path(text).suffix.lower() in READERS and (Path(text).is_file() or not _is_command(text)):
        return Table(Path(text), model)
    if _is_command(text):
        from rttrr_pin.implementations.program import Program

        return Program(text, model)
    module, colon, attribute = text.partition(":")
    if colon and all(part.isidentifier() for part in (*module.split("."), *attribute.split("."))):
        return make_implementation(_of_module(text), model)
    raise UnknownNameError("implementation", text, names(), "a program needs its path, such as ./my_id")


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
    try:
        implementation: Implementation = point.load()(model)
    except RttrrError:
        raise
    except (Exception, SystemExit) as error:
        raise ImplementationError(
            f"implementation {point.name!r} ({point.value}) cannot be made: {told(error)}"
        ) from error
    if not isinstance(implementation, Implementation):
        raise ImplementationError(
            f"implementation {point.name!r} ({point.value}) is a {type(implementation).__name__}: "
            "expected one with name, version, quantities and evaluate"
        )
    return implementation


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
