"""Options that several commands have: decorators, put together in groups; and what is checked of them all."""

from __future__ import annotations

import errno
import os
import stat
import tempfile
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import click

from rttrr_pin.errors import InputError
from rttrr_pin.urdf.files import identity, was_read

Decorator = Callable[[Callable[..., Any]], Callable[..., Any]]


def group(*options: Decorator) -> Decorator:
    """Several options as one decorator, in the order of the help text."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        for option in reversed(options):
            function = option(function)
        return function

    return decorate


def robot(help: str = "A bundled robot's name, the path of a URDF, or example:NAME.") -> Decorator:
    """The robot; without it, the bundled arm."""
    return click.argument("robot", default="rttrr", help=help)


def target(option: str, content: str) -> Decorator:
    """Where a result is written: a file, or stdout."""
    return click.option(option, metavar="FILE", help=f"Write {content} to this file; '-' is stdout.")


def flag(*names: str, help: str) -> Decorator:
    """A switch that is off unless it is named."""
    return click.option(*names, is_flag=True, help=help)


seed = click.option("--seed", default=0, help="The same seed gives the same states.")
payload_link = click.option("--payload-link", help="The link whose frame it acts at; without it, the tool.")
gravity = click.option(
    "--gravity", metavar="X,Y,Z", help="Gravity field in the base frame [m/s^2]; without it 0,0,-9.81."
)
base = click.option("--base", default="fixed", help="fixed (bolted down) or floating.")
xacro = group(
    flag(
        "--xacro", help="Expand a xacro file, which runs the Python expressions in it: only for files that you trust."
    ),
    click.option(
        "--xacro-arg",
        multiple=True,
        metavar="NAME:=VALUE",
        help="The value of a <xacro:arg>; with --xacro, or instead of it. Repeats.",
    ),
)
friction = flag("--friction", help="Take damping and friction of <dynamics> into tau.")
package = click.option(
    "--package",
    multiple=True,
    metavar="NAME=FOLDER",
    help="Where a ROS package lies that the file names; others are looked for by their package.xml. Repeats.",
)
reading = group(
    flag("--lenient", help="Go on where the file does not say what a number is, and tell what is assumed."),
    flag("--no-mimic", help="Let joints with <mimic> move by themselves, as Pinocchio does unless it is asked."),
    package,
)
quiet = flag("--quiet", "-q", help="Print nothing but errors.")
page = group(
    target("--html", "a page of its own"),
    click.option("--figures", metavar="FOLDER", help="Write the pictures of that page as SVG files to this folder."),
)
outcome = group(target("--json", "the outcome as JSON"), quiet)


def xacro_arguments(words: Iterable[str]) -> dict[str, str]:
    """The words of `--xacro-arg`, by name."""
    return _by_name("--xacro-arg", words, ":=", "NAME:=VALUE, such as dof:=7")


def packages_of(words: Iterable[str]) -> dict[str, str]:
    """The folders of `--package`, by the names of packages."""
    form = "NAME=FOLDER, such as my_description=ws/my_description"
    return _by_name("--package", words, "=", form, may_be_empty=False)


def _by_name(option: str, words: Iterable[str], sign: str, form: str, may_be_empty: bool = True) -> dict[str, str]:
    """The values of an option that repeats, by their names."""
    values = {}
    for word in words:
        name, separator, value = word.partition(sign)
        if not (name and separator and (value or may_be_empty)):
            raise InputError(f"{option} is {word!r}: expected {form}")
        values[name] = value
    return values


def numbers_of(option: str, text: str, count: int) -> list[float]:
    """Numbers separated by commas or blanks."""
    from rttrr_pin.urdf.decimals import NUMBER, beyond_doubles

    words = text.replace(",", " ").split()
    numbers = [float(word) for word in words] if all(NUMBER.fullmatch(word) for word in words) else []
    if len(numbers) != count:
        example = ",".join("0" for _ in range(count))
        raise InputError(f"{option} is {text!r}: expected {count} numbers separated by commas, such as {example}")
    for fault in filter(None, map(beyond_doubles, words)):
        raise InputError(f"{option}: {fault}")
    return numbers


def reading_of(
    xacro: bool, xacro_arg: Iterable[str], lenient: bool, no_mimic: bool, package: Iterable[str]
) -> dict[str, Any]:
    """How a file is read: the options of `xacro` and `reading`, as `load` takes them."""
    return {
        "xacro": xacro,
        "xacro_args": xacro_arguments(xacro_arg),
        "lenient": lenient,
        "mimic": not no_mimic,
        "packages": packages_of(package),
    }


def check_targets(targets: Mapping[str, str | Path | None], sources: Iterable[str | Path] = ()) -> None:
    """Before the work is done: every output can be written, none overwrites an input or another output.

    Inputs are what is named, and what was read of late: call it again once files that name others are read.

    Args:
        targets: by option, the file to write; "-" is stdout, None nothing.
        sources: what is read; words that are no file's name are passed over.

    Raises:
        InputError: an output is refused; says which, and why.
    """
    owners = {identity(Path(source)): "the input" for source in sources}
    owners.pop(None, None)
    for option, where in targets.items():
        if where is None:
            continue
        place = "stdout" if str(where) == "-" else _writable(option, Path(where))
        if place != "stdout" and was_read(Path(where)):
            owners[place] = "the input"
        if place in owners:
            owner, name = owners[place], "stdout" if place == "stdout" else where
            if owner == "the input":
                raise InputError(f"{option} {name} would overwrite the input: give it another file")
            raise InputError(f"{owner} and {option} both go to {name}: give each a file of its own")
        if place is not None:
            owners[place] = option


def _writable(option: str, path: Path) -> object:
    """The file's identity, where it can be written."""
    try:
        path.parent.stat()
        try:
            mode = path.stat().st_mode
        except FileNotFoundError:
            mode = stat.S_IFREG
        reason = {stat.S_IFDIR: "it is a folder", stat.S_IFSOCK: "it is a socket"}.get(stat.S_IFMT(mode), "")
        if stat.S_ISREG(mode):  # it is replaced by a file beside it, of which this one has no name
            tempfile.TemporaryFile(dir=Path(os.path.realpath(path)).parent).close()
        elif not reason and not os.access(path, os.W_OK):  # a device or a pipe is written to
            reason = os.strerror(errno.EACCES)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
    if reason:
        raise InputError(f"{option} {path} cannot be written: {reason}; choose another file")
    return identity(path)
