"""casadi-kin-dyn: Pinocchio's RNEA on CasADi's symbols."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from door import TREES, Adapter, Array, NotOfferedError, Robot, States, serve

ITS_GRAVITY = (0.0, 0.0, -9.81)
"""Pinocchio's default, which casadi-kin-dyn gives no way to change."""


class CasadiKinDyn(Adapter):
    packages = ("cmeel-casadi-kin-dyn", "pin", "cmeel-casadi")
    offers = TREES | {"floating"}
    call = "rnea = CasadiKinDyn(urdf).rnea(); rnea(q, v, a); many: rnea.map(N)"
    conventions = "continuous joints as (cos, sin), as joint_nq tells"

    def __init__(self, robot: Robot, real: Any) -> None:
        super().__init__(robot, real)
        from casadi_kin_dyn import CasadiKinDyn as Library

        if not np.array_equal(robot.gravity, ITS_GRAVITY):
            raise NotOfferedError(f"gravity other than {ITS_GRAVITY}")
        self.library = Library(robot.text, *((Library.JointType.FREE_FLYER,) if robot.floating else ()))
        self.order = [
            robot.joints[0] if name in ("floating_base_joint", "root_joint") else robot.joint(name)
            for name in list(self.library.joint_names())[1:]
        ]
        self.rnea = self.library.rnea()

    def inputs(self, states: States) -> Any:
        columns = []
        wide = self.library.nq() > sum(joint.q.stop - joint.q.start for joint in self.order)
        for joint in self.order:
            x = states.q[:, joint.q]
            columns.append(np.hstack([np.cos(x), np.sin(x)]) if wide and joint.type == "continuous" else x)
        q, v, a = (
            np.hstack(x) for x in (columns, *([x[:, joint.v] for joint in self.order] for x in (states.v, states.a)))
        )
        return tuple(np.asfortranarray(x.T) for x in (q, v, a))

    def run(self, inputs: Any) -> Any:
        return np.array(self.rnea(*inputs)).T

    def many(self, inputs: Any) -> Any:
        return np.array(self.rnea.map(inputs[0].shape[1])(*inputs)).T

    def results(self, raw: Any, states: States) -> Mapping[str, Array]:
        out, at = np.zeros((len(states), self.robot.nv)), 0
        for joint in self.order:
            width = joint.v.stop - joint.v.start
            out[:, joint.v], at = raw[:, at : at + width], at + width
        return {"tau": out}


if __name__ == "__main__":
    serve(CasadiKinDyn)
