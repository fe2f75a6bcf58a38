"""Two descriptions of one robot: each planted difference is named and ranked by what it does; the same robot is the same."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pinocchio
import pytest

import rttrr_pin
from rttrr_pin import InputError, JointEffects, Link, Model, Robot
from rttrr_pin.cli import main
from rttrr_pin.core.arrays import rotation
from rttrr_pin.core.joint import Joint, Mimic
from rttrr_pin.core.joints import CONTINUOUS, PRISMATIC, REVOLUTE
from rttrr_pin.diagnosis import Comparison, compare_robots
from rttrr_pin.validation import Sampler
from support.recursion import recursion
from support.robots import BUNDLED
from support.trees import extreme_tree, random_tree

STATES = 60

SIMPLE = ("revolute", "continuous", "prismatic", "fixed")


def with_joint(model: Model, i: int, **numbers: Any) -> Model:
    joints = [replace(joint, **numbers) if k == i else joint for k, joint in enumerate(model.joints)]
    return replace(model, joints=tuple(joints), document=None)


def with_link(model: Model, i: int, **numbers: Any) -> Model:
    links = [replace(link, **numbers) if k == i else link for k, link in enumerate(model.links)]
    return replace(model, links=tuple(links), document=None)


def moving(model: Model, types: tuple[str, ...] = ("revolute", "continuous", "prismatic")) -> int:
    """The last joint of these types that moves by itself."""
    return max(i for i, joint in enumerate(model.joints) if joint.independent and joint.type.name in types)


def tilted(axis: np.ndarray) -> np.ndarray:
    own = axis + [0.05, -0.1, 0.15]
    return own / np.linalg.norm(own)


def entry(link: Link) -> np.ndarray:
    change = np.zeros((3, 3))
    change[0, 1] = change[1, 0] = 0.2 * np.linalg.norm(link.inertia)
    return link.inertia + change


def effects(model: Model, i: int, **own: float) -> Model:
    return with_joint(model, i, effects=replace(model.joints[i].effects, **own))


PLANTED: dict[str, Callable[[Model, int], Model]] = {
    "mass": lambda model, i: with_link(model, i, mass=1.1 * model.links[i].mass),
    "centre of mass": lambda model, i: with_link(model, i, com=model.links[i].com + [0.01, 0.02, -0.03]),
    "inertia": lambda model, i: with_link(model, i, inertia=entry(model.links[i])),
    "position": lambda model, i: with_joint(model, i, p=model.joints[i].p + [0.01, 0.02, -0.03]),
    "orientation": lambda model, i: with_joint(model, i, R=rotation((0.1, 0.2, -0.1)) @ model.joints[i].R),
    "axis": lambda model, i: with_joint(model, i, axis=tilted(model.joints[i].axis)),
    "type": lambda model, i: with_joint(model, i, type=PRISMATIC if model.joints[i].type.rotates else REVOLUTE),
    "damping": lambda model, i: effects(model, i, damping=0.7 + model.joints[i].effects.damping),
    "friction": lambda model, i: effects(model, i, friction=0.6 + model.joints[i].effects.friction),
    "armature": lambda model, i: effects(model, i, armature=0.3),
    "gravity": lambda model, i: replace(model, gravity=np.array([0.0, 0.5, -9.81])),
}
"""By kind, a model with one difference at joint or link i."""


def robot_of(case: int) -> Robot:
    """A bundled arm, or a random tree with friction."""
    if case < len(BUNDLED):
        return rttrr_pin.load(BUNDLED[case])
    return rttrr_pin.load(random_tree(case, 7, SIMPLE), friction=True)


def true_share(a: Robot, b: Model) -> float:
    """The largest share of rms torque that changes, by the recursion."""
    state = Sampler(a.model).draw(0, STATES)
    one, other = (recursion(own, state.q, state.v, state.a).tau for own in (a, Robot(b)))
    return float(np.max(rms(other - one) / rms(one)))


def rms(x: np.ndarray) -> np.ndarray:
    return np.sqrt(np.mean(x**2, axis=0))


@pytest.mark.one_in(8)
@pytest.mark.parametrize("case", range(12))
@pytest.mark.parametrize("kind", PLANTED)
def test_one_planted_difference_is_the_one_that_is_named(kind: str, case: int) -> None:
    robot = robot_of(case)
    i = moving(robot.model)
    model = PLANTED[kind](robot.model, i)
    result = compare_robots(robot, Robot(model), STATES)
    truth = true_share(robot, model)  # none of a tensor that does not turn, say
    assert result.passed == (truth < 1e-12) and not result.remainder and not result.rounding
    (own,) = result.effects
    assert own.difference.kind == kind
    assert own.worst == pytest.approx(truth, rel=1e-6, abs=1e-12)
    if kind in ("mass", "centre of mass", "inertia"):
        assert (own.difference.link, own.difference.joint) == (robot.model.links[i].name, robot.model.joints[i].name)
    elif kind != "gravity":
        assert own.difference.joint == robot.model.joints[i].name
    if kind == "mass":
        assert (own.difference.a, own.difference.b) == (robot.model.links[i].mass, model.links[i].mass)
    if kind == "damping":
        assert own.difference.b - own.difference.a == pytest.approx(0.7)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("seed", range(20))
def test_pairs_of_differences_are_ranked_by_their_true_effects(seed: int) -> None:
    robot = robot_of(seed % 12)
    rng = np.random.default_rng(seed)
    i = moving(robot.model)
    first, second = rng.choice(
        ["mass", "centre of mass", "inertia", "damping", "armature", "gravity"], 2, replace=False
    )
    singles = {kind: PLANTED[kind](robot.model, i) for kind in (first, second)}
    truth = {kind: true_share(robot, model) for kind, model in singles.items()}
    result = compare_robots(robot, Robot(PLANTED[second](singles[first], i)), STATES)
    mattering = [kind for kind in sorted(truth, key=lambda kind: -truth[kind]) if truth[kind] > 1e-12]
    assert [own.difference.kind for own in result.mattering] == mattering
    assert len(result.effects) == 2 and not result.remainder


@pytest.mark.parametrize("case", range(10))
def test_a_robot_is_the_same_as_itself(case: int) -> None:
    result = compare_robots(*[robot_of(case)] * 2, STATES)
    assert result.passed and not result.effects and not result.notes and not result.rounding
    assert result.summary().endswith("the same dynamics")


@pytest.mark.parametrize("seed", range(8))
def test_a_robot_of_every_joint_type_is_the_same_as_itself(seed: int) -> None:
    text = random_tree(seed, 7)
    robot = rttrr_pin.load(text, friction=seed % 2 > 0, base="floating" if seed % 3 else "fixed")
    result = compare_robots(robot, robot, 20)
    assert result.passed and not result.effects and not result.notes


@pytest.mark.parametrize("seed", [1, 2, 18])
def test_a_robot_of_extreme_numbers_is_the_same_as_itself(seed: int) -> None:
    """However much of them is rounded away where fixed links are merged."""
    robot = rttrr_pin.load(extreme_tree(seed, 5))
    result = compare_robots(robot, robot, 20)
    assert result.passed and not result.effects


def test_progress_counts_differences() -> None:
    robot, done = rttrr_pin.load("rttrr"), list[int]()
    other = PLANTED["damping"](PLANTED["mass"](robot.model, 2), 3)
    result = compare_robots(robot, Robot(other), 20, progress=done.append)
    assert done == [1, 2] and len(result.effects) == 2


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("library", ["mujoco", "pinocchio"])
def test_a_file_is_the_same_as_what_a_library_makes_of_it(library: str, seed: int) -> None:
    """MuJoCo lists joints in another order and merges fixed links."""
    text = random_tree(seed, 7, SIMPLE, mimics=False)
    parse = pinocchio.buildModelFromXML if library == "pinocchio" else mujoco.MjModel.from_xml_string
    models = [rttrr_pin.load(own, friction=library == "mujoco") for own in (text, parse(text))]
    for one, other in (models, models[::-1]):
        result = compare_robots(one, other, STATES)
        assert result.passed and not result.mattering, result.summary()


def lumped(model: Model) -> Model:
    """The model without fixed joints, what they carry merged, by the inertia of Pinocchio."""
    links: dict[int, pinocchio.Inertia] = {}
    at: dict[int, tuple[int, pinocchio.SE3]] = {-1: (-1, pinocchio.SE3.Identity())}
    kept: list[int] = []
    joints = []
    for i, (joint, link) in enumerate(zip(model.joints, model.links, strict=True)):
        own, pose = at[joint.parent]
        pose = pose * pinocchio.SE3(joint.R, joint.p)
        inertia = pinocchio.Inertia(link.mass, link.com, link.inertia)
        if joint.nv:
            joints.append(
                replace(joint, parent=-1 if own < 0 else kept.index(own), R=pose.rotation, p=pose.translation)
            )
            kept.append(i)
            at[i], links[i] = (i, pinocchio.SE3.Identity()), inertia
        else:
            at[i] = (own, pose)
            if own >= 0:
                links[own] += pose.act(inertia)
    whole = [Link(model.links[i].name, own.mass, own.lever, own.inertia) for i, own in links.items()]
    number = {i: k for k, i in enumerate(kept)}
    joints = [replace(j, mimic=j.mimic and replace(j.mimic, joint=number[j.mimic.joint])) for j in joints]
    return replace(model, links=tuple(whole), joints=tuple(joints), document=None)


@pytest.mark.one_in(4)
@pytest.mark.parametrize("seed", range(8))
def test_merged_fixed_links_are_one_note(seed: int) -> None:
    model = rttrr_pin.load(random_tree(seed, 8, (*SIMPLE, "fixed"))).model
    for one, other in ((model, lumped(model)), (lumped(model), model)):
        result = compare_robots(Robot(one), Robot(other), STATES)
        assert result.passed and not result.effects, result.summary()
        fixed = [model.links[i].name for i, joint in enumerate(model.joints) if not joint.nv]
        assert all(any(name in note for note in result.notes) for name in fixed)


def test_a_wrong_mass_among_merged_links_is_told_of_the_whole() -> None:
    model = rttrr_pin.load(random_tree(3, 8, (*SIMPLE, "fixed"))).model
    merged = lumped(model)
    i = moving(merged)
    result = compare_robots(Robot(model), Robot(PLANTED["mass"](merged, i)), STATES)
    (own,) = result.mattering
    assert (own.difference.kind, own.difference.link) == ("mass", merged.links[i].name)
    assert own.difference.b / own.difference.a == pytest.approx(1.1)


def test_a_link_that_one_lacks_is_named() -> None:
    robot = rttrr_pin.load("rttrr")
    result = compare_robots(robot, robot.with_payload_body(0.8, (0.0, 0.1, 0.0), name="gripper"), STATES)
    (own,) = result.mattering
    assert (own.difference.kind, own.difference.link, own.difference.b) == ("link", "gripper", 0.8)
    assert not result.remainder


def test_a_body_on_the_axis_of_the_base_matters_to_no_torque() -> None:
    rod = Link("rod", 2.0, np.array([0.3, 0.0, 0.0]), 0.1 * np.eye(3))
    column = Link("column", 3.0, np.array([0.0, 0.0, 0.2]), 0.2 * np.eye(3))
    joints = (
        Joint("turn", REVOLUTE, axis=np.array([0, 0, 1.0])),
        Joint("lift", REVOLUTE, 0, axis=np.array([0, 1.0, 0])),
    )
    a = Model("a", Link("base"), (column, rod), joints)
    result = compare_robots(Robot(a), Robot(with_link(a, 0, mass=30.0)), STATES)
    assert result.passed and [own.difference.kind for own in result.idle] == ["mass"]
    assert "without an effect" in result.summary()


def reversed_names(text: str) -> str:
    """The tree with names of joints and links exchanged, and files in another order."""
    return re.sub(r'"(joint|link)_(\d+)"', lambda m: f'"{m[1]}_{99 - int(m[2])}"', text)


@pytest.mark.one_in(3)
@pytest.mark.parametrize(
    "rename",
    [
        lambda t: re.sub(r'"(joint|link)_', r'"arm/\1_', t),
        reversed_names,
        lambda t: re.sub(r'"joint_(\d)"', lambda m: f'"joint_{(int(m[1]) + 1) % 7}"', t),
    ],
)
@pytest.mark.parametrize("seed", range(5))
def test_other_names_are_a_note(rename: Callable[[str], str], seed: int) -> None:
    """Also where each name is now that of another joint."""
    text = random_tree(seed, 7, SIMPLE)
    result = compare_robots(rttrr_pin.load(text), rttrr_pin.load(rename(text)), STATES)
    assert result.passed and not result.mattering, result.summary()
    assert any("other names" in note for note in result.notes)


def turned(model: Model, i: int) -> Model:
    """Joint i counts the other way."""
    joints = list(model.joints)
    own = joints[i].limits
    joints[i] = replace(joints[i], axis=-joints[i].axis, limits=replace(own, lower=-own.upper, upper=-own.lower))
    for k, joint in enumerate(joints):
        if joint.mimic is not None and joint.mimic.joint == i:
            joints[k] = replace(joint, mimic=replace(joint.mimic, multiplier=-joint.mimic.multiplier))
    return replace(model, joints=tuple(joints), document=None)


def moved_frame(model: Model, i: int, along: float, turn: np.ndarray) -> Model:
    """Link i has its frame elsewhere on the joint's axis, its body and what it carries where they were."""
    R, p = turn, along * model.joints[i].axis
    own, link = model.joints[i], model.links[i]
    joints, links = list(model.joints), list(model.links)
    joints[i] = replace(own, R=own.R @ R, p=own.p + own.R @ p, axis=R.T @ own.axis)
    tensor = R.T @ link.inertia @ R
    links[i] = replace(link, com=R.T @ (link.com - p), inertia=(tensor + tensor.T) / 2)
    for k, joint in enumerate(joints):
        if joint.parent == i:
            joints[k] = replace(joint, R=R.T @ joint.R, p=R.T @ (joint.p - p))
    return replace(model, joints=tuple(joints), links=tuple(links), document=None)


