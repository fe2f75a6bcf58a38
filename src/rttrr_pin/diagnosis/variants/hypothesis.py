"""A hypothesis: what a program may do that the reference does not, as data."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

from rttrr_pin.core.arrays import Array
from rttrr_pin.diagnosis.variants.mutations import Mutation
from rttrr_pin.diagnosis.variants.variant import Variant

Kind = Literal["convention", "parameters", "joint", "mechanics"]

Apply = Callable[[Variant, Sequence[float]], Variant]
"""The program under the hypothesis, with these fitted numbers."""

Told = Callable[[Sequence[float]], Mapping[str, Any]]
"""Fitted numbers by name, as a reader wants them, such as `{"mass": 2.4, "mass in the file": 1.2}`."""


@dataclass(frozen=True, slots=True, eq=False)
class Hypothesis:
    """One thing that the program under test may do otherwise.

    Attributes:
        id: what it is called, the same for each link or joint: "gravity missing", "mass ignored".
        kind: where in the catalogue it stands.
        sentence: what the program does, in one sentence with link and joint, without a number that is fitted.
        repair: what to do about it, likewise.
        apply: the program under the hypothesis; of two, one is applied after the other.
        link: the link it is about; None where it is about none, or about all.
        joint: the joint it is about, likewise.
        start: where the fit of its numbers begins, one for each; empty where it has none to fit. At `neutral` the
            program is the reference.
        neutral: the numbers at which the hypothesis says nothing, as many.
        parameters: of a hypothesis on inertial parameters, their change (10 links,), in the order of
            `Robot.inertial_parameters`; where numbers are fitted, the directions (fitted, 10 links), with `neutral` 0
            and the change the sum of directions times numbers. None for any other.
        values: fitted numbers as a reader wants them.
        equation: of the paper, where the error is in one; else empty.
        line: the line of code or of the file to look at; else empty.
        mutation: the error in the recursion that it is, where it is no more than that; `apply` adds it.
    """

    id: str
    kind: Kind
    sentence: str
    repair: str
    apply: Apply
    link: str | None = None
    joint: str | None = None
    start: tuple[float, ...] = ()
    neutral: tuple[float, ...] = ()
    parameters: Array | None = None
    values: Told = field(default=lambda x: {})
    equation: str = ""
    line: str = ""
    mutation: Mutation | None = None
