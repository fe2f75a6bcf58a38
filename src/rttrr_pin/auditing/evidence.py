"""Evidence that needs no pairing: Pinocchio's number, and enclosures by interval arithmetic."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from flint import arb, arb_mat

from rttrr_pin.auditing.normalise import add_sums, sums_of_angles
from rttrr_pin.auditing.printed import Quotient
from rttrr_pin.auditing.publication import component_of, parts_of
from rttrr_pin.auditing.reading.angles import DIVISORS
from rttrr_pin.core.algebra import Matrix, Scalar, Vector
from rttrr_pin.core.arrays import Array
from rttrr_pin.core.dynamics import Result, dynamics
from rttrr_pin.core.joints.base import Body
from rttrr_pin.core.newton_euler import Payload
from rttrr_pin.core.payload import Load
from rttrr_pin.derivation.motion import angles
from rttrr_pin.derivation.ring import evaluate
from rttrr_pin.derivation.symbolic_robot import SymbolicRobot
from rttrr_pin.derivation.symbols import Role
from rttrr_pin.exact.intervals import INTERVAL, interval, precision
from rttrr_pin.implementations import Batch, Implementation, make_implementation

Numbers = Sequence[Any] | Array
"""In any kind of scalar."""

BITS = 256
"""Precision of interval arithmetic."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """The numbers of one component, at one random state.

    Attributes:
        pinocchio: the value by Pinocchio's torques [SI units].
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


def in_parts(tau: Callable[[list[Any], list[Any]], Sequence[Any]], v: Sequence[Any]) -> dict[str, list[Any]]:
    """M, C by Christoffel symbols, and g, from inverse dynamics without payload, in any kind of scalar.

    tau(v, a) - g is linear in a and, at a = 0, quadratic in v: C e_j is the bilinear form of v and e_j.
    """
    count = range(len(v))
    zero, units = [0] * len(v), [[int(i == j) for i in count] for j in count]
    g = tau(zero, zero)

    def beyond(v: list[Any], a: list[Any]) -> list[Any]:
        return [x - y for x, y in zip(tau(v, a), g, strict=True)]

    of_v = beyond(list(v), zero)
    columns_of_M = [beyond(zero, unit) for unit in units]
    columns_of_C = []
    for unit in units:
        of_sum, of_unit = beyond([x + y for x, y in zip(v, unit, strict=True)], zero), beyond(unit, zero)
        columns_of_C.append([(x - y - z) / 2 for x, y, z in zip(of_sum, of_v, of_unit, strict=True)])
    M, C = ([[column[i] for column in columns] for i in count] for columns in (columns_of_M, columns_of_C))
    return {"M": M, "C": C, "g": list(g)}


