"""Hypotheses on gravity: another size, sign or direction."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import STANDARD_GRAVITY, Model
from rttrr_pin.diagnosis.catalogue.altering import with_gravity
from rttrr_pin.diagnosis.variants.hypothesis import Apply, Hypothesis

KNOWN = {"standard gravity": 9.80665, "9.81": 9.81, "9.8": 9.8, "10": 10.0, "the moon's": 1.62, "none": 0.0}
"""Sizes that have a name [m/s^2]."""

NEAR = 1e-6
"""Relative: how near a fitted size is to one of them."""


def gravities(model: Model) -> Iterator[Hypothesis]:
    """Every other gravity than the robot's."""
    own = model.gravity
    size = float(np.linalg.norm(own))
    if size:
        yield _fixed("gravity missing", "gravity is not counted", "let the base accelerate upwards", np.zeros(3), own)
        yield _fixed(
            "gravity of another sign", "gravity has the opposite sign",
            "let the base accelerate by minus gravity: upwards", 0.0 - own, own,
            lambda variant, x: with_gravity(variant, -variant.model.gravity),  # which may have another size
        )  # fmt: skip
    length = size or float(np.linalg.norm(STANDARD_GRAVITY))
    for k, sign in ((2, -1), (2, 1), (0, 1), (0, -1), (1, 1), (1, -1)):
        other, name = sign * length * np.eye(3)[k], ("-" if sign < 0 else "") + "xyz"[k]
        if not np.allclose(other, own) and not np.allclose(other, -own):
            yield _fixed(
                f"gravity along {name}", f"gravity acts along {name} of the base",
                f"let gravity act along {_listed(own)}", other, own,
            )  # fmt: skip
    if size:
        yield Hypothesis(
            id="gravity of another size",
            kind="convention",
            sentence="gravity has another size",
            repair=f"use {size:g} m/s^2",
            apply=lambda variant, x: with_gravity(variant, float(x[0]) * variant.model.gravity),
            start=(1.5,),
            neutral=(1.0,),
            values=lambda x: _told(size * x[0], size),
        )
    yield Hypothesis(
        id="another gravity",
        kind="convention",
        sentence="gravity has another size and direction",
        repair=f"use {_listed(own)} m/s^2 in base axes",
        apply=lambda variant, x: with_gravity(variant, np.array(x)),
        start=tuple((own[[1, 2, 0]] + 1.0).tolist()),
        neutral=tuple(own.tolist()),
        values=lambda x: {"gravity": list(x), "gravity of the robot": own.tolist()},
    )


def _told(size: float, own: float) -> dict[str, Any]:
    """A size, and its name where it has one."""
    named = [name for name, known in KNOWN.items() if abs(abs(size) - known) <= NEAR * own]
    return {"gravity": size, "gravity of the robot": own} | ({"which is": named[0]} if named else {})


def _fixed(id: str, sentence: str, repair: str, gravity: Array, own: Array, apply: Apply | None = None) -> Hypothesis:
    """Gravity that is not fitted."""
    return Hypothesis(
        id=id,
        kind="convention",
        sentence=sentence,
        repair=repair,
        apply=apply or (lambda variant, x: with_gravity(variant, gravity)),
        values=lambda x: {"gravity": gravity.tolist(), "gravity of the robot": own.tolist()},
    )


def _listed(x: Array) -> str:
    return f"({', '.join(f'{value:g}' for value in x)})"
