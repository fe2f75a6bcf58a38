"""The report as data, and its verdict."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from rttrr_pin import Limits
from rttrr_pin.loads import History, JointLoad, Level, LoadReport, Peak, Samples


def a_joint(tau: float = 5.0, speed: float = 1.0, q: float = 0.5, error: float | None = None) -> JointLoad:
    limits = Limits(lower=-1.0, upper=1.0, velocity=2.0, effort=10.0)
    level = Level("N m", Peak(tau, 3, 0.1, error, 0), tau, tau)
    at = Peak(q, 3, 0.1)
    return JointLoad("joint_1", "N m", "rad/s", level, None, Peak(speed, 4, 0.2), 0.3, 0, at, 0.0, 0.0, limits, at, at)


def a_report(*joints: JointLoad) -> LoadReport:
    none = np.zeros((0, len(joints)))
    return LoadReport(
        *("arm", "moves.csv", "row", 10, 0.0, 1.0, "none", ("tau",), None, None, False, (), ()),
        joints=joints,
        bearings=(),
        history=History(np.zeros(0), none, none, None, None, 1),
        samples=Samples(np.zeros(0, np.int64), np.zeros(0), none, none, none),
        states=(),
    )


@pytest.mark.parametrize(
    ("joint", "exceeded"),
    [
        (a_joint(), ()),
        (a_joint(tau=-10.0), ()),
        (a_joint(tau=-10.5), ("effort",)),
        (a_joint(speed=-2.5, q=1.5), ("velocity", "upper")),
        (a_joint(tau=math.nan), ("effort",)),
        (a_joint(q=math.nan), ("lower", "upper")),
    ],
)
def test_what_is_not_known_to_be_within_a_limit_exceeds_it(joint: JointLoad, exceeded: tuple[str, ...]) -> None:
    report = a_report(a_joint(), joint)
    assert joint.exceeded == exceeded and report.passed == (not exceeded)
    assert all(name in report.summary() for name in exceeded)


def test_a_peak_within_its_band_of_the_limit_is_doubtful() -> None:
    assert not a_joint(9.0).doubtful and not a_joint(9.0, error=0.5).doubtful
    assert a_joint(-9.0, error=1.5).doubtful and a_joint(9.0, error=math.nan).doubtful
    assert not a_joint(11.0, error=1.5).doubtful  # it exceeds the limit


def test_the_report_is_data() -> None:
    unlimited = replace(a_joint(), limits=Limits())
    data = json.loads(json.dumps(a_report(a_joint(), unlimited).to_dict(), allow_nan=False))
    assert data["schema"] == 1 and data["passed"]
    assert [joint["effort_margin"] for joint in data["joints"]] == [0.5, 1.0]
    assert data["joints"][1]["limits"]["effort"] == "inf"