class Witness:
    """One random state of the robot, with Pinocchio's values and enclosures of the recursion's.

    Attributes:
        values: of each symbol that has a number: parameters, coordinates, rates, accelerations, payload.
    """

    def __init__(self, robot: SymbolicRobot, seed: int, passive: Collection[int] = ()) -> None:
        self.robot, self._seed, self._passive = robot, seed, passive
        rng = np.random.default_rng(seed)
        model = robot.model
        self.q, self.v, self.a = (rng.uniform(-2.0, 2.0, n) for n in (model.nq, model.nv, model.nv))
        self.values: dict[str, float] = dict(robot.parameters.values)
        payload = [name for name in robot.parameters.values if robot.ring.symbols[name].role is Role.PAYLOAD]
        self.values |= dict(zip(payload, map(float, rng.uniform(-20.0, 20.0, len(payload))), strict=True))
        for name, numbers in (("q", self.q), ("v", self.v), ("a", self.a)):
            self.values |= {f"{name}_{k}": float(x) for k, x in enumerate(numbers, start=1)}

    def evidence(self, name: str, printed: Quotient, corrected: Quotient) -> Evidence:
        """The numbers of a component, such as F5z, as printed and as corrected."""
        solved = parts_of(name)[0] == "a"
        floats, intervals = self._solved_values if solved else self._drawn_values
        sums = [
            angle
            for angle in sums_of_angles(printed.names | corrected.names)
            if all(f"s_{part.removeprefix('m')}" in floats for part in angle.split("_"))
        ]
        add_sums(floats, sums)
        with precision(BITS):
            add_sums(intervals, sums)
        pinocchio, truth = self.pinocchio(name), self.recursion(name)
        known = all(symbol in floats for symbol in printed.names)
        enclosure = self.enclosure(corrected, solved)
        narrow = float(enclosure.rad()) + float(truth.rad()) < 2.0**-100 * (1 + abs(pinocchio))
        return Evidence(
            pinocchio=pinocchio,
            printed_off=abs(self.number(printed, solved) - pinocchio) if known else None,
            corrected_off=abs(self.number(corrected, solved) - pinocchio),
            enclosed=bool(enclosure.overlaps(truth)) and narrow,
            excluded=not self.enclosure(printed, solved).overlaps(truth) if known else None,
        )

    def pinocchio(self, name: str) -> float:
        """Pinocchio's value of a component, such as F5z."""
        return float(component_of(name, self._pinocchio(parts_of(name)[0])))

    def recursion(self, name: str) -> arb:
        """The enclosure of a component by the recursion."""
        with precision(BITS):
            return arb(component_of(name, self._recursion(parts_of(name)[0])))

    def number(self, quotient: Quotient, solved: bool = False) -> float:
        """The value of a quotient in float64; `solved`: at accelerations that forces give."""
        values, _ = self._solved_values if solved else self._drawn_values
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            above, below = (np.float64(evaluate(x, values)) for x in (quotient.numerator, quotient.denominator))
            return float(above / below)

    def enclosure(self, quotient: Quotient, solved: bool = False) -> arb:
        """The enclosure of a quotient."""
        _, values = self._solved_values if solved else self._drawn_values
        with precision(BITS):
            above, below = (arb(evaluate(x, values, interval)) for x in (quotient.numerator, quotient.denominator))
            return above / below

    @cached_property
    def _drawn_values(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Floats and intervals of each symbol, at random accelerations."""
        return dict(self._float_values), dict(self._interval_values)

    @cached_property
    def _solved_values(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """The same with random forces, and the accelerations that these give."""
        names = [f"a_{k}" for k in range(1, self.robot.model.nv + 1)]
        floats = dict(self._forces) | dict(zip(names, map(float, self._pinocchio("a")["a"]), strict=True))
        with precision(BITS):
            enclosed = dict(zip(names, self._recursion("a")["a"], strict=True))
            forces = {name: interval(x) for name, x in self._forces.items()}
        return self._float_values | floats, self._interval_values | forces | enclosed

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
            x = values[f"q_{angle.index}"] * number(angle.multiplier) + number(angle.offset)
            values[f"s_{angle.suffix}"], values[f"c_{angle.suffix}"] = sincos(x)
            for d in DIVISORS:  # powers of two, by which intervals are divided exactly
                part = f"{angle.suffix}d{d}"
                values[f"s_{part}"], values[f"c_{part}"] = sincos(x * number(1 / d))
        return values

    def _pinocchio(self, quantity: str) -> Mapping[str, Any]:
        """Pinocchio's values, those of a quantity among them."""
        if quantity in ("M", "C", "g"):
            return in_parts(lambda v, a: self._pinocchio_at(v, a)["tau"].tolist(), list(self.v))
        if quantity == "a":
            M = np.array(self._pinocchio("M")["M"])
            held = self._pinocchio_at(self.v, 0.0 * self.a, self._loads)["tau"]
            with np.errstate(all="ignore"):
                return {"a": np.linalg.lstsq(M, np.array(list(self._forces.values())) - held, rcond=None)[0]}
        return self._pinocchio_values

    @cached_property
    def _pinocchio_values(self) -> Mapping[str, Array]:
        values = self._pinocchio_at(self.v, self.a, self._loads)
        with np.errstate(divide="ignore", invalid="ignore"):  # a link without mass: nothing asks for its acceleration
            return values | {"vC": values["F"] / np.array([[link.mass] for link in self.robot.model.links])}

    def _pinocchio_at(self, v: Numbers, a: Numbers, loads: Sequence[Load] = ()) -> dict[str, Array]:
        batch = Batch(self.robot.model, self.q[None], np.array([v], float), np.array([a], float), tuple(loads))
        return {name: value[0] for name, value in self._implementation.evaluate(batch).values.items()}

    @cached_property
    def _implementation(self) -> Implementation:
        return make_implementation("pinocchio", self.robot.model)

    @cached_property
    def _loads(self) -> list[Load]:
        terms = self.robot.ring.terms

        def numbers(vector: Vector) -> Array:
            return np.array([evaluate(terms(x), self._float_values) for x in vector])

        return [Load(payload.link, numbers(payload.f), numbers(payload.n)) for payload in self.robot.payloads]

    def _recursion(self, quantity: str) -> Mapping[str, Any]:
        """The recursion's values in intervals, those of a quantity among them."""
        if quantity in ("M", "C", "g"):
            return in_parts(self._recursion_tau, [interval(float(x)) for x in self.v])
        if quantity == "a":
            held = self._recursion_tau(self.v, 0.0 * self.a, loaded=True)
            right = [[interval(force) - x] for force, x in zip(self._forces.values(), held, strict=True)]
            solution = arb_mat(self._recursion("M")["M"]).solve(arb_mat(right))
            return {"a": [solution[i, 0] for i in range(len(right))]}
        return self._recursion_values

    @cached_property
    def _recursion_values(self) -> Mapping[str, Any]:
        result = self._recursion_at(self.v, self.a, loaded=True)
        bodies = zip(self._bodies, result.F, strict=True)
        vC = [[x / body.M for x in force] for body, force in bodies]  # type: ignore[operator]
        return {"vC": vC} | {quantity: getattr(result, quantity) for quantity in ("tau", "F", "N", "f", "n")}

    def _recursion_tau(self, v: Numbers, a: Numbers, loaded: bool = False) -> list[Any]:
        tau: list[Any] = self._recursion_at(v, a, loaded).tau
        return list(map(arb, tau))  # where no state changes one, it is a plain number

    def _recursion_at(self, v: Numbers, a: Numbers, loaded: bool = False) -> Result:
        robot, vector = self.robot, self._vector
        with precision(BITS):
            payloads = [Payload(x.link, vector(x.f), vector(x.n)) for x in robot.payloads if loaded]
            q, v, a = ([x if isinstance(x, arb) else interval(float(x)) for x in row] for row in (self.q, v, a))
            return dynamics(robot.model, INTERVAL, q, v, a, payloads, links=self._bodies, gravity=vector(robot.gravity))

    @cached_property
    def _bodies(self) -> list[Body]:
        with precision(BITS):
            return [self._body(body) for body in self.robot.bodies()]

    @cached_property
    def _forces(self) -> Mapping[str, float]:
        """A driving force for each joint, 0 where nothing drives it."""
        rng = np.random.default_rng([self._seed, 1])
        drawn = rng.uniform(-20.0, 20.0, self.robot.model.nv)
        return {f"tau_{k}": 0.0 if k - 1 in self._passive else float(x) for k, x in enumerate(drawn, start=1)}

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
