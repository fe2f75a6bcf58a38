"""Evidence that needs no pairing: numbers against Pinocchio, and balls that prove what is equal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from flint import arb

from rttrr_pin.core.algebra import Matrix, Scalar, Vector
from rttrr_pin.core.dynamics import dynamics
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.payload import Load
from rttrr_pin.derivation.chain import SymbolicRobot
from rttrr_pin.derivation.motion import angles
from rttrr_pin.derivation.ring import evaluate
from rttrr_pin.derivation.symbols import Role, Terms
from rttrr_pin.exact.intervals import INTERVAL, precision
from rttrr_pin.exact.intervals import interval as ball
from rttrr_pin.implementations import make_oracle

BITS = 256
"""Precision of the balls."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What numbers say of one component, at one random state.

    Attributes:
        pinocchio: Pinocchio's value [SI units].
        printed_off: how far the printed equation is off it; None where it has a symbol without a number.
        corrected_off: how far the corrected one is.
        enclosed: whether the ball of the corrected equation meets that of the recursion, both much narrower than
            rounding.
        excluded: whether the ball of the printed equation lies apart from that of the recursion: then it is proven
            wrong; None where it has a symbol without a number.
    """

    pinocchio: float
    printed_off: float | None
    corrected_off: float
    enclosed: bool
    excluded: bool | None


class Witness:
    """One random state of the robot, with what Pinocchio and the recursion on balls say of it.

    Attributes:
        values: of every symbol that is a number here: letters, coordinates, rates, accelerations, payload.
    """

    def __init__(self, robot: SymbolicRobot, seed: int) -> None:
        self.robot = robot
        rng = np.random.default_rng(seed)
        model = robot.model
        self.q, self.v, self.a = (rng.uniform(-2.0, 2.0, n) for n in (model.nq, model.nv, model.nv))
        self.values: dict[str, float] = dict(robot.letters.values)
        payload = [name for name in robot.letters.values if robot.ring.symbols[name].role is Role.PAYLOAD]
        self.values |= dict(zip(payload, map(float, rng.uniform(-20.0, 20.0, len(payload))), strict=True))
        for letter, numbers in (("q", self.q), ("v", self.v), ("a", self.a)):
            self.values |= {f"{letter}_{k}": float(x) for k, x in enumerate(numbers, start=1)}

    def pinocchio(self, quantity: str, place: int, axis: int) -> float:
        """A quantity by Pinocchio."""
        if quantity == "tau":
            return float(self._wrenches.tau[0, place])
        if quantity == "vC":
            return float(self._wrenches.F[0, place, axis]) / self.robot.model.links[place].mass
        return float(getattr(self._wrenches, quantity)[0, place, axis])

    def recursion(self, quantity: str, place: int, axis: int) -> arb:
        """The ball that the recursion gives for a quantity."""
        if quantity == "tau":
            return arb(self._balls.tau[place])
        if quantity == "vC":
            with precision(BITS):
                return arb(tuple(self._balls.F[place])[axis]) / self._masses[place]
        return arb(tuple(getattr(self._balls, quantity)[place])[axis])

    def number(self, terms: Terms) -> float:
        """The value of a sum in floats."""
        return float(evaluate(terms, self._float_values))

    def enclosure(self, terms: Terms) -> arb:
        """The ball of a sum."""
        with precision(BITS):
            return arb(evaluate(terms, self._ball_values, ball))

    def knows(self, terms: Terms) -> bool:
        """Whether every symbol of a sum has a number here."""
        return all(name in self._float_values for factors in terms for name, _ in factors)

    def with_sums(self, expansions: Mapping[str, Terms]) -> None:
        """Give sines and cosines of sums of angles their values."""
        for name, terms in expansions.items():
            self._float_values[name] = float(evaluate(terms, self._float_values))
            with precision(BITS):
                self._ball_values[name] = evaluate(terms, self._ball_values, ball)

    @cached_property
    def _float_values(self) -> dict[str, Any]:
        values: dict[str, Any] = dict(self.values)
        for angle in angles(self.robot.model):
            x = self.values[f"q_{angle.place}"] * angle.multiplier + angle.offset
            values |= {f"s_{angle.suffix}": float(np.sin(x)), f"c_{angle.suffix}": float(np.cos(x))}
        return values

    @cached_property
    def _ball_values(self) -> dict[str, Any]:
        with precision(BITS):
            values: dict[str, Any] = {name: ball(x) for name, x in self.values.items()}
            for angle in angles(self.robot.model):
                x = values[f"q_{angle.place}"] * ball(angle.multiplier) + ball(angle.offset)
                values[f"s_{angle.suffix}"], values[f"c_{angle.suffix}"] = x.sin_cos()
        return values

    @cached_property
    def _wrenches(self) -> Any:
        loads: list[Load] = []
        for payload in self.robot.payloads:
            f, n = (
                np.array([self.number(self.robot.ring.terms(x)) for x in vector]) for vector in (payload.f, payload.n)
            )
            loads.append(Load(payload.link, f, n))
        oracle = make_oracle("pinocchio", self.robot.model)
        return oracle.evaluate(self.q[None], self.v[None], self.a[None], loads).wrenches

    @cached_property
    def _masses(self) -> list[arb]:
        with precision(BITS):
            return [self._ball(body.M) for body in self.robot.bodies()]

    @cached_property
    def _balls(self) -> Any:
        robot = self.robot
        with precision(BITS):
            bodies = [self._body(body) for body in robot.bodies()]
            payloads = [Payload(x.link, self._vector(x.f), self._vector(x.n)) for x in robot.payloads]
            q, v, a = ([ball(float(x)) for x in numbers] for numbers in (self.q, self.v, self.a))
            return dynamics(robot.model, INTERVAL, q, v, a, payloads, links=bodies, gravity=self._vector(robot.gravity))

    def _ball(self, x: Scalar) -> arb:
        return arb(evaluate(self.robot.ring.terms(x), self._ball_values, ball))

    def _vector(self, x: Vector) -> Vector:
        return Vector(*(self._ball(component) for component in x))

    def _body(self, body: Body) -> Body:
        R, I = (Matrix(tuple(self._vector(row) for row in matrix.rows)) for matrix in (body.R, body.I))  # type: ignore[arg-type]
        p, r_C = self._vector(body.p), self._vector(body.r_C)
        return Body(
            body.type,
            self._vector(body.axis),
            R,
            p,
            self._ball(body.M),
            r_C,
            I,
            tuple(map(self._ball, body.parameters)),
        )


def weigh(witness: Witness, component: tuple[str, int, int], printed: Terms, corrected: Terms) -> Evidence:
    """What numbers say of a component as printed and as corrected."""
    pinocchio, truth = witness.pinocchio(*component), witness.recursion(*component)
    known = witness.knows(printed)
    mended = witness.enclosure(corrected)
    narrow = float(mended.rad()) + float(truth.rad()) < 2.0**-100 * (1 + abs(pinocchio))
    return Evidence(
        pinocchio=pinocchio,
        printed_off=abs(witness.number(printed) - pinocchio) if known else None,
        corrected_off=abs(witness.number(corrected) - pinocchio),
        enclosed=bool(mended.overlaps(truth)) and narrow,
        excluded=not witness.enclosure(printed).overlaps(truth) if known else None,
    )