@pytest.mark.one_in(3)
@pytest.mark.parametrize("case", range(12))
def test_other_directions_and_frames_are_the_same_motion(case: int) -> None:
    robot = robot_of(case)
    i = moving(robot.model)
    first = min(k for k, joint in enumerate(robot.model.joints) if joint.independent)
    other = turned(robot.model, first)
    other = moved_frame(other, i, 0.2, rotation((0.3, -0.4, 1.0)))
    result = compare_robots(robot, Robot(other), STATES)
    assert result.passed and not result.effects, result.summary()
    assert any(robot.model.joints[first].name in note for note in result.notes if "other direction" in note)
    assert any(robot.model.joints[i].name in note for note in result.notes if "other frames" in note)


@pytest.mark.one_in(3)
@pytest.mark.parametrize("kind", ["mass", "inertia", "damping"])
@pytest.mark.parametrize("case", [0, 3, 7, 9])
def test_a_difference_is_found_among_other_frames(kind: str, case: int) -> None:
    robot = robot_of(case)
    i = moving(robot.model)
    other = moved_frame(PLANTED[kind](robot.model, i), i, 0.2, rotation((0.3, -0.4, 1.0)))
    (own,) = compare_robots(robot, Robot(other), STATES).effects
    assert own.difference.kind == kind
    assert own.worst == pytest.approx(true_share(robot, PLANTED[kind](robot.model, i)), rel=1e-6, abs=1e-12)


