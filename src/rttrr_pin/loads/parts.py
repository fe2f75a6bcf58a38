"""Loads of one joint, one bearing, one gear: what `LoadReport` is made of."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rttrr_pin.core.joint import Limits

BAND = 1.96
"""Standard deviations on either side that hold 95 percent of a normal distribution."""


@dataclass(frozen=True, slots=True)
class Peak:
    """The value of largest magnitude, with its sign, and where it was seen first.

    Attributes:
        value: the number, in the unit of what it is the peak of.
        row: line or row of the trajectory, as its messages name it.
        time: [s].
        error: half the width of the band of 95 percent there, where derivatives were computed; else None.
        state: index among the states of the report; None where it is none of them.
    """

    value: float
    row: int
    time: float
    error: float | None = None
    state: int | None = None


@dataclass(frozen=True, slots=True)
class Level:
    """How large something is over a trajectory.

    With w_k half the time between the rows before and behind row k (the trapezoidal rule):

        rms = (sum of w_k x_k^2 / sum of w_k)^(1/2)
        cubic_mean = (sum of w_k |x_k|^3 / sum of w_k)^(1/3)

    Attributes:
        unit: of all three.
        peak: the largest magnitude.
        rms: root mean square.
        cubic_mean: cubic mean.
    """

    unit: str
    peak: Peak
    rms: float
    cubic_mean: float


@dataclass(frozen=True, slots=True)
class GearLife:
    """The life of the wave generator's bearing in a strain wave gear, by the formula of the maker.

        L50 = L_n (n_N / n_av) (T_N / T_av)^3,   L10 = L50 / 5

    Harmonic Drive AG, Engineering Data 1019659, 11/2014, equations 20.2 and 20.3. T_av is `JointLoad.gear_torque`.

    Attributes:
        ratio: of the gear, turns of its input for one of its output.
        rated_torque: T_N, of the output [N m].
        rated_speed: n_N, of the input [rpm].
        rated_life: L_n, at both [h].
        mean_input_speed: n_av, pauses included [rpm].
        l50: hours that half of such gears outlive; infinite where the gear carries nothing or stands still.
        l10: hours that nine in ten outlive.
    """

    ratio: float
    rated_torque: float
    rated_speed: float
    rated_life: float
    mean_input_speed: float
    l50: float
    l10: float


@dataclass(frozen=True, slots=True)
class JointLoad:
    """What drives one degree of freedom.

    Attributes:
        name: of the degree of freedom, as in `Model.v_names`.
        unit: of tau, "N m" or "N".
        speed_unit: of v, "rad/s" or "m/s".
        tau: the driving torque or force, weighted by time.
        gear_torque: its cubic mean weighted by speed and time, as makers of gears average it,
            (sum of w_k |v_k tau_k^3| / sum of w_k |v_k|)^(1/3) (Harmonic Drive AG, 1019659, equation 18.2); None where
            the joint stands still.
        speed: the largest speed.
        mean_speed: sum of w_k |v_k| / sum of w_k, at the joint.
        reversals: how often the direction of motion changes; speeds within their band of zero do not count.
        power: the largest tau v, positive where the drive gives, negative where it takes [W].
        energy_in: what the drive gives, the integral of tau v where that is positive [J].
        energy_back: what it takes back, the same where tau v is negative, as a positive number [J].
        limits: what the file allows.
        lowest: the smallest coordinate; None where the joint has other coordinates than rates.
        highest: the largest.
        gear: the life of the gear; None without ratings.
    """

    name: str
    unit: str
    speed_unit: str
    tau: Level
    gear_torque: float | None
    speed: Peak
    mean_speed: float
    reversals: int
    power: Peak
    energy_in: float
    energy_back: float
    limits: Limits
    lowest: Peak | None
    highest: Peak | None
    gear: GearLife | None = None

    @property
    def effort_margin(self) -> float:
        """What is left of the effort limit at the peak, 1 - |tau| / limit; negative beyond it, 1 without limit."""
        return _margin(self.tau.peak.value, self.limits.effort)

    @property
    def velocity_margin(self) -> float:
        """What is left of the velocity limit, likewise."""
        return _margin(self.speed.value, self.limits.velocity)

    @property
    def exceeded(self) -> tuple[str, ...]:
        """The limits that the trajectory exceeds, or may: what is not known to be within is named too."""
        within = {
            "effort": abs(self.tau.peak.value) <= self.limits.effort,
            "velocity": abs(self.speed.value) <= self.limits.velocity,
            "lower": self.lowest is None or self.lowest.value >= self.limits.lower,
            "upper": self.highest is None or self.highest.value <= self.limits.upper,
        }
        return tuple(name for name, held in within.items() if not held)

    @property
    def doubtful(self) -> bool:
        """Whether tau is within its limit only by less than its band of 95 percent."""
        peak, limit = abs(self.tau.peak.value), self.limits.effort
        return peak <= limit and not peak + (self.tau.peak.error or 0.0) <= limit


@dataclass(frozen=True, slots=True)
class BearingLoad:
    """What crosses a joint, seen from its axis u: f and n as in `LinkWrenches`, at the origin of {i}.

        axial = f . u,   radial = |f - axial u|,   torsion = n . u,   tilting = |n - torsion u|

    Along a joint's own freedom it is the drive that carries: torsion of a bearing, axial of a guide.

    Attributes:
        joint: its name.
        link: the child link, whose frame is {i}.
        kind: "bearing" (turns about u), "guide" (slides along u), "plane" (moves across u), "flange" (fixed) or "free".
        axis: u, in {i}; the z axis of {i} where the joint has none.
        radial: [N].
        axial: [N].
        tilting: [N m].
        torsion: [N m].
    """

    joint: str
    link: str
    kind: str
    axis: tuple[float, float, float]
    radial: Level
    axial: Level
    tilting: Level
    torsion: Level


def _margin(value: float, limit: float) -> float:
    if limit == 0.0:
        return 1.0 if value == 0.0 else -math.inf
    return 1.0 if limit == math.inf else float(1.0 - abs(value) / limit)
