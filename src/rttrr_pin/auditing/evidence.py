"""Evidence that needs no pairing: Pinocchio's number, and enclosures by interval arithmetic."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from flint import arb

from rttrr_pin.auditing.normalise import add_sums, sums_of_angles
from rttrr_pin.auditing.publication import component_of
from rttrr_pin.core.algebra import Matrix, Scalar, Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import dynamics
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.payload import Load
from rttrr_pin.derivation.motion import angles
from rttrr_pin.derivation.ring import evaluate
from rttrr_pin.derivation.symbolic_robot import SymbolicRobot
from rttrr_pin.derivation.symbols import Expression, Role
from rttrr_pin.exact.intervals import INTERVAL, interval, precision
from rttrr_pin.implementations import Batch, make_implementation

BITS = 256
"""Precision of interval arithmetic."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """The numbers of one component, at one random state.

    Attributes:
        pinocchio: Pinocchio's value [SI units].
        printed_off: how far the printed equation is off it; None where it has a symbol without a number.
        corrected_off: how far the corrected one is.
        enclosed: whether the enclosures of the corrected equation and of the recursion meet, both much narrower than
            rounding.
        excluded: whether the enclosures of the printed equation and of the recursion are disjoint: then it is proven
            wrong; None where it has a symbol without a number.
    """

    pinocchio: float
    printed_off: float | None
    corrected_off: float
    enclosed: bool
    excluded: bool | None


class Witness:
    """One random state of the robot, with Pinocchio's values and enclosures of the recursion's.

    Attributes:
        values: of each symbol that has a number: parameters, coordinates, rates, accelerations, payload.
    """

    def __init__(self, robot: SymbolicRobot, seed: int) -> None:
        self.robot = robot
        rng = np.random.default_rng(seed)
        model = robot.model
        self.q, self.v, self.a = (rng.uniform(-2.0, 2.0, n) for n in (model.nq, model.nv, model.nv))
        self.values: dict[str, float] = dict(robot.parameters.values)
        payload = [name for name in robot.parameters.values if robot.ring.symbols[name].role is Role.PAYLOAD]
        self.values |= dict(zip(payload, map(float, rng.uniform(-20.0, 20.0, len(payload))), strict=True))
        for name, numbers in (("q", self.q), ("v", self.v), ("a", self.a)):
            self.values |= {f"{name}_{k}": float(x) for k, x in enumerate(numbers, start=1)}

    def evidence(self, name: str, printed: Expression, corrected: Expression) -> Evidence:
        """The numbers of a component, such as F5z, as printed and as corrected."""
        self._add_sums_of_angles({symbol for terms in (printed, corrected) for x in terms for symbol, _ in x})
        pinocchio, truth = self.pinocchio(name), self.recursion(name)
        known = all(symbol in self._float_values for factors in printed for symbol, _ in factors)
        enclosure = self.enclosure(corrected)
        narrow = float(enclosure.rad()) + float(truth.rad()) < 2.0**-100 * (1 + abs(pinocchio))
        return Evidence(
            pinocchio=pinocchio,
            printed_off=abs(self.number(printed) - pinocchio) if known else None,
            corrected_off=abs(self.number(corrected) - pinocchio),
            enclosed=bool(enclosure.overlaps(truth)) and narrow,
            excluded=not self.enclosure(printed).overlaps(truth) if known else None,
        )

    def pinocchio(self, name: str) -> float:
        """Pinocchio's value of a component, such as F5z."""
        return float(component_of(name, self._computed))

    def recursion(self, name: str) -> arb:
        """The enclosure of a component by the recursion."""
        return arb(component_of(name, self._enclosures))

    def number(self, terms: Expression) -> float:
        """The value of a sum in float64."""
        return float(evaluate(terms, self._float_values))

    def enclosure(self, terms: Expression) -> arb:
        """The enclosure of a sum."""
        with precision(BITS):
            return arb(evaluate(terms, self._interval_values, interval))

    def _add_sums_of_angles(self, symbols: Iterable[str]) -> None:
        sums = sums_of_angles(symbols)
        add_sums(self._float_values, sums)
        with precision(BITS):
            add_sums(self._interval_values, sums)

    @cached_property
    def _float_values(self) -> dict[str, Any]:
        return self._all_values(float, lambda x: (float(np.sin(x)), float(np.cos(x))))

    @cached_property
    def _interval_values(self) -> dict[str, Any]:
        with precision(BITS):
            return self._all_values(interval, INTERVAL.sincos)

    def _all_values(self, number: Callable[[float], Any], sincos: Callable[[Any], tuple[Any, Any]]) -> dict[str, Any]:
        """The values in one kind of scalar, with the sines and cosines of the robot's angles."""
        values = {name: number(x) for name, x in self.values.items()}
        for angle in angles(self.robot.model):
            x = values[f"q_{angle.place}"] * number(angle.multiplier) + number(angle.offset)
            values[f"s_{angle.suffix}"], values[f"c_{angle.suffix}"] = sincos(x)
        return values

    @cached_property
    def _computed(self) -> Mapping[str, Array]:
        """Pinocchio's values of each quantity."""
        loads: list[Load] = []
        for payload in self.robot.payloads:
            f, n = (
                np.array([self.number(self.robot.ring.terms(x)) for x in vector]) for vector in (payload.f, payload.n)
            )
            loads.append(Load(payload.link, f, n))
        model = self.robot.model
        batch = Batch(model, self.q[None], self.v[None], self.a[None], tuple(loads))
        values = {
            name: value[0] for name, value in make_implementation("pinocchio", model).evaluate(batch).values.items()
        }
        with np.errstate(divide="ignore", invalid="ignore"):  # a link without mass: nothing asks for its acceleration
            return values | {"vC": values["F"] / np.array([[link.mass] for link in model.links])}

    @cached_property
    def _enclosures(self) -> Mapping[str, Any]:
        """The recursion's values of each quantity."""
        robot, vector = self.robot, self._vector
        with precision(BITS):
            bodies = [self._body(body) for body in robot.bodies()]
            payloads = [Payload(x.link, vector(x.f), vector(x.n)) for x in robot.payloads]
            q, v, a = ([interval(float(x)) for x in numbers] for numbers in (self.q, self.v, self.a))
            gravity = vector(robot.gravity)
            result = dynamics(robot.model, INTERVAL, q, v, a, payloads, links=bodies, gravity=gravity)
            vC = [[x / body.M for x in force] for body, force in zip(bodies, result.F, strict=True)]  # type: ignore[operator]
        return {"vC": vC} | {quantity: getattr(result, quantity) for quantity in ("tau", "F", "N", "f", "n")}

    def _interval(self, x: Scalar) -> arb:
        return arb(evaluate(self.robot.ring.terms(x), self._interval_values, interval))

    def _vector(self, x: Vector) -> Vector:
        return Vector(*(self._interval(component) for component in x))

    def _body(self, body: Body) -> Body:
        R, I = (Matrix(tuple(self._vector(row) for row in matrix.rows)) for matrix in (body.R, body.I))  # type: ignore[arg-type]
        return replace(
            body,
            axis=self._vector(body.axis),
            R=R,
            p=self._vector(body.p),
            M=self._interval(body.M),
            r_C=self._vector(body.r_C),
            I=I,
            parameters=tuple(map(self._interval, body.parameters)),
        )