def following(mimic: Mimic | None) -> Robot:
    rod = [Link(f"l{i}", 1.0 + i, np.array([0.3, 0.0, 0.1]), 0.1 * np.eye(3)) for i in range(3)]
    y = np.array([0.0, 1.0, 0.0])
    joints = [Joint(f"j{i}", CONTINUOUS, i - 1, p=np.array([0.3, 0, 0]), axis=y) for i in range(3)]
    joints[2] = replace(joints[2], mimic=mimic)
    return Robot(Model("m", Link("base"), tuple(rod), tuple(joints)))


@pytest.mark.parametrize(
    "pair", [(Mimic(0, 0.5), Mimic(0, -0.5, 0.1)), (Mimic(0, 0.5), None), (None, Mimic(1, 2.0, 0.3))]
)
def test_who_follows_whom_is_named(pair: tuple[Mimic | None, Mimic | None]) -> None:
    result = compare_robots(*map(following, pair), STATES)
    assert [(own.difference.kind, own.difference.joint) for own in result.effects] == [("mimic", "j2")]
    assert not result.passed and not result.remainder
    assert result.effects[0].matters


def test_who_leads_and_who_follows_may_be_exchanged() -> None:
    """Where the leader of one follows in the other, and where what follows a joint goes on to."""
    robot = following(Mimic(0, 0.5, 0.2))
    joints = list(robot.model.joints)
    joints[0], joints[2] = replace(joints[0], mimic=Mimic(2, 2.0, -0.4)), replace(joints[2], mimic=None)
    exchanged = Robot(replace(robot.model, joints=tuple(joints)))
    joints[0], joints[2] = robot.model.joints[0], replace(joints[2], mimic=Mimic(1, 2.0, 0.3))
    joints[0] = replace(joints[0], mimic=Mimic(1, 0.7))
    other = Robot(replace(robot.model, joints=tuple(joints)))
    for one, two in ((robot, exchanged), (exchanged, robot), (robot, other), (other, robot)):
        result = compare_robots(one, two, STATES)
        assert {own.difference.joint for own in result.effects} == {"j0", "j2"}
        assert not result.passed and not result.remainder


