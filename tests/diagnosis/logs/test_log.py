"""Logs: what is read of them, what derivatives and noise come to, and which causes are found."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, Robot
from rttrr_pin.diagnosis.logs.log import Log, is_log, read_log
from rttrr_pin.diagnosis.logs.log_diagnosis import LogDiagnosis, diagnose_log
from rttrr_pin.diagnosis.logs.log_report import show_log
from rttrr_pin.errors import InputError, RttrrError
from rttrr_pin.reporting.output import Output
from support.logs import excitation, write_log


@pytest.fixture(scope="module")
def arm() -> Robot:
    return rttrr_pin.load("rttrr")


def short(path: Path, real: Robot, **how: Any) -> Path:
    return write_log(path / "log.csv", real, **{"rate": 250.0, "seconds": 8.0} | how)


# Reading


def read(path: Path, arm: Robot) -> Log:
    return read_log(path, arm.model)


@pytest.mark.parametrize("columns", ["", "v", "va"])
def test_what_is_not_measured_is_derived(arm: Robot, tmp_path: Path, columns: str) -> None:
    log = read(short(tmp_path, arm, columns=columns), arm)
    q, v, a = excitation(arm.model, log.time, 0)
    for got, true, off in ((log.batch.q, q, 1e-4), (log.batch.v, v, 1e-3), (log.batch.a, a, 0.05)):
        assert np.abs(got - true).max() < off
    assert bool(log.notes) == (columns != "va") and len(log) == sum(x.stop - x.start for x in log.segments)


@pytest.mark.one_in(2)
@pytest.mark.parametrize(
    ("unit", "word"), [(1e-3, "milliseconds"), (1e-6, "microseconds"), (1e-9, "nanoseconds"), (1.0, "")]
)
@pytest.mark.parametrize("columns", ["", "va"])
def test_units_of_time_are_recognised_and_said(
    arm: Robot, tmp_path: Path, unit: float, word: str, columns: str
) -> None:
    log = read(short(tmp_path, arm, unit=unit, header="t", columns=columns), arm)
    assert 7.0 < log.time[-1] - log.time[0] < 8.0
    assert any(word in note for note in log.notes) if word else not any("taken as" in note for note in log.notes)


def test_nanoseconds_since_1970_keep_their_digits(arm: Robot, tmp_path: Path) -> None:
    path = short(tmp_path, arm)
    header, *lines = path.read_text().splitlines()
    cells = (line.partition(",") for line in lines)
    stamped = [f"{1_764_345_600_000_000_000 + round(float(t) * 1e9)},{rest}" for t, _, rest in cells]
    path.write_text("\n".join([header, *stamped]))
    log = read(path, arm)
    np.testing.assert_allclose(np.diff(log.time), 1 / 250, rtol=1e-9)


def test_duplicates_gaps_turns_and_numbers_that_are_none(arm: Robot, tmp_path: Path) -> None:
    path = short(tmp_path, arm)
    header, *lines = path.read_text().splitlines()
    lines[100] = lines[100].replace(lines[100].split(",")[3], "nan")
    turned = [line.split(",") for line in lines]
    for row in turned[1000:]:
        row[1] = repr(float(row[1]) + 2 * np.pi)
    lines = [",".join(row) for row in turned]
    path.write_text("\n".join([header, *lines[:50], *lines[40:600], *lines[700:]]))
    with pytest.raises(InputError, match=r"line 52, column time: it goes back"):
        read(path, arm)
    path.write_text("\n".join([header, *lines[:50], lines[49], *lines[50:600], *lines[700:]]))
    log = read(path, arm)
    said = "\n".join(log.notes)
    assert "q_joint_3 is nan in 1 row, the first in line 103" in said and "is repeated in 1 row" in said
    assert "1 gap in time" in said and "joint_1 jumps by a turn" in said
    assert len(log.segments) == 2
    assert np.abs(log.batch.a - excitation(arm.model, log.time, 0)[2]).max() < 0.1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("q_joint_2", "x"), "lacks the columns q_joint_2"),
        (("tau_joint_4", "x"), "lacks the columns tau_joint_4"),
        (("tau_joint_4", "tau_joint_9"), "no column is called 'tau_joint_9'"),
        (("time", "when"), "has no column time or t"),
    ],
)
def test_what_a_log_lacks_is_named(arm: Robot, tmp_path: Path, change: tuple[str, str], message: str) -> None:
    path = short(tmp_path, arm)
    path.write_text(path.read_text().replace(*change, 1))
    with pytest.raises(RttrrError, match=message):
        read(path, arm)


def test_a_log_is_told_from_a_table_of_results(arm: Robot, tmp_path: Path) -> None:
    path = short(tmp_path, arm)
    assert is_log(path, arm.model)
    path.write_text(path.read_text().replace("time", "row", 1))
    assert not is_log(path, arm.model)
    assert not is_log("recursion", arm.model)


def test_a_few_rows_are_a_log_that_is_too_short_or_results(arm: Robot, tmp_path: Path) -> None:
    path = short(tmp_path, arm, seconds=0.1)
    assert is_log(path, arm.model)
    with pytest.raises(InputError, match="has 25 rows that can be used"):
        diagnose_log(arm, path)
    assert not is_log(short(tmp_path, arm, seconds=0.1, columns="va"), arm.model)


def test_a_payload_in_a_log_is_refused(arm: Robot, tmp_path: Path) -> None:
    path = short(tmp_path, arm)
    header, *lines = path.read_text().splitlines()
    names = [f"payload_{key}_tool_{axis}" for key in "fn" for axis in "xyz"]
    path.write_text("\n".join([",".join([header, *names]), *(f"{line},1,0,0,0,0,0" for line in lines)]))
    with pytest.raises(InputError, match="payload_f_tool_x: what the robot carried is looked for"):
        read(path, arm)


# Causes


def found(diagnosis: LogDiagnosis) -> dict[tuple[str, str | None], dict[str, Any]]:
    return {(cause.hypothesis, cause.joint or cause.link): cause.values for cause in diagnosis.causes}


PLANTED: dict[str, Any] = {
    "viscous friction": (lambda arm: arm.with_joint_effects({"joint_4": JointEffects(damping=0.6)}), "joint_4", 0.6),
    "Coulomb friction": (lambda arm: arm.with_joint_effects({"joint_1": JointEffects(friction=0.9)}), "joint_1", 0.9),
    "armature": (lambda arm: arm.with_joint_effects({"joint_5": JointEffects(armature=0.05)}), "joint_5", 0.05),
}


@pytest.mark.one_in(3)
@pytest.mark.parametrize("kind", PLANTED)
def test_what_a_joint_takes_is_named_with_its_number(arm: Robot, tmp_path: Path, kind: str) -> None:
    plant, joint, number = PLANTED[kind]
    diagnosis = diagnose_log(arm, short(tmp_path, plant(arm)))
    assert diagnosis.verdict == "explained" and not diagnosis.passed
    assert [*found(diagnosis)] == [(kind, joint)]
    assert diagnosis.causes[0].values[kind] == pytest.approx(number, rel=0.05)
    assert diagnosis.causes[0].explains > 0.9


@pytest.mark.slow
def test_a_payload_is_named_with_its_mass(arm: Robot, tmp_path: Path) -> None:
    real = arm.with_payload_body(1.5, com=(0.0, 0.02, 0.1))
    diagnosis = diagnose_log(arm, write_log(tmp_path / "x.csv", real, rate=250.0, seconds=8.0))
    (values,) = found(diagnosis).values()
    assert diagnosis.causes[0].link == "link_5" and "tool" in diagnosis.causes[0].sentence
    assert values["m"] == pytest.approx(1.5, rel=0.02)
    assert diagnosis.verdict == "explained"


@pytest.mark.slow
def test_another_gravity_is_named(arm: Robot, tmp_path: Path) -> None:
    gravity = (0.5, 0.0, -9.8)
    causes = found(diagnose_log(arm, short(tmp_path, rttrr_pin.load("rttrr", gravity=gravity))))
    np.testing.assert_allclose(causes["gravity", None]["gravity"], gravity, atol=0.02)


def test_an_offset_is_named(tmp_path: Path) -> None:
    robot = rttrr_pin.load("trr")
    causes = found(diagnose_log(robot, short(tmp_path, robot, offset=0.7)))
    assert causes["offset", "joint_1"]["offset"] == pytest.approx(0.7, rel=0.03)


def test_of_a_joint_that_stands_still_friction_and_an_offset_are_one(tmp_path: Path) -> None:
    robot = rttrr_pin.load("trr")
    path = short(tmp_path, robot)
    header = path.read_text().splitlines()[0]
    t = np.arange(0.0, 8.0, 1 / 250)
    q, v, a = excitation(robot.model, t, 0)
    q[:, 1], v[:, 1], a[:, 1] = 0.1, 0.0, 0.0
    noise = np.random.default_rng(0).standard_normal((2, *q.shape))
    tau = robot.inverse_dynamics(q, v, a).tau + [0.0, 0.5, 0.0] + 0.05 * noise[0]
    np.savetxt(path, np.hstack([t[:, None], q + 1e-5 * noise[1], tau]), "%.12g", ",", header=header, comments="")
    diagnosis = diagnose_log(robot, path)
    causes = found(diagnosis)
    assert [*causes] == [("force at rest", "joint_2")]
    assert causes["force at rest", "joint_2"]["force at rest"] == pytest.approx(0.5, rel=0.03)
    assert "friction at rest or an offset" in diagnosis.summary()


def test_a_sign_is_named(tmp_path: Path) -> None:
    robot = rttrr_pin.load("trr")
    path = short(tmp_path, robot)
    header, *lines = path.read_text().splitlines()
    table = np.loadtxt(io.StringIO("\n".join(lines)), delimiter=",")
    table[:, 4:] *= -1
    np.savetxt(path, table, "%.12g", ",", header=header, comments="")
    causes = found(diagnose_log(robot, path))
    assert causes["factor of all tau", None]["factor"] == pytest.approx(-1.0, rel=0.01)


def test_several_causes_are_each_named(tmp_path: Path) -> None:
    """Friction at each joint, and a load."""
    arm = rttrr_pin.load("trr")
    names = arm.joint_names
    real = arm.with_joint_effects({name: JointEffects(damping=1.0, friction=0.5) for name in names})
    diagnosis = diagnose_log(
        arm, write_log(tmp_path / "x.csv", real.with_payload_body(1.5, (0, 0, 0.1)), rate=500.0, seconds=8.0)
    )
    causes = found(diagnosis)
    assert diagnosis.verdict == "explained"
    assert {(kind, name) for name in names for kind in ("viscous friction", "Coulomb friction")} <= {*causes}
    assert causes["inertia", "link_3"]["m"] == pytest.approx(1.5, rel=0.02)
    assert len(causes) == 7
    for name in names:
        assert causes["viscous friction", name]["viscous friction"] == pytest.approx(1.0, rel=0.05)
        assert causes["Coulomb friction", name]["Coulomb friction"] == pytest.approx(0.5, rel=0.05)


@pytest.mark.slow
def test_what_the_model_has_is_no_cause(tmp_path: Path) -> None:
    robot = rttrr_pin.load("trr")
    real = robot.with_joint_effects({"joint_2": JointEffects(damping=0.6)})
    path = short(tmp_path, real)
    assert diagnose_log(real, path).passed and not diagnose_log(robot, path).passed


@pytest.mark.one_in(5)
@pytest.mark.parametrize("seed", range(20))
def test_nothing_is_found_where_nothing_is(tmp_path: Path, seed: int) -> None:
    robot = rttrr_pin.load("trr")
    diagnosis = diagnose_log(robot, short(tmp_path, robot, seed=seed, columns="va" if seed % 4 == 0 else ""))
    assert (diagnosis.verdict, diagnosis.causes) == ("agrees", ())


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(3))
def test_noise_that_was_filtered_is_told_by_what_no_column_explains(arm: Robot, tmp_path: Path, seed: int) -> None:
    """Most robots filter what they log."""
    real = arm.with_joint_effects({"joint_4": JointEffects(damping=0.6)})
    path = short(tmp_path, real, of_tau=0.0, seed=seed)
    header, *lines = path.read_text().splitlines()
    table = np.loadtxt(io.StringIO("\n".join(lines)), delimiter=",")
    white = np.random.default_rng(seed).standard_normal((len(table), 5))
    table[:, 6:] += 0.2 * np.apply_along_axis(np.convolve, 0, white, np.ones(10) / 10, "same")
    np.savetxt(path, table, "%.12g", ",", header=header, comments="")
    assert np.isnan(read(path, arm).noise).all()
    assert diagnose_log(real, path).verdict == "agrees"
    diagnosis = diagnose_log(arm, path)
    assert [*found(diagnosis)] == [("viscous friction", "joint_4")] and diagnosis.verdict == "explained"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 160))
def test_nothing_is_found_where_nothing_is_at_a_thousand_hertz(arm: Robot, tmp_path: Path, seed: int) -> None:
    """At several sizes of noise."""
    how = {"of_q": 10.0 ** (-3 - seed % 4), "of_tau": 0.02 * (1 + seed % 7)}
    diagnosis = diagnose_log(arm, write_log(tmp_path / "x.csv", arm, seed, **how))  # type: ignore[arg-type]
    assert (diagnosis.verdict, diagnosis.causes) == ("agrees", ())


def test_what_no_column_explains_is_left_and_said(arm: Robot, tmp_path: Path) -> None:
    """A spring: linear in q, which nothing here is."""
    path = short(tmp_path, arm)
    header, *lines = path.read_text().splitlines()
    table = np.loadtxt(io.StringIO("\n".join(lines)), delimiter=",")
    table[:, 6] += 3.0 * np.sin(2 * table[:, 1])
    np.savetxt(path, table, "%.12g", ",", header=header, comments="")
    diagnosis = diagnose_log(arm, path)
    assert diagnosis.verdict == "unexplained"
    assert [name for name, own in diagnosis.after.items() if not own.at_noise] == ["joint_1"]
    assert "more than noise is left at joint_1" in diagnosis.summary()


def test_a_diagnosis_is_data_and_a_report(arm: Robot, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    real = arm.with_joint_effects({"joint_4": JointEffects(damping=0.6)})
    diagnosis = diagnose_log(arm, short(tmp_path, real))
    data = json.loads(json.dumps(diagnosis.to_dict(), allow_nan=False))
    assert data["schema"] == 1 and data["verdict"] == "explained"
    assert {"hypothesis", "link", "joint", "sentence", "values"} <= data["causes"][0].keys()
    assert data["residual_before"]["joint_4"]["rms"] > 5 * data["residual_after"]["joint_4"]["rms"]
    show_log(diagnosis, Output(width=120))
    out = capsys.readouterr().out
    assert diagnosis.causes[0].sentence in out and "EXPLAINED" in out and "joint_5" in out
