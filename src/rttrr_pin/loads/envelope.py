"""The envelope of a trajectory, block by block: what drives each degree of freedom, and what each bearing carries."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.model import Model
from rttrr_pin.loads.bearings import PARTS, UNITS, axes, kind
from rttrr_pin.loads.evaluation import Values
from rttrr_pin.loads.parts import BAND, BearingLoad, JointLoad, Peak
from rttrr_pin.loads.quantities import force_units, rate_units
from rttrr_pin.loads.ratings import Ratings
from rttrr_pin.loads.states import States
from rttrr_pin.loads.sums import Means, Peaks, Place
from rttrr_pin.trajectories import Block


class JointEnvelope:
    """What drives each degree of freedom."""

    def __init__(self, model: Model) -> None:
        self._model, nv = model, model.nv
        self._peaks = {name: Peaks(nv) for name in ("tau", "speed", "power", "lowest", "highest")}
        self._means = Means(nv)
        self._reversals = [0] * nv
        self._ahead: list[bool | None] = [None] * nv
        self._given, self._taken = np.zeros((2, nv))
        self._coordinates = _coordinates(model)

    def add(self, rows: Block, weights: Array, values: Values) -> None:
        """Rows more, with their tau."""
        forces, rates = (np.ascontiguousarray(x.T) for x in (values["tau"], rows.v))
        sizes, speeds = np.abs(forces), np.abs(rates)
        self._means.add(sizes, weights, speeds)
        with np.errstate(over="ignore", invalid="ignore"):
            power = forces * rates
            work = power * weights
            self._given += np.maximum(work, 0.0).sum(axis=1)
            self._taken += np.maximum(-work, 0.0).sum(axis=1)
        self._count_reversals(rates, rows.errors)
        q = np.ascontiguousarray(rows.q[:, [max(k, 0) for k in self._coordinates]].T)
        self._peaks["tau"].add(sizes, forces, rows)
        self._peaks["speed"].add(speeds, rates, rows)
        self._peaks["power"].add(np.abs(power), power, rows)
        self._peaks["lowest"].add(-q, q, rows)
        self._peaks["highest"].add(q, q, rows)

    def _count_reversals(self, rates: Array, errors: Array | None) -> None:
        """A change of sign, but for speeds that may as well be zero."""
        least: Array | float = 0.0
        if errors is not None:
            least = BAND * np.sqrt((errors[:, :, 1, :] ** 2).sum(axis=-1)).T
        ahead, back = rates > least, rates < -least
        moving = ahead | back
        for j, own in enumerate(ahead):
            signs = own if moving[j].all() else own[moving[j]]
            if len(signs):
                self._reversals[j] += int(np.count_nonzero(signs[1:] != signs[:-1]))
                before = self._ahead[j]
                self._reversals[j] += before is not None and before != signs[0]
                self._ahead[j] = bool(signs[-1])

    def marked(self) -> Iterator[tuple[str, Place]]:
        """The states that matter, and why."""
        for name in ("tau", "speed", "power"):
            for label, place in zip(self._model.v_names, self._peaks[name].seen(), strict=True):
                yield f"peak {name} of {label}", place

    def loads(self, states: States, ratings: Ratings) -> Iterator[JointLoad]:
        """One for each degree of freedom."""
        units, speed_units = force_units(self._model), rate_units(self._model)
        limits = [joint.limits for joint in self._model.moving for _ in range(joint.nv)]
        by_rate, speeds = self._means.cubic_by_rate, self._means.mean_rates
        peaks = {name: own.seen() for name, own in self._peaks.items()}
        for j, name in enumerate(self._model.v_names):
            one = self._coordinates[j] >= 0
            rating = ratings.get(name)
            yield JointLoad(
                name=name,
                unit=units[j],
                speed_unit=speed_units[j],
                tau=self._means.level(j, units[j], states.peak(peaks["tau"][j], "tau", j)),
                gear_torque=by_rate[j],
                speed=states.peak_speed(peaks["speed"][j], j),
                mean_speed=float(speeds[j]),
                reversals=self._reversals[j],
                power=states.peak(peaks["power"][j], "power", j),
                energy_in=float(self._given[j]),
                energy_back=float(self._taken[j]),
                limits=limits[j],
                lowest=_peak(peaks["lowest"][j]) if one else None,
                highest=_peak(peaks["highest"][j]) if one else None,
                gear=None if rating is None else rating.life(float(speeds[j]), by_rate[j]),
            )


class BearingEnvelope:
    """What crosses each joint, seen from its axis."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._peaks = {name: Peaks(len(model.links)) for name in PARTS}
        self._means = {name: Means(len(model.links)) for name in PARTS}

    def add(self, rows: Block, weights: Array, values: Values) -> None:
        """Rows more, with the parts of what crosses their joints."""
        for name in PARTS:
            own = np.ascontiguousarray(values[name].T)
            sizes = np.abs(own)
            self._means[name].add(sizes, weights)
            self._peaks[name].add(sizes, own, rows)

    def marked(self) -> Iterator[tuple[str, Place]]:
        """The states that matter, and why."""
        for name in PARTS:
            for joint, place in zip(self._model.joints, self._peaks[name].seen(), strict=True):
                yield f"peak {name} of {joint.name}", place

    def loads(self, states: States) -> Iterator[BearingLoad]:
        """One for each joint."""
        peaks = {name: own.seen() for name, own in self._peaks.items()}
        for i, (joint, axis) in enumerate(zip(self._model.joints, axes(self._model), strict=True)):
            parts = {
                name: self._means[name].level(i, UNITS[name], states.peak(peaks[name][i], name, i)) for name in PARTS
            }
            x, y, z = axis.tolist()
            yield BearingLoad(joint.name, self._model.links[i].name, kind(joint), (x, y, z), **parts)


def _peak(place: Place) -> Peak:
    return Peak(place.value, int(place.at.rows[0]), float(place.at.time[0]))


def _coordinates(model: Model) -> list[int]:
    """For each degree of freedom where its coordinate is in q; -1 where its joint has several."""
    places, at = [], 0
    for joint in model.moving:
        places += [at] if joint.nq == joint.nv == 1 else [-1] * joint.nv
        at += joint.nq
    return places