def test_joints_that_only_one_has_stand_still() -> None:
    robot = rttrr_pin.load("rttrr")
    result = compare_robots(robot, robot.with_locked({"joint_5": 0.0}), STATES)
    assert not result.passed and (result.only_a, result.only_b) == (("joint_5",), ())
    assert not result.mattering and not result.remainder


def test_six_digits_are_one_note() -> None:
    text = random_tree(5, 7, SIMPLE)
    printed = re.sub(r"-?\d+\.\d+", lambda m: f"{float(m[0]):.6g}", text)
    result = compare_robots(rttrr_pin.load(text), rttrr_pin.load(printed), STATES)
    assert result.passed and not result.effects and len(result.rounding) > 10
    assert "to the digits printed" in result.summary()
    assert result.rounding_effect is not None and 1e-9 < result.rounding_effect.worst < 1e-4


def test_six_decimals_are_one_note() -> None:
    """Of a small number that leaves few digits."""
    text = random_tree(5, 7, SIMPLE)
    printed = re.sub(r"-?\d+\.\d+", lambda m: f"{float(m[0]):.6f}", text)
    result = compare_robots(rttrr_pin.load(text), rttrr_pin.load(printed), STATES)
    assert result.passed and not result.effects


def test_limits_and_friction_that_take_no_part_are_told() -> None:
    text = rttrr_pin.load("rttrr").model.urdf
    other = text.replace('upper="0.32"', 'upper="0.3"').replace(
        '<limit lower="-0.08"', '<dynamics damping="3" friction="1"/><limit lower="-0.08"'
    )
    assert other.count("damping") == 1
    result = compare_robots(text, other, STATES)
    assert result.passed
    assert [own.difference.kind for own in result.effects] == ["damping", "friction", "upper limit"]
    taking = compare_robots(rttrr_pin.load(text, friction=True), rttrr_pin.load(other, friction=True), STATES)
    assert [own.difference.kind for own in taking.mattering] == ["damping", "friction"]


