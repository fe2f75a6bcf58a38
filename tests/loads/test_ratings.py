"""Lives of gears by the maker's formula, and files of ratings that say what is wrong with them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from rttrr_pin import InputError, JointEffects, load
from rttrr_pin.loads import GearRating, compute_loads, read_ratings
from rttrr_pin.loads.ratings import EXAMPLE
from rttrr_pin.trajectories import trajectory
from support.serial_chains import random_chain

ROOT = Path(__file__).parents[2]

RATING = GearRating(ratio=100, rated_torque=67, rated_speed=2000, rated_life=35000)

AS_TOML = "[joint_1]\nratio = 100\nrated_torque = 67\nrated_speed = 2000\nrated_life = 35000\n"

WRONG = {
    "": "is empty: write, for each joint with a gear:\n.joint_1.\nratio = 100",
    "[joint_1": "is no TOML: ",
    "\x00": "is no TOML: ",
    "joint_1 = 3": "joint_1 is 3: expected a table with ratio, rated_torque, rated_speed, rated_life",
    "[joint_1]\nratio = 100": "joint_1 lacks rated_torque, rated_speed, rated_life",
    AS_TOML.replace("ratio", "ration"): "no rating is called 'ration': did you mean ratio?",
    AS_TOML.replace("67", "0"): "rated_torque of .*joint_1 is 0: expected a positive number",
    AS_TOML.replace("67", "-67"): "rated_torque of .*joint_1 is -67: expected one number that is not negative",
    AS_TOML.replace("67", "nan"): "rated_torque of .*joint_1 is nan, expected a finite number",
    AS_TOML.replace("67", "'67'"): "rated_torque of .*joint_1 is an array of text",
    AS_TOML.replace("joint_1", "elbow"): "no joint is called 'elbow'",
    AS_TOML.replace("joint_1", "joint_2"): "joint_2 is prismatic: the life of a gear is that of a joint that turns",
    AS_TOML.replace("joint_1", "tool_joint"): "tool_joint is fixed",
}


@pytest.mark.parametrize("text", WRONG)
def test_a_file_that_cannot_be_used_says_why(text: str, tmp_path: Path) -> None:
    file = tmp_path / "gears.toml"
    file.write_text(text)
    with pytest.raises(InputError, match=WRONG[text]):
        read_ratings(file, load("rttrr").model)


def test_the_example_of_the_message_is_taken(tmp_path: Path) -> None:
    (tmp_path / "gears.toml").write_text(EXAMPLE)
    assert read_ratings(tmp_path / "gears.toml", load("rttrr").model) == {"joint_1": RATING}
    with pytest.raises(InputError, match="no.toml cannot be read: No such file"):
        read_ratings(tmp_path / "no.toml", load("rttrr").model)


def test_at_its_ratings_a_gear_lives_as_long_as_it_is_rated() -> None:
    speed = 2000 / 100 * 2 * math.pi / 60
    life = RATING.life(speed, 67.0)
    assert life.mean_input_speed == pytest.approx(2000) and life.l50 == pytest.approx(35000)
    assert life.l10 == pytest.approx(7000)
    assert RATING.life(2 * speed, 67.0).l50 == pytest.approx(35000 / 2)
    assert RATING.life(speed, 134.0).l50 == pytest.approx(35000 / 8)
    assert RATING.life(0.0, None).l50 == RATING.life(speed, 0.0).l10 == math.inf


def test_the_torque_is_averaged_as_the_maker_does() -> None:
    """Harmonic Drive AG, 1019659, equation 18.2: n_1 t_1 at T_1, n_2 t_2 at T_2; a pause counts for speed alone."""
    robot = load(random_chain(5, ("revolute",))).with_joint_effects({"joint_1": JointEffects(damping=3.0)})
    t = np.linspace(0.0, 3.0, 3001)[:, None]
    v = np.where(t < 1.0, 2.0, np.where(t < 2.0, -1.0, 0.0))
    report = compute_loads(robot, trajectory(robot, t[:, 0], t * 0, v, t * 0), ratings={"joint_1": RATING})
    [joint] = report.joints
    tau = robot.inverse_dynamics(t * 0, v, t * 0).tau[:, 0]
    T_1, T_2 = tau[0], tau[1500]
    T_av = ((2.0 * abs(T_1) ** 3 + 1.0 * abs(T_2) ** 3) / 3.0) ** (1 / 3)
    assert joint.gear_torque == pytest.approx(T_av, rel=1e-3)
    assert joint.mean_speed == pytest.approx(1.0, rel=1e-3)
    assert joint.gear is not None
    assert joint.gear == RATING.life(joint.mean_speed, joint.gear_torque)


def test_the_gear_of_a_follower_is_that_of_its_leader() -> None:
    robot = load(ROOT / "urdf/levels/mimic.urdf")
    follower = next(joint for joint in robot.model.joints if joint.mimic is not None)
    assert follower.mimic is not None
    leader = robot.model.joints[follower.mimic.joint].name
    q = np.zeros((2, robot.model.nv))
    with pytest.raises(InputError, match=f"{follower.name} follows {leader}"):
        compute_loads(robot, trajectory(robot, [0.0, 1.0], q, q, q), ratings={follower.name: RATING})
