"""MuJoCo as an oracle: its own numbers, its own reading of the file, and a gate that is neither tight nor blind."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

import rttrr_pin
from rttrr_pin import JointEffects, RandomPayload, Robot, Wrench
from rttrr_pin.core.joint import Joint, Limits, Mimic
from rttrr_pin.core.joints import REVOLUTE
from rttrr_pin.core.model import Link, Model
from rttrr_pin.errors import ImplementationError, ModelMismatchError
from rttrr_pin.implementations import make_implementation, registry
from rttrr_pin.implementations.mujoco import Mujoco
from rttrr_pin.implementations.mujoco_model import PREFIX
from rttrr_pin.validation import Sampler, validate
from rttrr_pin.validation.comparison import Run
from support.serial_chains import random_chain
from support.tampered import TAMPERED, with_joint, with_link
from support.tolerances import ROUNDING, WELL_BELOW, norm_error
from support.trees import random_tree


def worst_ratio(robot: Robot, n_states: int = 200, **options: Any) -> float:
    """The largest error / tolerance of the reference recursion against MuJoCo."""
    worst = validate(robot, "recursion", "mujoco", n_states, **options).worst
    assert worst is not None
    return worst.of_tolerance.value


@pytest.mark.one_in(3)
@pytest.mark.parametrize("sampling", ["uniform", "mixed", "large-velocities"])
@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("name", ["rttrr", "trr", "trtr", "trtrr", "trttr"])
def test_bundled_arms_agree(name: str, base: Any, sampling: str) -> None:
    assert worst_ratio(rttrr_pin.load(name, base=base), sampling=sampling, payload=RandomPayload()) <= WELL_BELOW


def test_awkward_chains_agree(robot: Robot) -> None:
    assert worst_ratio(robot, sampling="mixed") <= WELL_BELOW


@pytest.mark.one_in(6)
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_trees_of_all_joint_types_agree(seed: int, base: Any) -> None:
    """With fixed and massless links, followers before and behind those they follow, damping and friction."""
    robot = rttrr_pin.load(random_tree(seed, 3 + 2 * seed), base=base, friction=True)
    link = robot.link_names[seed % len(robot.link_names)]
    for axes in ("link", "base"):
        payload = Wrench((10.0, -20.0, 30.0), (1.0, 2.0, -3.0), link, axes)  # type: ignore[arg-type]
        assert worst_ratio(robot, 30, sampling="mixed", payload=payload) <= WELL_BELOW


def test_drives_are_added_by_our_rule() -> None:
    """MuJoCo's own friction is a constraint; the file's damping takes part only where it is asked for."""
    text = random_chain(4, ("revolute", "prismatic", "revolute")).replace(
        "</joint>", '<dynamics damping="3" friction="2"/></joint>'
    )
    for robot in (rttrr_pin.load(text), rttrr_pin.load(text, friction=True)):
        assert worst_ratio(robot) <= WELL_BELOW
    driven = rttrr_pin.load(text).with_joint_effects({"joint_2": JointEffects(armature=0.7, damping=0.2, friction=5.0)})
    assert worst_ratio(driven) <= WELL_BELOW


@pytest.mark.parametrize("gravity", [(0.0, 0.0, 0.0), (3.0, -2.0, 1.0)], ids=str)
def test_any_gravity(gravity: tuple[float, ...]) -> None:
    assert worst_ratio(rttrr_pin.load("rttrr", gravity=gravity)) <= WELL_BELOW


def test_a_robot_of_fixed_joints_alone() -> None:
    """No degree of freedom: MuJoCo has nothing to solve, and every flange still carries."""
    assert worst_ratio(rttrr_pin.load(random_chain(3, ("fixed", "fixed"))), 3, payload=RandomPayload()) <= WELL_BELOW


@pytest.mark.parametrize(
    "inertial",
    [
        "",
        '<inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>',
        '<inertial><mass value="-1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>',
        '<inertial><mass value="1"/><inertia ixx="1" ixy="0.1" ixz="0" iyy="1" iyz="0" izz="3"/></inertial>',
        '<inertial><mass value="1"/><inertia ixx="-1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>',
        '<inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1e-20" iyz="0" izz="1"/></inertial>',
    ],
    ids=["no inertial", "frame", "negative mass", "triangle", "negative moment", "rod"],
)
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_what_mujoco_would_refuse_or_alter_is_computed_as_written(inertial: str, base: Any) -> None:
    """Inverse dynamics is defined for any numbers; `inspect` says what is wrong with them."""
    head, tail = random_chain(7, ("revolute", "prismatic", "revolute")).split('<link name="link_2">')
    text = f'{head}<link name="link_2">{inertial}{tail[tail.index("</inertial>") + len("</inertial>") :]}'
    assert worst_ratio(rttrr_pin.load(text, base=base)) <= WELL_BELOW


def test_shapes_meshes_and_mujoco_s_own_section_are_left_out() -> None:
    text = random_chain(2, ("revolute", "revolute")).replace(
        '<link name="link_1">',
        '<link name="link_1"><collision><geometry><mesh filename="nowhere.stl"/></geometry></collision>'
        '<visual><geometry><box size="1 1 1"/></geometry></visual>',
    )
    text = text.replace("</robot>", '<mujoco><option><flag gravity="disable"/></option></mujoco></robot>')
    assert worst_ratio(rttrr_pin.load(text)) <= WELL_BELOW


@pytest.mark.parametrize("base", ["fixed", "floating"])
@pytest.mark.parametrize("root", ["world", "base"])
def test_names_that_mujoco_has_too(root: str, base: Any) -> None:
    """A root called world, and joints that are called as the parts of a planar one are."""
    text = random_chain(6, ("planar", "revolute", "revolute")).replace('"base"', f'"{root}"')
    text = text.replace("joint_2", "joint_1_TX")
    first = text.index("<axis")
    planar = f'{text[:first]}<axis xyz="0 0 1"/>{text[text.index("/>", first) + 2 :]}'
    assert worst_ratio(rttrr_pin.load(planar, base=base)) <= WELL_BELOW


def test_each_quantity_is_what_mujoco_s_functions_return(rttrr: Robot) -> None:
    """Read here once more, one state at a time: accelerations and wrenches of bodies as MuJoCo's manual has them."""
    states = Sampler(rttrr.model, seed=5).draw(0, 20)
    oracle = Mujoco(rttrr.model)
    got = oracle.evaluate(states).values
    model, data = oracle.compiled, mujoco.MjData(oracle.compiled)
    velocity, acceleration, tau = np.zeros(6), np.zeros(6), np.zeros(model.nv)
    for k in range(20):
        data.qpos, data.qvel, data.qacc = states.q[k], states.v[k], states.a[k]
        for step in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):
            step(model, data)
        mujoco.mj_rne(model, data, 1, tau)
        mujoco.mj_rnePostConstraint(model, data)
        assert norm_error(got["tau"][k], tau) == 0.0
        for i, name in enumerate(rttrr.link_names):
            body = model.body(PREFIX + name).id
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, body, velocity, 1)
            mujoco.mj_objectAcceleration(model, data, mujoco.mjtObj.mjOBJ_BODY, body, acceleration, 1)
            principal = data.ximat[body].reshape(3, 3).T @ data.xmat[body].reshape(3, 3)
            I, (w, _), (w_dot, v_dot) = model.body_inertia[body], np.split(velocity, 2), np.split(acceleration, 2)
            F = principal.T @ (model.body_mass[body] * v_dot)
            N = principal.T @ (I * w_dot + np.cross(w, I * w))
            f_world, turn = data.cfrc_int[body][3:], data.xmat[body].reshape(3, 3)
            at_origin = np.zeros(6)
            mujoco.mju_transformSpatial(
                at_origin, data.cfrc_int[body], 1, data.xpos[body], data.subtree_com[1], turn.ravel()
            )
            for key, theirs in (("F", F), ("N", N), ("f", turn.T @ f_world), ("n", at_origin[:3])):
                assert np.linalg.norm(got[key][k, i] - theirs) <= ROUNDING * np.linalg.norm(got[key][k])


