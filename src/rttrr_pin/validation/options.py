"""What the commands that compare have in common: which robot, which programs, which states."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, fields
from typing import Annotated, Any, Literal

import typer

from rttrr_pin.core.payload import RandomPayload
from rttrr_pin.core.wrench import Wrench
from rttrr_pin.errors import InputError
from rttrr_pin.loading import load
from rttrr_pin.reporting.numbers import numbers_of
from rttrr_pin.robot import Robot

RobotArgument = Annotated[str, typer.Argument(help="A bundled robot's name, the path of a URDF, or example:NAME.")]
Subject = Annotated[
    str,
    typer.Option(
        help="The program that is judged: kernel, recursion, pinocchio, mujoco, lagrange; my_module:my_function; "
        "a table of results (.csv, .parquet, .jsonl); or a program such as ./my_id."
    ),
]
Reference = Annotated[list[str] | None, typer.Option(help="What it is compared with, likewise. May be repeated.")]
Seed = Annotated[int, typer.Option(help="The same seed gives the same states.")]
Sampling = Annotated[
    str, typer.Option(help="How states are drawn: uniform, corners, zeros, one-joint, large-velocities, mixed.")
]
Payload = Annotated[
    str | None,
    typer.Option(
        help="What the robot exerts on its surroundings: 'random', or six numbers fx,fy,fz,nx,ny,nz [N, N m]."
    ),
]
PayloadLink = Annotated[str | None, typer.Option(help="The link whose frame it acts at; without it, the tool.")]
PayloadAxes = Annotated[str, typer.Option(help="The axes of the six numbers: link or base.")]
Gravity = Annotated[
    str | None, typer.Option(help="Gravity field gx,gy,gz in the base frame [m/s^2]; without it 0,0,-9.81.")
]
Base = Annotated[str, typer.Option(help="fixed (bolted down) or floating.")]
Friction = Annotated[bool, typer.Option("--friction", help="Take damping and friction of <dynamics> into tau.")]
Json = Annotated[str | None, typer.Option(help="Write the outcome as JSON to this file; '-' is stdout.")]
Quiet = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]


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

    def unusual(self) -> list[str]:
        """The options that differ from their defaults, as words of a command line."""
        words = []
        for option in fields(self)[1:]:
            value = getattr(self, option.name)
            if value == option.default:
                continue
            for each in value if isinstance(value, tuple) else (value,):
                words += [f"--{option.name.replace('_', '-')}", *([] if each is True else [str(each)])]
        return words

    def command(self, name: str) -> str:
        """The command that takes the same robot, programs and states."""
        robot = [] if self.robot == "rttrr" else [self.robot]
        return shlex.join(["rttrr-pin", name, *robot, *self.unusual()])

    def load(self) -> Robot:
        """The robot."""
        gravity: dict[str, Any] = {}
        if self.gravity is not None:
            gravity["gravity"] = numbers_of("--gravity", self.gravity, 3)
        return load(self.robot, base=self.base, friction=self.friction, **gravity)  # type: ignore[arg-type]

    def chosen(self) -> dict[str, Any]:
        """Programs and states, as the functions of the package take them."""
        reference = list(self.reference)
        return {"subject": self.subject, "reference": reference, "seed": self.seed, "payload": self._payload()}

    def _payload(self) -> Wrench | RandomPayload | None:
        if self.payload is None or self.payload == "random":
            if self.payload_link is not None or self.payload_axes != "link":
                raise InputError(
                    "--payload-link and --payload-axes go with six numbers: pass --payload fx,fy,fz,nx,ny,nz"
                )
            return None if self.payload is None else RandomPayload()
        if self.payload_axes not in ("link", "base"):
            raise InputError(f"--payload-axes is {self.payload_axes!r}: expected link or base")
        numbers = numbers_of("--payload", self.payload, 6)
        axes: Literal["link", "base"] = "base" if self.payload_axes == "base" else "link"
        return Wrench(force=numbers[:3], moment=numbers[3:], link=self.payload_link, expressed_in=axes)
