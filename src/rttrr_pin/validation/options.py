"""What the commands that compare have in common: which robot, which programs, which states."""

from __future__ import annotations

import shlex
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Literal

import click

from rttrr_pin.core.payload import RandomPayload
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.errors import InputError
from rttrr_pin.loading import load
from rttrr_pin.reporting.options import (
    base,
    check_targets,
    friction,
    gravity,
    group,
    numbers_of,
    payload_link,
    reading,
    reading_of,
    seed,
    xacro,
)
from rttrr_pin.robot import Robot

programs = group(
    click.option(
        "--subject",
        default="kernel",
        metavar="PROGRAM",
        help="The program that is judged: kernel, recursion, pinocchio, mujoco, lagrange; my_module:my_function; "
        "a table of results (.csv, .parquet, .jsonl); or a program such as ./my_id.",
    ),
    click.option(
        "--reference",
        default=("pinocchio",),
        multiple=True,
        metavar="PROGRAM",
        help="What it is compared with, likewise. May be repeated.",
    ),
)
sampling = click.option(
    "--sampling",
    default="uniform",
    help="How states are drawn: uniform, corners, zeros, one-joint, large-velocities, mixed.",
)
payload = click.option(
    "--payload", help="What the robot exerts on its surroundings: 'random', or six numbers fx,fy,fz,nx,ny,nz [N, N m]."
)
payload_frame = group(
    payload_link, click.option("--payload-axes", default="link", help="The axes of the six numbers: link or base.")
)
surroundings = group(gravity, base, friction, xacro, reading)
conditions = group(payload_frame, surroundings)
drawn = group(seed, sampling, payload, conditions)
"""The states that `validate` draws."""


def files_of(program: str) -> Iterator[str]:
    """The files that a program may consist of: a table, a command and its arguments, a module."""
    yield program
    with suppress(ValueError):  # a quotation mark without its other half
        yield from shlex.split(program)
    yield f"{program.partition(':')[0].replace('.', '/')}.py"


@dataclass(frozen=True, slots=True)
class RunOptions:
    """The options of one run, as typed; each has the name of its option, and its default."""

    robot: str = "rttrr"
    subject: str = "kernel"
    reference: tuple[str, ...] = ("pinocchio",)
    seed: int = 0
    sampling: str = "uniform"
    payload: str | None = None
    payload_link: str | None = None
    payload_axes: str = "link"
    gravity: str | None = None
    base: str = "fixed"
    friction: bool = False
    xacro: bool = False
    xacro_arg: tuple[str, ...] = ()
    lenient: bool = False
    no_mimic: bool = False
    package: tuple[str, ...] = ()

    def unusual(self, names: Collection[str] = ()) -> list[str]:
        """The options that differ from their defaults, as words of a command line; of some names, where there are."""
        words = []
        for option in fields(self)[1:]:
            value = getattr(self, option.name)
            if value == option.default or (names and option.name not in names):
                continue
            for each in value if isinstance(value, tuple) else (value,):
                words += [f"--{option.name.replace('_', '-')}", *([] if each is True else [str(each)])]
        return words

    def command(self, name: str, names: Collection[str] = ()) -> str:
        """The command that takes the same robot, programs and states; or the same options of these names."""
        robot = [] if self.robot == "rttrr" else [self.robot]
        return shlex.join(["rttrr-pin", name, *robot, *self.unusual(names)])

    def diagnosis(self, reference: int) -> str:
        """The command that says why the subject differs from one of the references, by its number."""
        from rttrr_pin.implementations.table_files import READERS

        table = Path(self.subject).suffix.lower() in READERS and Path(self.subject).is_file()
        subject = [self.subject] if table else ["--subject", self.subject]
        against = self.reference[reference]
        words = ["--reference", against] if against != "kernel" else []
        left_out = ("subject", "reference", "seed", "sampling")
        same = self.unusual([own.name for own in fields(self)[1:] if own.name not in left_out])
        return shlex.join(["rttrr-pin", "diagnose", self.robot, *subject, *words, *same])

    def check_target(self, target: str | None, files: Iterable[Path] = (), option: str = "--json") -> None:
        """The result can be written, and overwrites nothing that is read, nor a program."""
        self.check_targets({option: target}, files)

    def check_targets(self, targets: Mapping[str, str | None], files: Iterable[Path] = ()) -> None:
        """The same of several, by their options; none is another."""
        programs = (name for program in (self.subject, *self.reference) for name in files_of(program))
        check_targets(targets, [self.robot, *programs, *files])

    def load(self, target: str | None, option: str = "--json", others: Mapping[str, str | None] | None = None) -> Robot:
        """The robot, once the results can be written to their files without overwriting any of its own.

        Args:
            target: where one is written, by `option`.
            option: its name.
            others: where others are written, by their options.
        """
        targets = {option: target, **(others or {})}
        self.check_targets(targets)
        robot = self._load()
        self.check_targets(targets)
        return robot

    def _load(self) -> Robot:
        field: dict[str, Any] = {}
        if self.gravity is not None:
            field["gravity"] = numbers_of("--gravity", self.gravity, 3)
        how = self.reading() | field
        return load(self.robot, base=self.base, friction=self.friction, **how)  # type: ignore[arg-type]

    def reading(self) -> dict[str, Any]:
        """How the file is read, as `load` takes it."""
        return reading_of(self.xacro, self.xacro_arg, self.lenient, self.no_mimic, self.package)

    def chosen(self) -> dict[str, Any]:
        """Programs and states, as the functions of the package take them."""
        reference = list(self.reference)
        return {"subject": self.subject, "reference": reference, "seed": self.seed, "payload": self._payload()}

    def _payload(self) -> Wrench | RandomPayload | None:
        if self.payload is None and self.payload_link is not None:
            raise InputError("--payload-link goes with a payload: pass --payload random or --payload fx,fy,fz,nx,ny,nz")
        if self.payload in (None, "random"):
            if self.payload_axes != "link":
                raise InputError("--payload-axes goes with six numbers: pass --payload fx,fy,fz,nx,ny,nz")
            return None if self.payload is None else RandomPayload(self.payload_link)
        if self.payload_axes not in ("link", "base"):
            raise InputError(f"--payload-axes is {self.payload_axes!r}: expected link or base")
        numbers = numbers_of("--payload", self.payload, 6)
        axes: Literal["link", "base"] = "base" if self.payload_axes == "base" else "link"
        return Wrench(force=numbers[:3], moment=numbers[3:], link=self.payload_link, expressed_in=axes)