@pytest.mark.one_in(10)
@pytest.mark.parametrize("block", range(10))
def test_random_pairs_never_crash(block: int) -> None:
    """Also robots that have little in common; what is left is told."""
    for k in range(20):
        rng = np.random.default_rng([block, k])
        models = [rttrr_pin.load(random_tree(int(rng.integers(1000)), int(rng.integers(1, 7)))) for _ in "ab"]
        with suppress(InputError):  # no joint in common
            result = compare_robots(*models, n_states=int(rng.integers(1, 4)), seed=k)
            json.dumps(result.to_dict(), allow_nan=False)
            assert result.passed == ("PASS" in result.summary())


def test_robots_without_a_joint_in_common_are_unusable() -> None:
    still = Robot(Model("still", Link("base"), (), ()))
    with pytest.raises(InputError, match="no joint that moves"):
        compare_robots("rttrr", still)
    floating = rttrr_pin.load(random_tree(1, 1, ("floating",)))
    with pytest.raises(InputError, match="two descriptions of one robot"):
        compare_robots("rttrr", floating)


@pytest.fixture
def files(tmp_path: Path) -> tuple[str, str]:
    text = rttrr_pin.load("rttrr").model.urdf
    (tmp_path / "a.urdf").write_text(text)
    (tmp_path / "b.urdf").write_text(text.replace('value="3.75387"', 'value="3.9"'))
    return str(tmp_path / "a.urdf"), str(tmp_path / "b.urdf")


