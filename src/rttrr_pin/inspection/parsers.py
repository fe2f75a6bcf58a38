"""What each parser of URDF does with a file: its rules as data, with their sources.

Only masses, inertias, joint types and limits are judged; meshes, materials and extensions are not. "Alter" means that
the parser's robot has other masses, inertias, degrees of freedom or limits than the file's. Pinocchio, MuJoCo, Drake
and yourdfpy are run by the tests and compared with these rules; Gazebo and KDL do not install from PyPI, and are judged
by their source alone.
"""

from __future__ import annotations

from collections.abc import Collection

from rttrr_pin.inspection import parser_rules as rules
from rttrr_pin.inspection.drake_faults import DRAKE_RULES
from rttrr_pin.inspection.parser_faults import FAULT_RULES
from rttrr_pin.inspection.rule import (
    DRAKE,
    GAZEBO,
    KDL,
    MEANING,
    MUJOCO,
    PARSERS,
    PINOCCHIO,
    URDFDOM,
    YOURDFPY,
    Behaviour,
    Rule,
    RuleMatch,
    Verdict,
    inertials,
    joints,
    where,
)
from rttrr_pin.inspection.structure import LIMITED
from rttrr_pin.urdf.document import UrdfDocument, UrdfJoint

__all__ = ["MEANING", "PARSERS", "RULES", "Behaviour", "RuleMatch", "Verdict", "verdicts"]


def _is_range(joint: UrdfJoint) -> bool:
    """Whether it has both limits, the lower below the upper."""
    limits = joint.limits
    return {"lower", "upper"} <= limits.keys() and limits["lower"] < limits["upper"]


MIMICKING = joints(lambda joint: joint.moves and joint.mimic is not None)

PLANAR_OR_FLOATING = joints(lambda joint: joint.type in ("planar", "floating"))

