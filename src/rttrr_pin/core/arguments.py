"""Arguments that are one number, a word, names or a path: what was meant, or an error that says what was expected."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Set
from pathlib import Path
from typing import Any

import numpy as np

from rttrr_pin.core.inputs import finite, real
from rttrr_pin.errors import InputError, NumberError


def whole_number(name: str, value: object, least: int, most: int, shown: str = "", option: str = "") -> int:
    """An integer in a range; a bool is none. `option` is what the command line calls it.

    Raises:
        InputError: it is of another type, or out of range.
    """
    wanted, options = f"expected a whole number from {least} to {shown or most}", {name: option} if option else {}
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise InputError(f"{name} is {value!r} ({type(value).__name__}): {wanted}", options)
    if not least <= value <= most:
        raise InputError(f"{name} is {value}: {wanted}", options)
    return int(value)


def not_negative(label: str, value: Any, name: str = "", joint: str | None = None) -> float:
    """One number such as a mass.

    Raises:
        NumberError: it is several, not finite, or negative.
    """
    number = finite(label, real(label, value))
    if number.ndim or number < 0.0:
        message = f"{label} is {value}: expected one number that is not negative"
        raise NumberError(message, name=name or label, joint=joint, value=value)
    return float(number)


def positive(name: str, value: Any, unit: str, option: str = "") -> float:
    """One number above zero. `option` is what the command line calls it.

    Raises:
        NumberError: it is several, not finite, or not above zero.
    """
    number = finite(name, real(name, value))
    if number.ndim or not number > 0.0:
        message = f"{name} is {value!r}: expected one number above zero, in {unit}"
        error = NumberError(message, name=name, value=value)
        error.options = {name: option} if option else {}
        raise error
    return float(number)


def text(name: str, value: object) -> str:
    """A name.

    Raises:
        InputError: it is of another type.
    """
    if not isinstance(value, str):
        raise InputError(f"{name} is a {type(value).__name__}: pass text")
    return value


def relative_tolerance(value: Any) -> float:
    """A relative tolerance.

    Raises:
        NumberError: it is no number between 0 and 1.
    """
    number = real("tolerance", value)
    if number.ndim or not 0.0 < number < 1.0:
        message = f"tolerance is {value}: expected a number between 0 and 1, such as 1e-9"
        raise NumberError(message, name="tolerance", value=value)
    return float(number)


def names_of(argument: str, values: str | Iterable[str]) -> tuple[str, ...]:
    """One name, or several in an order.

    Raises:
        InputError: it is something else.
    """
    several = (values,) if isinstance(values, str) else values
    if isinstance(several, Iterable) and not isinstance(several, Mapping | Set | bytes | np.ndarray):
        several = tuple(several)
        if all(isinstance(name, str) for name in several):
            return several
    raise InputError(f"{argument} is {values!r}: pass a name, or several in a tuple")


def choice(argument: str, value: object, *known: str, option: str = "") -> None:
    """A word is one of those that are known. `option` is what the command line calls it.

    Raises:
        InputError: it is not.
    """
    if not isinstance(value, str) or value not in known:
        raise InputError(
            f"{argument} is {value!r}: expected {' or '.join(map(repr, known))}", {argument: option} if option else {}
        )


def path_of(argument: str, value: object) -> Path:
    """A path in any form.

    Raises:
        InputError: it is of another type.
    """
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if not isinstance(value, str):
        raise InputError(f"{argument} is a {type(value).__name__}: pass a path")
    return Path(value)
