"""The oracle computes from Pinocchio's own numbers, and on the model that the file describes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

from rttrr_pin import Robot
from rttrr_pin.errors import ModelMismatchError, OracleError, UnknownNameError
from rttrr_pin.model import Joint, Limits, Link, Model
from rttrr_pin.oracles import make_oracle
from rttrr_pin.validate import Sampler
from tolerances import ROUNDING, norm_error


def with_link(model: Model, **changes: Any) -> Model:
    links = list(model.links)
    links[2] = replace(links[2], **changes)
    return replace(model, links=tuple(links))


def with_joint(model: Model, **changes: Any) -> Model:
    joints = list(model.joints)
    joints[2] = replace(joints[2], **changes)
    return replace(model, joints=tuple(joints))


TAMPERED: dict[str, tuple[Any, str]] = {
    "mass": (lambda m: with_link(m, mass=m.links[2].mass * (1 + 1e-12)), "link 'link_3' mass"),
    "com": (lambda m: with_link(m, com=m.links[2].com + [0, 1e-12, 0]), "link 'link_3' centre of mass"),
    "inertia": (lambda m: with_link(m, inertia=m.links[2].inertia * (1 + 1e-9)), "link 'link_3' inertia"),
    "placement": (lambda m: with_joint(m, p=m.joints[2].p + [0, 0, 1e-12]), "joint 'joint_3' placement p"),
    "turned": (lambda m: with_joint(m, R=np.diag([1.0, -1.0, -1.0])), "joint 'joint_3' placement R"),
    "axis": (lambda m: with_joint(m, axis=-m.joints[2].axis), "joint 'joint_3' axis"),
    "lower": (lambda m: with_joint(m, limits=replace(m.joints[2].limits, lower=-9.0)), "joint 'joint_3' lower limit"),
    "upper": (lambda m: with_joint(m, limits=replace(m.joints[2].limits, upper=9.0)), "joint 'joint_3' upper limit"),
    "velocity": (lambda m: with_joint(m, limits=replace(m.joints[2].limits, velocity=9.0)), "joint 'joint_3' velocity"),
    "effort": (lambda m: with_joint(m, limits=replace(m.joints[2].limits, effort=9.0)), "joint 'joint_3' effort"),
    "name": (lambda m: with_joint(m, name="joint_x"), "moving joints: joint_1"),
}


@pytest.mark.parametrize("case", TAMPERED)
def test_a_model_that_differs_from_the_file_is_an_error_that_names_the_link(rttrr: Robot, case: str) -> None:
    """Shown by altering one number of ours while Pinocchio reads the file as it is."""
    tamper, named = TAMPERED[case]
    with pytest.raises(ModelMismatchError, match=named) as caught:
        make_oracle("pinocchio", tamper(rttrr.model))
    assert len(caught.value.differences) == 1


def test_the_untampered_model_is_accepted(robot: Robot) -> None:
    assert make_oracle("pinocchio", robot.model).version == pin.__version__


def test_a_model_made_from_numbers_has_no_oracle() -> None:
    model = Model("numbers", Link("base"), (Link("arm", 1.0),), (Joint("j", "revolute", limits=Limits()),))  # type: ignore[arg-type]
    with pytest.raises(OracleError, match="made from numbers"):
        make_oracle("pinocchio", model)


def test_what_pinocchio_refuses_is_an_oracle_error() -> None:
    """A revolute joint without limits: URDF wants them, dynamics do not need them."""
    import rttrr_pin

    text = (
        '<robot name="x"><link name="a"/><link name="b"/><joint name="j" type="revolute"><parent link="a"/>'
        '<child link="b"/><axis xyz="0 0 1"/></joint></robot>'
    )
    with pytest.raises(OracleError, match="Pinocchio refuses"):
        make_oracle("pinocchio", rttrr_pin.load(text).model)


def test_unknown_oracle_lists_the_known_ones(rttrr: Robot) -> None:
    with pytest.raises(UnknownNameError, match="pinocchio"):
        make_oracle("pinochio", rttrr.model)


def test_each_quantity_is_what_pinocchio_leaves_in_data(rttrr: Robot) -> None:
    """Read here once more, one state at a time, in the words of Pinocchio's manual."""
    states = Sampler(rttrr.model, seed=5).draw(0, 20)
    oracle = make_oracle("pinocchio", rttrr.model)
    got = oracle.evaluate(states.q, states.v, states.a).wrenches
    model = pin.buildModelFromXML(rttrr.model.urdf)
    data = model.createData()
    for k in range(20):
        assert norm_error(got.tau[k], pin.rnea(model, data, states.q[k], states.v[k], states.a[k])) == 0.0
        for i in range(5):
            j = i + 1
            np.testing.assert_array_equal(got.f[k, i], data.f[j].linear)
            np.testing.assert_array_equal(got.n[k, i], data.f[j].angular)
            inertia = model.inertias[j]
            to_com = pin.SE3(np.eye(3), inertia.lever)
            v, a = to_com.actInv(data.v[j]), to_com.actInv(data.a_gf[j])
            central = pin.Inertia(inertia.mass, np.zeros(3), inertia.inertia)
            net = central * a + v.cross(central * v)
            assert norm_error(got.F[k, i], net.linear) <= ROUNDING
            assert norm_error(got.N[k, i], net.angular) <= ROUNDING
