"""Coordinates and payloads of the bundled arm, right ones and wrong ones."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np

from rttrr_pin import RttrrError, Wrench
from rttrr_pin.errors import InputError, MissingJointError, NumberError, ShapeError, UnknownNameError

ZERO = np.zeros(5)
JOINTS = tuple(f"joint_{i}" for i in range(1, 6))


def some(shape: tuple[int, ...], seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    q, v, a = np.random.default_rng(seed).uniform(-1, 1, (3, *shape, 5))
    return q, v, a


BAD: dict[str, tuple[Any, type[RttrrError], str]] = {
    "four-values": (np.zeros(4), ShapeError, r"q has 4 values on its last axis, expected 5 \(joint_1, joint_2"),
    "scalar": (1.0, ShapeError, "q has no axis, expected 5"),
    "transposed": (np.zeros((5, 9)), ShapeError, "q has 9 values on its last axis"),
    "empty": (np.zeros((3, 0)), ShapeError, "q has 0 values"),
    "ragged": ([[0] * 5, [0] * 4], ShapeError, "no rectangular array"),
    "nan": ([0, 0, np.nan, 0, 0], NumberError, r"q\[2\], joint 'joint_3', is nan, expected a finite number"),
    "inf-in-batch": (
        np.where(np.arange(15).reshape(3, 5) == 13, -np.inf, 0.0),
        NumberError,
        r"q\[2, 3\], joint 'joint_4', is -inf",
    ),
    "two-nans": ([np.nan] * 2 + [0] * 3, NumberError, "2 such values in all"),
    "complex": (np.zeros(5, dtype=complex), NumberError, "array of complex.*take .real"),
    "bool": (np.zeros(5, dtype=bool), NumberError, "array of bool"),
    "text": (["0"] * 5, NumberError, "array of text"),
    "none": ([None] * 5, NumberError, r"q\[0\] is None \(NoneType\)"),
    "decimal": ([Decimal(1)] * 5, NumberError, r"Decimal.*float\(\)"),
    "fraction": ([Fraction(1, 3)] * 5, NumberError, "Fraction"),
    "longdouble": (np.zeros(5, dtype=np.longdouble), NumberError, "array of float128|array of longdouble"),
    "big-int64": (np.array([0, 0, 0, 0, 2**53 + 1]), NumberError, r"q\[4\] is 9007199254740993, which float64 cannot"),
    "big-python-int": ([0, 10**400, 0, 0, 0], NumberError, r"q\[1\] is an integer of 401 digits"),
    "uint64": (np.full(5, 2**64 - 1, dtype=np.uint64), NumberError, "cannot hold exactly"),
    "masked": (np.ma.masked_greater(np.arange(5.0), 3), NumberError, "masked entries"),
    "dates": (np.zeros(5, dtype="M8[s]"), NumberError, "array of date"),
    "unknown-joint": (dict.fromkeys((*JOINTS[:4], "joint5"), 0.0), UnknownNameError, "'joint5': did you mean joint_5"),
    "missing-joint": (dict.fromkeys(JOINTS[1:], 0.0), MissingJointError, "q lacks joint_1.*'joint_1': 0.0"),
    "dict-shapes": (dict.fromkeys(JOINTS, np.zeros(2)) | {"joint_2": np.zeros(3)}, ShapeError, r"joint_2: \(3,\)"),
    "dict-nan": (dict.fromkeys(JOINTS, 0.0) | {"joint_2": np.nan}, NumberError, "joint_2.* is nan"),
}
"""Coordinates, the error that each is, and its message."""

PAYLOADS: dict[str, tuple[Any, type[RttrrError], str]] = {
    "unknown-link": (Wrench((0, 0, 0), link="link_7"), UnknownNameError, "no link is called 'link_7'"),
    "root": (Wrench((0, 0, 0), link="base"), UnknownNameError, "'base' is the root"),
    "tuple": ((1, 2, 3), InputError, "payload is a int, expected a Wrench"),
    "integer": (3, InputError, "payload is a int, expected a Wrench"),
}
"""Payloads, the error that each is, and its message."""
