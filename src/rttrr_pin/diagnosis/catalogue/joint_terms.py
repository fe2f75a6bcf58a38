"""Hypotheses on terms of the equation of motion in tau of one joint: left out, of opposite sign, halved, doubled.

Without gravity and friction, tau at a = 0 is a quadratic form in v: single rates give the centrifugal terms, and what
all rates give beyond them is the Coriolis terms. The terms of a batch are computed once, for all of the hypotheses.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.batch import blocks
from rttrr_pin.core.model import Model
from rttrr_pin.diagnosis.catalogue.slots import Slots, slots
from rttrr_pin.diagnosis.engine.simultaneous import ROWS
from rttrr_pin.diagnosis.variants.hypothesis import Hypothesis
from rttrr_pin.diagnosis.variants.mutations import Mutation
from rttrr_pin.diagnosis.variants.variant import Input, Values, Variant, run
from rttrr_pin.implementations.protocol import Batch
from rttrr_pin.validation.sampling import Sampler

Terms = dict[str, Array]
"""By the name of a term, its part of tau (N, nv)."""


@dataclass(frozen=True, slots=True)
class Term:
    """A term of the equation of motion as a sentence has it."""

    id: str
    sentence: str
    plural: bool = True


TERMS = (
    Term("velocity terms", "the velocity terms"),
    Term("centrifugal terms", "the centrifugal terms (in v_i^2)"),
    Term("Coriolis terms", "the Coriolis terms (in v_i v_k, i != k)"),
    Term("gravity", "gravity", plural=False),
    Term("inertial coupling", "the inertial coupling to other joints (M_ik a_k, k != i)", plural=False),
)


@dataclass(frozen=True, slots=True)
class Slip:
    """What happened to a term: its factor, and the predicate for one term and for several."""

    id: str
    factor: float
    of_one: str
    of_several: str


SLIPS = (
    Slip("missing", 0.0, "is left out", "are left out"),
    Slip("negated", -1.0, "has the opposite sign", "have the opposite sign"),
    Slip("halved", 0.5, "is halved: a factor 2 is missing", "are halved: a factor 2 is missing"),
    Slip("doubled", 2.0, "is counted twice", "are counted twice"),
)

STATES = 3
"""Random states that say which terms a joint has."""

ZERO = 1e-11
"""Relative to the largest term of any joint: one that is smaller is zero but for rounding."""


def joint_terms(model: Model) -> list[Hypothesis]:
    """Each term of each joint of several, where the joint has it."""
    own = slots(model)
    if len(own) < 2:
        return []
    sizes = _sizes(model)
    return [one for joint in own for term in _terms_of(joint, sizes) for one in _slips(joint, term)]


def _sizes(model: Model) -> Terms:
    """By term, the largest at each rate, (nv,), over the largest of all."""
    found = {key: np.abs(x).max(axis=0) for key, x in parts_of_tau(model, Sampler(model).draw(0, STATES)).items()}
    largest = max(x.max() for x in found.values()) or 1.0
    return {key: x / largest for key, x in found.items()}


def _terms_of(joint: Slots, sizes: Terms) -> Iterator[Term]:
    """Those that are not zero; the velocity terms as a whole where they are of both sorts."""
    has = {key: bool((x[joint.v] > ZERO).any()) for key, x in sizes.items()}
    has["velocity terms"] = has["centrifugal terms"] and has["Coriolis terms"]
    return (term for term in TERMS if has[term.id])


def _slips(joint: Slots, term: Term) -> Iterator[Hypothesis]:
    for slip in SLIPS:
        yield Hypothesis(
            id=f"{term.id} of a joint {slip.id}",
            kind="mechanics",
            sentence=f"in tau of {joint.name}, {term.sentence} {slip.of_several if term.plural else slip.of_one}",
            repair=f"add {term.sentence} to tau of {joint.name} once, with sign +",
            apply=partial(_with_factor, term=term.id, at=joint.v, factor=slip.factor),
            joint=joint.name,
        )


def _with_factor(variant: Variant, x: Sequence[float], term: str, at: list[int], factor: float) -> Variant:
    """The program that multiplies a term in these columns of tau, and does to its results what it does to all."""

    def outputs(batch: Batch, values: Values) -> Values:
        change = np.zeros_like(values["tau"])
        own = _known_terms(variant.model, variant.inputs, variant.mutations, batch)[term]
        change[:, at] = (factor - 1.0) * own[:, at]
        if not variant.outputs:
            return {**values, "tau": values["tau"] + change}
        nothing = {key: np.zeros_like(x) for key, x in values.items()}
        before, after = (variant.shown(batch, own) for own in (nothing, {**nothing, "tau": change}))
        return {key: x + (after[key] - before[key]) for key, x in values.items()}

    return variant.with_output(outputs)


@lru_cache(maxsize=16)
def _known_terms(model: Model, inputs: tuple[Input, ...], mutations: tuple[Mutation, ...], batch: Batch) -> Terms:
    """The terms of the last few programs and batches; models and batches are frozen, and known by identity."""
    return parts_of_tau(model, Variant(model, inputs).given(batch), mutations)


def parts_of_tau(model: Model, batch: Batch, mutations: Sequence[Mutation] = ()) -> Terms:
    """By term of `TERMS`, its part of tau of each joint, (N, nv), without payloads and what joints take themselves."""
    size = max(1, ROWS // (1 + 2 * model.nv))
    parts = [_parts_of_tau(model, batch, rows, mutations) for rows in blocks(len(batch), size)]
    return {term.id: np.concatenate([part[term.id] for part in parts]) for term in TERMS}


def _parts_of_tau(model: Model, batch: Batch, rows: slice, mutations: Sequence[Mutation]) -> Terms:
    """The terms of some states."""
    q, v, a = (x[rows] for x in (batch.q, batch.v, batch.a))
    n, nv = v.shape
    heavy = model.without_joint_effects()
    weightless = heavy.with_gravity(np.zeros(3))
    still = np.zeros_like(v)
    singles = np.eye(nv)[:, None, :]
    rates = np.concatenate([v[None], singles * v, np.zeros((nv, n, nv))]).reshape(-1, nv)
    accelerations = np.concatenate([np.zeros((1 + nv, n, nv)), singles * a]).reshape(-1, nv)
    many = Batch(weightless, np.tile(q, (1 + 2 * nv, 1)), rates, accelerations)
    tau = run(weightless, many, mutations)["tau"].reshape(1 + 2 * nv, n, nv)
    velocity, centrifugal = tau[0], tau[1 : 1 + nv].sum(axis=0)
    return {
        "velocity terms": velocity,
        "centrifugal terms": centrifugal,
        "Coriolis terms": velocity - centrifugal,
        "gravity": run(heavy, Batch(heavy, q, still, still), mutations)["tau"],
        "inertial coupling": np.einsum("kj,knj->nj", _of_others(model), tau[1 + nv :]),
    }


def _of_others(model: Model) -> Array:
    """1 where two rates are of different joints, (nv, nv)."""
    apart = np.ones((model.nv, model.nv))
    for joint in slots(model):
        apart[np.ix_(joint.v, joint.v)] = 0.0
    return apart