def test_the_command_says_what_the_function_says(files: tuple[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", *files, "--states", "50"]) == 1
    out = capsys.readouterr().out
    assert "mass of link_3" in out and "3.9" in out and "FAIL" in out
    assert main(["compare", *files, "--states", "50", "--json", "-"]) == 1
    data = json.loads(capsys.readouterr().out)
    result = compare_robots(*files, 50)
    assert data["differences"] == json.loads(json.dumps(result.to_dict()))["differences"]
    assert (data["schema"], data["passed"]) == (1, False)
    assert main(["compare", files[0], "rttrr"]) == 0
    assert main(["compare", files[0], "nowhere.urdf"]) == 2
    assert main(["compare", *files, "--json", files[1]]) == 2


def test_options_of_reading_go_for_both(files: tuple[str, str], capsys: pytest.CaptureFixture[str]) -> None:
    shares = []
    for words in ([], ["--gravity", "0,0,0"]):
        main(["compare", *files, "--json", "-", *words])
        shares.append(json.loads(capsys.readouterr().out)["differences"][0]["tau"]["rms"]["joint_2"])
    assert shares[0] != shares[1]


def test_one_state_and_many_have_the_same_verdict() -> None:
    robot = rttrr_pin.load("rttrr")
    other = Robot(PLANTED["mass"](robot.model, 2))
    results: list[Comparison] = [compare_robots(robot, other, n) for n in (1, 2, 300)]
    assert {own.mattering[0].difference.kind for own in results} == {"mass"}
    assert JointEffects() == robot.model.joints[0].effects


@pytest.mark.one_in(3)
@pytest.mark.parametrize("seed", range(10))
def test_all_differences_together_make_the_second_of_the_first(seed: int) -> None:
    """Also where the second is of another size, so that its rounding is more than that of the first."""
    text = random_tree(seed, 6, SIMPLE)
    heavy = re.sub(r'\b(value|i[xyz]{2})="([^"]*)"', lambda m: f'{m[1]}="{1e9 * float(m[2]):.17g}"', text)
    result = compare_robots(rttrr_pin.load(text), rttrr_pin.load(heavy), 20)
    assert result.mattering and not result.remainder