def test_a_state_gives_the_same_bits_in_any_batch() -> None:
    robot = rttrr_pin.load(random_tree(5, 14), base="floating")
    sampler = Sampler(robot.model, seed=1, payload=RandomPayload(robot.link_names[-1]))
    oracle = make_implementation("mujoco", robot.model)
    together = sampler.draw(0, 33)
    whole = oracle.evaluate(together)
    for k in (0, 16, 32):
        alone = oracle.evaluate(sampler.draw(k, 1))
        for part, of_whole in ((alone.values, whole.values), (alone.allowance, whole.allowance)):
            assert part is not None and of_whole is not None
            for key, x in part.items():
                np.testing.assert_array_equal(x[0], of_whole[key][k])


@pytest.mark.one_in(3)
@pytest.mark.parametrize("number", ["mass", "com", "inertia", "p"])
@pytest.mark.parametrize("link", [0, 2, 4])
def test_an_error_of_1e_10_in_one_number_is_seen(
    rttrr: Robot, monkeypatch: pytest.MonkeyPatch, number: str, link: int
) -> None:
    """One mass, centre of mass, tensor or placement of ours altered by a part in 1e10, once MuJoCo's model is built."""
    model, changed = rttrr.model, {"mass", "com", "inertia"}
    if number in changed:
        body = replace(model.links[link], **{number: getattr(model.links[link], number) * (1 + 1e-10)})
        other = replace(model, links=(*model.links[:link], body, *model.links[link + 1 :]))
    else:
        joint = replace(model.joints[link], p=model.joints[link].p * (1 + 1e-10))
        other = replace(model, joints=(*model.joints[:link], joint, *model.joints[link + 1 :]))
    monkeypatch.setattr("rttrr_pin.implementations.mujoco_model._differences", lambda model, bodies: iter(()))
    no_effect = number == "p" and link == 0  # a height on the axis of joint 1 enters nothing
    assert validate(Robot(other), "recursion", "mujoco", 200).passed == no_effect