RULES = (
    Rule("urdfdom-limit", URDFDOM, Behaviour.REFUSE,
         "a revolute or prismatic joint has no <limit>",
         "urdfdom: urdf_parser/src/joint.cpp, parseJoint",
         joints(lambda joint: joint.type in LIMITED and joint.limit is None)),
    Rule("urdfdom-effort", URDFDOM, Behaviour.REFUSE,
         "a <limit> has no effort or no velocity, before version 1.2 of the format",
         "urdfdom: urdf_parser/src/joint.cpp, parseJointLimits", rules.without_effort),
    Rule("urdfdom-inertial", URDFDOM, Behaviour.ALTER,
         "with a blank behind a mass or a moment, or a tab or line end in its origin, an <inertial> or its tensor is 0",
         "urdfdom: urdf_parser/src/link.cpp, parseInertial", inertials(rules.unparsed_inertial)),
    Rule("urdfdom-joint", URDFDOM, Behaviour.REFUSE,
         "a joint's vector has a tab or line end, or a limit, damping, friction or mimic a blank behind it",
         "urdfdom: urdf_parser/src/joint.cpp, parseJoint", joints(rules.unparsed_joint)),
    Rule("pinocchio-sum", (PINOCCHIO,), Behaviour.ALTER,
         "a mass, with what is fixed to it, is below eps: its first moment is divided by eps instead of the mass",
         "pinocchio: include/pinocchio/spatial/inertia.hpp, InertiaTpl::__plus__", rules.pinocchio_sum),
    Rule("pinocchio-mimic", (PINOCCHIO,), Behaviour.ALTER,
         "<mimic> is ignored unless mimic=True is passed: the joint moves by itself",
         "pinocchio: include/pinocchio/parsers/urdf.hpp, buildModel, argument mimic", MIMICKING),
    Rule("mujoco-eigenvalue", (MUJOCO,), Behaviour.REFUSE,
         "a principal moment is below 1e-14 kg m^2 (mjEPS), and the inertia is not all zero",
         "mujoco: src/user/user_util.cc, mjuu_fullInertia", where(rules.mujoco_test, "eigenvalue")),
    Rule("mujoco-triangle", (MUJOCO,), Behaviour.REFUSE,
         "the principal moments violate A + B >= C, in floating point and without a tolerance",
         "mujoco: src/user/user_objects.cc, mjCBody::Compile", where(rules.mujoco_test, "triangle")),
    Rule("mujoco-rounding", (MUJOCO,), Behaviour.EITHER,
         "one of the two limits above is so near that the rounding of the diagonalisation decides",
         "mujoco: src/user/user_util.cc, mjuu_eig3", where(rules.mujoco_test, "rounding")),
    Rule("mujoco-minimum", (MUJOCO,), Behaviour.REFUSE,
         "a moving link, with what is fixed to it, has a mass or a principal moment below 1e-15 (mjMINVAL)",
         "mujoco: src/user/user_model.cc, mjCModel::CheckBodyMassInertia", rules.mujoco_minimum),
    Rule("mujoco-negative", (MUJOCO,), Behaviour.ALTER,
         "a negative mass, merged with other masses, becomes 0 (boundmass)",
         "mujoco: src/user/user_objects.cc, mjCBody::Compile", rules.mujoco_negative),
    Rule("mujoco-massless-tensor", (MUJOCO,), Behaviour.ALTER,
         "the inertia of a fixed link with a mass below 1e-15 kg (mjMINVAL) is dropped",
         "mujoco: src/user/user_model.cc, mjCModel::FuseStatic", rules.mujoco_massless_tensor),
    Rule("mujoco-geometry", (MUJOCO,), Behaviour.ALTER,
         "a link without <inertial> gets mass and inertia from its collision shapes, at 1000 kg/m^3",
         "mujoco: src/user/user_objects.cc, mjCBody::InertiaFromGeom", rules.mujoco_geometry),
    Rule("mujoco-products", (MUJOCO,), Behaviour.EITHER,
         "before version 3.14, products of inertia below 1e-12 kg m^2 are dropped (kEigEPS)",
         "mujoco: src/user/user_util.cc, mjuu_eig3",
         inertials(rules.mujoco_products, moving=True), at_worst=Behaviour.ALTER),
    Rule("mujoco-rpy", (MUJOCO,), Behaviour.EITHER,
         "before version 3.14, the rpy of <inertial> is ignored: its tensor is taken in the axes of the link",
         "mujoco: src/user/user_objects.cc, mjCBody::Compile",
         inertials(lambda inertial: rules.differ(inertial.inertia, inertial.tensor), moving=True),
         at_worst=Behaviour.ALTER),
    Rule("mujoco-fused", (MUJOCO,), Behaviour.EITHER,
         "from version 3.3.3 to 3.10, a fixed link that is turned, or whose principal axes are, is merged wrongly",
         "mujoco: src/user/user_objects.cc, mjCBody::AccumulateInertia", rules.mujoco_fused,
         at_worst=Behaviour.ALTER),
    Rule("mujoco-mimic", (MUJOCO,), Behaviour.ALTER,
         "<mimic> is ignored before version 3.13, and then a soft constraint: the joint can move by itself",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Joint", MIMICKING),
    Rule("mujoco-range", (MUJOCO,), Behaviour.ALTER,
         "a range of length zero, or with an end left out, is no limit: the joint moves freely",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Joint",
         joints(lambda joint: joint.type in LIMITED and joint.limit is not None and not _is_range(joint))),
    Rule("mujoco-continuous", (MUJOCO,), Behaviour.EITHER,
         "before version 4, the range of a continuous joint limits it",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Joint",
         joints(lambda joint: joint.type == "continuous" and _is_range(joint)), at_worst=Behaviour.ALTER),
    Rule("mujoco-floating", (MUJOCO,), Behaviour.REFUSE,
         "a floating joint hangs on a link that moves",
         "mujoco: src/user/user_model.cc, mjCModel::CopyTree", rules.floating_on_moving),
    Rule("drake-inertia", (DRAKE,), Behaviour.ALTER,
         "an impossible inertia is replaced by that of a ball of water of the same mass, with a warning",
         "drake: multibody/parsing/detail_common.cc, ParseSpatialInertia", where(rules.drake_test, "invalid")),
    Rule("drake-rounding", (DRAKE,), Behaviour.EITHER,
         "the triangle inequality is violated by just Drake's tolerance, 16 eps max(1 kg m^2, trace / 2)",
         "drake: multibody/tree/rotational_inertia.cc, AreMomentsOfInertiaNearPositiveAndSatisfyTriangleInequality",
         where(rules.drake_test, "rounding"), at_worst=Behaviour.ALTER),
    Rule("drake-mass", (DRAKE,), Behaviour.ALTER,
         "a negative mass, or none with an inertia, becomes 1 kg of water, with a warning",
         "drake: multibody/parsing/detail_common.cc, ParseSpatialInertia",
         inertials(lambda inertial: inertial.mass.exact < 0 or (inertial.mass.exact == 0 and inertial.tensor.any()))),
    Rule("drake-floating", (DRAKE,), Behaviour.ALTER,
         "a floating joint is left out, with a warning: the link is free in the world, whatever its parent",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::ParseJoint",
         joints(lambda joint: joint.type == "floating")),
    Rule("drake-mimic", (DRAKE,), Behaviour.REFUSE,
         "a fixed joint has a <mimic>",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::ParseMimicTag",
         joints(lambda joint: not joint.moves and joint.mimic is not None)),
    Rule("gazebo-inertia", (GAZEBO,), Behaviour.REFUSE,
         "a link, with what is fixed to it, has an invalid inertia (LINK_INERTIA_INVALID)",
         "sdformat: src/Link.cc, Link::Load; gz-math: MassMatrix3::IsValid", where(rules.gazebo_test, "invalid")),
    Rule("gazebo-rounding", (GAZEBO,), Behaviour.EITHER,
         "the triangle inequality is violated by just gz-math's tolerance, 5 eps trace, or by its rounding",
         "gz-math: MassMatrix3::ValidMoments and MassMatrix3::PrincipalMoments", where(rules.gazebo_test, "rounding")),
    Rule("gazebo-massless", (GAZEBO,), Behaviour.ALTER,
         "a link without mass, with what is fixed to it, is left out with all links beyond it, with a warning",
         "sdformat: src/parser_urdf.cc, CreateSDF", rules.gazebo_massless),
    Rule("gazebo-empty", (GAZEBO,), Behaviour.REFUSE,
         "the root link, with what is fixed to it, has no mass: with it all links are left out, and a model needs one",
         "sdformat: src/parser_urdf.cc, CreateSDF; src/Model.cc, MODEL_WITHOUT_LINK", rules.gazebo_empty),
    Rule("gazebo-joint", (GAZEBO,), Behaviour.ALTER,
         "planar and floating joints are left out: the link is free in the world",
         "sdformat: src/parser_urdf.cc, CreateJoint", PLANAR_OR_FLOATING),
    Rule("kdl-root", (KDL,), Behaviour.ALTER,
         "the inertia of the root link is left out, with a warning",
         "kdl_parser: src/kdl_parser.cpp, treeFromUrdfModel", rules.kdl_root),
    Rule("kdl-joint", (KDL,), Behaviour.ALTER,
         "planar and floating joints become fixed, with a warning",
         "kdl_parser: src/kdl_parser.cpp, toKdl", PLANAR_OR_FLOATING),
    Rule("kdl-mimic", (KDL,), Behaviour.ALTER,
         "<mimic> is ignored: the joint moves by itself",
         "kdl_parser: src/kdl_parser.cpp, toKdl", MIMICKING),
    Rule("yourdfpy-joint", (YOURDFPY,), Behaviour.ALTER,
         "planar and floating joints do not move, and a planar one counts as two degrees of freedom",
         "yourdfpy: urdf.py, URDF._forward_kinematics_joint and URDF.num_dofs", PLANAR_OR_FLOATING),
    *FAULT_RULES,
    *DRAKE_RULES,
)  # fmt: skip


def verdicts(document: UrdfDocument) -> tuple[Verdict, ...]:
    """What each parser does with a file."""
    names = {rule: tuple(dict.fromkeys(rule.places(document))) for rule in RULES}

    def verdict(parser: str) -> Verdict:
        own = [rule for rule in RULES if parser in rule.parsers and names[rule]]
        matches = (
            RuleMatch(rule.id, rule.behaviour, name, rule.reason, rule.source) for rule in own for name in names[rule]
        )
        return Verdict(parser, _worst(own), tuple(matches))

    return tuple(map(verdict, PARSERS))


def _worst(rules: Collection[Rule]) -> Behaviour:
    """What a parser does under these rules; "either" only where the open ones may make it worse than the others."""
    order = list(Behaviour)
    sure = max((rule.behaviour for rule in rules if rule.behaviour is not Behaviour.EITHER), key=order.index,
               default=Behaviour.ACCEPT)  # fmt: skip
    may = max((rule.at_worst for rule in rules if rule.behaviour is Behaviour.EITHER), key=order.index, default=sure)
    return Behaviour.EITHER if order.index(may) > order.index(sure) else sure
