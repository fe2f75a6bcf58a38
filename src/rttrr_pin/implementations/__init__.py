"""Other programs that compute the same quantities; one module each, and nothing else imports their libraries.

A new oracle is one module with a class that fulfils `Oracle`, and one line in `ORACLES`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Protocol

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.core.payload import Load
from rttrr_pin.core.wrench import LinkWrenches
from rttrr_pin.errors import OracleError, UnknownNameError

ORACLES = {
    "pinocchio": "rttrr_pin.implementations.pinocchio:PinocchioOracle",
    "mujoco": "rttrr_pin.implementations.mujoco:MujocoOracle",
    "lagrange": "rttrr_pin.implementations.lagrange:LagrangeOracle",
}
"""Where the oracle of each name is."""

EXTRAS = ("mujoco",)
"""Oracles whose library comes with an extra of the same name."""


@dataclass(frozen=True, slots=True)
class Evaluation:
    """What an oracle says of a batch.

    Attributes:
        wrenches: the quantities that it has, in the frames and signs of `Robot.inverse_dynamics`; of F, N, f, n that it
            has not, the links axis is empty.
        rounding: by quantity (F, N, f, n), (N, links): the size of terms that cancel in this oracle's formulas and do
            not occur in ours, times eps and the few operations they go through. Zero for formulas like ours. Under
            "tau", (N, nv), a bound on all rounding of its driving forces, where the oracle can give one.
    """

    wrenches: LinkWrenches
    rounding: dict[str, Array]


class Oracle(Protocol):
    """A program that computes inverse dynamics by its own means.

    Attributes:
        name: as in `ORACLES`.
        version: of the library.
        quantities: which of tau, F, N, f, n it gives, in this order; tau is always one of them.
    """

    name: str
    version: str
    quantities: tuple[str, ...]

    def __init__(self, model: Model) -> None:
        """Build the oracle's own model, and compare it with ours.

        Raises:
            ModelMismatchError: it is not what the file says.
            OracleError: the oracle cannot take this robot.
        """

    def evaluate(self, q: Array, v: Array, a: Array, loads: Sequence[Load] = ()) -> Evaluation:
        """The quantities that it has of a batch of states, q: (N, nq), v, a: (N, nv) each."""


def urdf_of(model: Model, program: str) -> str:
    """The text that a program builds its own model from.

    Raises:
        OracleError: the model was made from numbers.
    """
    if not model.urdf:
        raise OracleError(
            f"robot {model.name!r} was made from numbers, and {program} builds from a URDF: load it from a file"
        )
    return model.urdf


def make_oracle(name: str, model: Model) -> Oracle:
    """The oracle of that name for this robot.

    Raises:
        UnknownNameError: there is no such oracle.
        OracleError: its library is not installed, or cannot take the robot.
    """
    if name not in ORACLES:
        raise UnknownNameError("oracle", name, ORACLES)
    module, kind = ORACLES[name].split(":")
    try:
        oracle = getattr(import_module(module), kind)
    except ImportError as error:
        raise OracleError(
            f"oracle {name!r} needs the package {error.name!r}, which is not installed: "
            + (f"pip install 'rttrr-pin[{name}]'" if name in EXTRAS else "install it")
        ) from error
    made: Oracle = oracle(model)
    return made