@pytest.mark.one_in(2)
@pytest.mark.parametrize("base", ["fixed", "floating"])
def test_an_error_of_1e_10_in_one_mass_of_a_tree_is_seen(base: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    model = rttrr_pin.load(random_tree(9, 20), base=base).model
    monkeypatch.setattr("rttrr_pin.implementations.mujoco_model._differences", lambda model, bodies: iter(()))
    for i, link in enumerate(model.links):
        if link.mass:
            heavier = replace(link, mass=link.mass * (1 + 1e-10))
            other = Robot(replace(model, links=(*model.links[:i], heavier, *model.links[i + 1 :])))
            run = Run.of(other, "recursion", "mujoco", 0, "uniform", None)
            batch = run.states.batch(0, 5)
            (differences,) = run.differences(batch, run.evaluate(batch))
            pairs = zip(run.comparisons[0].rows, differences, strict=True)
            failed = {(row.quantity, row.at) for row, one in pairs if one.of_tolerance.max() > 1.0}
            assert {("F", link.name), ("f", link.name)} <= failed


KNOWN = {case: pair for case, pair in TAMPERED.items() if case not in ("velocity", "name")} | {
    "parent": (lambda m: with_joint(m, parent=0), "joint 'joint_3': hangs on 'link_2', the file says 'link_1'"),
    "type": (lambda m: with_joint(m, type=REVOLUTE), "joint 'joint_3': made of .*SLIDE"),
    "joint": (lambda m: with_joint(m, name="joint_x"), "link 'link_3': carried by joint_3, the file says joint_x"),
    "link": (lambda m: with_link(m, name="link_x"), "links: base, .*link_3.* the file has .*link_x"),
}
"""As for Pinocchio; MuJoCo has no limit on rates."""


@pytest.mark.parametrize("case", KNOWN)
def test_a_model_that_differs_from_the_file_is_an_error_that_names_the_link(rttrr: Robot, case: str) -> None:
    tamper, named = KNOWN[case]
    with pytest.raises(ModelMismatchError, match=named) as caught:
        make_implementation("mujoco", tamper(rttrr.model))
    assert caught.value.library == "MuJoCo" and len(caught.value.differences) == 1


@pytest.mark.parametrize("mimic", [Mimic(0, -0.7, 0.2), Mimic(0, 0.7, 0.3), Mimic(1, 0.7, 0.2)], ids=str)
def test_a_misread_follower_is_an_error(mimic: Mimic) -> None:
    head, tail = random_chain(8, ("revolute", "prismatic", "revolute")).rsplit("</joint>", 1)
    model = rttrr_pin.load(f'{head}<mimic joint="joint_1" multiplier="0.7" offset="0.2"/></joint>{tail}').model
    make_implementation("mujoco", model)
    joints = (*model.joints[:2], replace(model.joints[2], mimic=mimic))
    with pytest.raises(ModelMismatchError, match="joint 'joint_3' mimic"):
        make_implementation("mujoco", replace(model, joints=joints))


def test_a_model_made_from_numbers_has_no_oracle() -> None:
    model = Model("numbers", Link("base"), (Link("arm", 1.0),), (Joint("j", REVOLUTE, limits=Limits()),))
    with pytest.raises(ImplementationError, match="made from numbers"):
        make_implementation("mujoco", model)


def test_what_mujoco_refuses_is_an_oracle_error(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("rttrr_pin.implementations.mujoco_model._bare", lambda urdf: "<robot><link/></robot>")
    with pytest.raises(ImplementationError, match="MuJoCo refuses the URDF of 'rttrr'"):
        make_implementation("mujoco", rttrr.model)


def test_a_missing_library_is_an_error_that_says_how_to_get_it(rttrr: Robot, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ModuleNotFoundError("No module named 'mujoco'", name="mujoco")

    monkeypatch.setattr(registry, "import_module", missing)
    with pytest.raises(
        ImplementationError, match=r"'mujoco', which is not installed: pip install 'rttrr-pin\[mujoco\]'"
    ):
        make_implementation("mujoco", rttrr.model)


def test_mujoco_leaves_no_log_behind(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: Any) -> None:
    """It warns of equal limits, on stderr and in a file in the current folder."""
    monkeypatch.chdir(tmp_path)
    text = random_chain(2, ("revolute",)).replace('lower="-2" upper="2"', 'lower="0.5" upper="0.5"')
    make_implementation("mujoco", rttrr_pin.load(text).model)
    assert not list(tmp_path.iterdir()) and not any(capfd.readouterr())


def test_the_allowance_holds_while_it_grows_with_depth_and_reach() -> None:
    """A long chain far from the world's origin, at high rates: what cancels is large, and so is what is allowed."""
    robot = rttrr_pin.load(random_chain(1, ("revolute", "prismatic") * 12), base="floating")
    assert worst_ratio(robot, 100, sampling="large-velocities") <= WELL_BELOW
