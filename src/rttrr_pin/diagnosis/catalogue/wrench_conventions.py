"""Hypotheses on frame, point and sign of F, N, f and n; they show where a program gives wrenches."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.conventions import Convention, convention
from rttrr_pin.core.joint_wrenches import joint_wrenches
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.altering import with_gravity
from rttrr_pin.diagnosis.catalogue.kinematics import in_base, on_parents, turned, turned_back
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.variant import Values, Variant
from rttrr_pin.implementations.protocol import Batch

Frames = Callable[[Model, Batch], tuple[Array, Array]]
"""R and p of each link in another frame."""

Told = Callable[[Variant, Batch, Values], Values]
"""What the program says in place of its values: the batch is that of the recursion."""


def wrench_conventions(model: Model) -> tuple[Hypothesis, ...]:
    """All of them."""
    return SLIPS if model.links else ()


def _slip(id: str, sentence: str, repair: str, told: Told) -> Hypothesis:
    return Hypothesis(id, "convention", sentence, repair, partial(_apply, told=told))


def _apply(variant: Variant, x: Sequence[float], told: Told) -> Variant:
    return variant.with_output(lambda batch, values: {**values, **told(variant, variant.given(batch), values)})


def _turned(keys: str, frames: Frames) -> Told:
    """In the axes of another frame."""

    def told(variant: Variant, batch: Batch, values: Values) -> Values:
        R, _ = frames(variant.model, batch)
        return {key: turned(R, values[key]) for key in keys}

    return told


def _sign(keys: str) -> Told:
    return lambda variant, batch, values: {key: -values[key] for key in keys}


def _coms(model: Model) -> Array:
    return np.array([link.com for link in model.links])


def _n_about_com(variant: Variant, batch: Batch, values: Values) -> Values:
    return {"n": values["n"] - np.cross(_coms(variant.model), values["f"])}


def _N_about_origin(variant: Variant, batch: Batch, values: Values) -> Values:
    return {"N": values["N"] + np.cross(_coms(variant.model), values["F"])}


def _n_about(frames: Frames) -> Told:
    """N about the origin of another frame."""

    def told(variant: Variant, batch: Batch, values: Values) -> Values:
        R, p = frames(variant.model, batch)
        return {"n": values["n"] + np.cross(turned_back(R, p), values["f"])}

    return told


def _spatial_in_base(variant: Variant, batch: Batch, values: Values) -> Values:
    """In base axes, and n about the origin of the base."""
    R, p = in_base(variant.model, batch)
    f, n = turned(R, values["f"]), turned(R, values["n"])
    return {"f": f, "n": n + np.cross(p, f)}


def _as_in(row: Convention) -> Told:
    """As another program says them."""

    def told(variant: Variant, batch: Batch, values: Values) -> Values:
        wrenches = joint_wrenches(row, variant.model, batch.q, values["f"], values["n"])
        return {"f": wrenches.force, "n": wrenches.moment}

    return told


def _without_gravity(keys: str) -> Told:
    """Those of the recursion without gravity."""

    def told(variant: Variant, batch: Batch, values: Values) -> Values:
        light = replace(with_gravity(variant, np.zeros(3)), inputs=())
        results = light.evaluate(batch)
        return {key: results[key] for key in keys}

    return told


def _exchanged(variant: Variant, batch: Batch, values: Values) -> Values:
    return {"F": values["N"], "N": values["F"], "f": values["n"], "n": values["f"]}


def _of_parent_side(variant: Variant, batch: Batch, values: Values) -> Values:
    """On the parent, in its axes: minus R f and minus R n."""
    R, _ = on_parents(variant.model, batch)
    return {key: -turned(R, values[key]) for key in "fn"}


AXES = "the axes of each link's own frame"

SLIPS = (
    *(
        _slip(f"{name} in {id}", f"{name} are in {axes}", f"turn them by R^T to {AXES}", _turned(keys, frames))
        for id, axes, frames in (
            ("base axes", "base axes", in_base),
            ("the parent's axes", "the axes of the parent's frame", on_parents),
        )
        for name, keys in (("F, N, f and n", "FNfn"), ("f and n", "fn"), ("F and N", "FN"))
    ),
    _slip(
        "sign of f and n", "f and n have the opposite sign: they are what the link exerts on its parent",
        "negate f and n: they are what the parent exerts on the link", _sign("fn"),
    ),
    _slip(
        "sign of f and n, on the parent",
        "f and n are what the link exerts on its parent, in the parent's axes",
        f"negate f and n, and turn them by R^T to {AXES}", _of_parent_side,
    ),
    _slip(
        "sign of F and N", "F and N have the opposite sign, as d'Alembert's inertia forces",
        "negate F and N", _sign("FN"),
    ),
    _slip(
        "n about the COM", "n is about the centre of mass of the link", "n - r_C x f is: add r_C x f", _n_about_com
    ),
    _slip(
        "n about the parent's origin", "n is about the origin of the parent's frame",
        "take n about the origin of the link's own frame", _n_about(on_parents),
    ),
    _slip(
        "n about the base", "n is about the origin of the base", "take n about the origin of the link's own frame",
        _n_about(in_base),
    ),
    _slip(
        "f and n in base axes about the base", "f and n are in base axes, and n about the origin of the base",
        f"turn them to {AXES}, and take n about its origin", _spatial_in_base,
    ),
    *(
        _slip(
            f"f and n as in {program}", f"f and n are in base axes, and n about {point}, as in {program}",
            f"turn them to {AXES}, and take n about its origin", _as_in(convention(name)),
        )
        for name, program, point in (
            ("mujoco", "MuJoCo's cfrc_int", "the centre of mass of the tree of bodies"),
            ("newton", "Newton's body_parent_f", "the centre of mass of each link"),
        )
    ),
    _slip(
        "N about the origin", "N is about the origin of the link's frame", "N is about the centre of mass",
        _N_about_origin,
    ),
    _slip(
        "F without gravity", "F is without gravity: mass times acceleration alone",
        "let the base accelerate upwards: F is m (v_dot_C - g)", _without_gravity("F"),
    ),
    _slip(
        "F, N, f and n without gravity", "F, N, f and n are without gravity, tau is with it",
        "let the base accelerate upwards", _without_gravity("FNfn"),
    ),
    _slip(
        "moments before forces", "F and N, f and n are exchanged", "give the force first", _exchanged
    ),
)  # fmt: skip
