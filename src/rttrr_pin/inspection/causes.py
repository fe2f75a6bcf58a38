"""Why a tensor is wrong: of all readings of its numbers, the one that explains them.

A reading is named where it is the only one that makes the tensor that of the link's shapes; where none does, that of a
body at all, or of a plausible size. Where several would, with different outcomes, nothing is named.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.inspection.bodies import principal
from rttrr_pin.inspection.cases import DENSITIES, FAR, Case, distance, ellipsoid_density
from rttrr_pin.inspection.checks import Edit
from rttrr_pin.inspection.readings import READINGS, Reading, Variant, unit
from rttrr_pin.inspection.shapes import Filled
from rttrr_pin.urdf.inertial import ENTRIES

NEAR, EXACTLY, SAME = 0.13, 1e-3, 0.02
"""Distances |I - solid| / |solid|: a reading is a hull's tensor; a box's to the digits; two readings are one tensor."""

POSSIBLE = 1e-4
"""Share of the trace by which second moments may be negative: rounding to four digits makes that of a plate."""

TYPICAL = (100.0, 12_000.0)
"""Densities of equivalent ellipsoids of robots' links [kg/m^3]: 90 percent of those published."""

SIZE = 3.0
"""A tensor suits a hull in another unit if its trace is within this factor of the filled hull's."""

GUESS = 2e-4
"""Tensors that are larger than plausible by less, such as 1000 times, may be estimates and in no other unit."""


@dataclass(frozen=True, eq=False)
class Cause:
    """Why the numbers are wrong.

    Attributes:
        name: of the reading.
        sentence: what is the case.
        meant: the tensor about the centre of mass that the numbers mean, in link axes, (3, 3) [kg m^2]; None where they
            mean no body's.
        solid: the shape whose tensor it is; empty where it is none's.
        repair: the edits that mend it, where they are certain.
    """

    name: str
    sentence: str
    meant: Array | None = None
    solid: str = ""
    repair: tuple[Edit, ...] = ()


@dataclass(frozen=True, eq=False)
class Fit:
    """A reading that suits, and the solid that it is the tensor of."""

    reading: Reading
    variant: Variant
    solid: Filled | None = None
    gap: float = np.inf

    @property
    def exact(self) -> bool:
        """Whether it is the tensor of a box, cylinder or ball to the digits."""
        return self.solid is not None and self.solid.exact and self.gap < EXACTLY

    def agrees(self, other: Fit) -> bool:
        """Whether both come to one body."""
        one, two = self.variant.tensor, other.variant.tensor
        if one is None or two is None:
            return self.reading is other.reading
        return self.variant.mass == other.variant.mass and bool(np.linalg.norm(one - two) <= SAME * np.linalg.norm(two))


@lru_cache(maxsize=4096)
def cause_of(case: Case) -> Cause | None:
    """The one reading that explains the numbers; None where they need none, or none or several would."""
    if not case.suspect:
        return None
    tiers = [[(reading, variant) for reading in tier for variant in reading.variants(case)] for tier in READINGS]
    solid = [[fit for each in tier if (fit := _like_solid(case, *each))] for tier in tiers]
    fits = [fit for of_tier in solid for fit in of_tier if fit.exact and not fit.variant.slight]
    for tier, of_tier in zip(tiers, solid, strict=True):
        fits = fits or of_tier or [Fit(*each) for each in tier if _like_body(case, *each) or _like_links(case, *each)]
    return _cause(case, fits[0]) if fits and all(fit.agrees(fits[0]) for fit in fits) else None


def _like_solid(case: Case, reading: Reading, variant: Variant) -> Fit | None:
    """The solid whose tensor the variant is and the tensor written is not, the nearest of them."""
    fits, tensor, mass = [], variant.tensor, case.mass * variant.mass
    for solid in case.solids if case.unlike else ():
        if tensor is not None and DENSITIES[0] <= mass / solid.body.mass <= DENSITIES[1]:
            fit = Fit(reading, variant, solid, distance(tensor, solid.inertia(mass)))
            if fit.exact or (fit.gap < NEAR and min(case.distances) > FAR and not variant.slight):
                fits.append(fit)
    return min(fits, key=lambda fit: fit.gap, default=None)


def _like_body(case: Case, reading: Reading, variant: Variant) -> bool:
    """Whether a body can have the variant, and none what is written."""
    if case.possible and case.mass != 0.0:
        return False
    if variant.tensor is None or not variant.tensor.any():
        return True
    return case.mass != 0.0 and variant.mass == 1.0 and _possible(variant.tensor)


def _possible(tensor: Array) -> bool:
    """Whether the second moments are positive semidefinite, up to rounding."""
    second = np.trace(tensor) / 2.0 * np.eye(3) - tensor
    if not np.isfinite(second).all():
        return False
    return bool(np.linalg.eigvalsh(second)[0] >= -POSSIBLE * np.trace(tensor) and np.trace(tensor) >= 0.0)


def _like_links(case: Case, reading: Reading, variant: Variant) -> bool:
    """Of a tensor that is too wide or narrow: whether the numbers mean no body's, or one of a plausible size."""
    if not (case.wide or case.narrow):
        return False
    if variant.tensor is None or not variant.tensor.any():
        return True
    guess = variant.mass == 1.0 and np.trace(variant.tensor) > GUESS * np.trace(case.inertial.tensor)
    if reading.variants is not unit or variant.slight or guess:
        return False
    mass = case.mass * variant.mass
    if case.solids:
        hull = case.solids[-1]
        ratio = float(np.trace(variant.tensor) / np.trace(hull.inertia(mass)))
        return 1.0 / SIZE < ratio < SIZE and DENSITIES[0] <= mass / hull.body.mass <= DENSITIES[1]
    return TYPICAL[0] <= ellipsoid_density(mass, principal(variant.tensor)[0]) <= TYPICAL[1]


def _cause(case: Case, fit: Fit) -> Cause:
    """The cause in a sentence."""
    sentence, tensor = fit.variant.meaning, fit.variant.tensor
    if fit.solid is not None:
        sentence += f": so read, it is that of {fit.solid.label} to {fit.gap:.2g}"
    elif tensor is not None and tensor.any() and case.possible and case.mass > 0.0:
        gyration = np.sqrt(principal(tensor)[0][-1] / (case.mass * fit.variant.mass))
        sentence += f": so read, the radius of gyration is {gyration:.3g} m"
    elif tensor is not None and tensor.any():
        sentence += ": so read, a body can have it"
    repair = _rewrite(case, tensor) if tensor is not None and fit.exact and fit.variant.sure else ()
    return Cause(fit.reading.name, sentence, tensor, "" if fit.solid is None else fit.solid.label, repair)


def _rewrite(case: Case, meant: Array) -> tuple[Edit, ...]:
    """The tensor as it would have to be written."""
    R = case.inertial.origin.R
    written = R.T @ meant @ R
    small = 1e-12 * float(np.abs(written).max())
    values = {name: float(written[at]) for name, at in ENTRIES.items()}
    return tuple(
        Edit(case.link.name, "inertia", name, f"{0.0 if abs(value) < small else value:.9g}")
        for name, value in values.items()
        if value != float(case.inertial.entries[name])
    )
