"""What each parser of URDF does with a file: its rules as data, with their sources.

Only masses, inertias, joint types and limits are judged; meshes, materials and extensions are not. "Alter" means that
the parser's robot has other masses, inertias, degrees of freedom or limits than the file's. Pinocchio, MuJoCo, Drake
and yourdfpy are run by the tests and compared with these rules; Gazebo and KDL do not install from PyPI, and are judged
by their source alone.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass

from rttrr_pin.inspection import parser_inertia as inertia
from rttrr_pin.inspection import parser_joints as joints
from rttrr_pin.inspection.results import Behaviour, RuleMatch, Verdict
from rttrr_pin.urdf.document import UrdfDocument

Places = Callable[[UrdfDocument], Iterator[str]]


@dataclass(frozen=True)
class Rule:
    """What a parser does with something in a file.

    Attributes:
        id: stable, such as `"mujoco-triangle"`.
        parsers: those that have the rule.
        behaviour: what they do then.
        reason: the rule in a sentence.
        source: file and function of the parser that says so.
        places: the links or joints where it applies.
        at_worst: what they do at worst, where `behaviour` is "either".
    """

    id: str
    parsers: tuple[str, ...]
    behaviour: Behaviour
    reason: str
    source: str
    places: Places
    at_worst: Behaviour = Behaviour.REFUSE


PINOCCHIO, MUJOCO, DRAKE, GAZEBO, KDL, YOURDFPY = PARSERS = (
    "Pinocchio",
    "MuJoCo",
    "Drake",
    "Gazebo",
    "KDL",
    "yourdfpy",
)

URDFDOM = (PINOCCHIO, GAZEBO, KDL)
"""They parse with urdfdom."""

RULES = (
    Rule("urdfdom-limit", URDFDOM, Behaviour.REFUSE,
         "a revolute or prismatic joint has no <limit>",
         "urdfdom: urdf_parser/src/joint.cpp, parseJoint", joints.without_limit),
    Rule("urdfdom-effort", URDFDOM, Behaviour.REFUSE,
         "a <limit> has no effort or no velocity",
         "urdfdom: urdf_parser/src/joint.cpp, parseJointLimits", joints.without_effort),
    Rule("urdfdom-inertial", URDFDOM, Behaviour.ALTER,
         "a mass or moment with a blank behind it, or an inertial origin with a tab or line end, is dropped",
         "urdfdom: urdf_parser/src/link.cpp, parseInertial", inertia.unparsed),
    Rule("urdfdom-joint", URDFDOM, Behaviour.REFUSE,
         "a joint's vector has a tab or line end, or a limit, damping, friction or mimic a blank behind it",
         "urdfdom: urdf_parser/src/joint.cpp, parseJoint", joints.unparsed),
    Rule("pinocchio-sum", (PINOCCHIO,), Behaviour.ALTER,
         "a mass, with what is fixed to it, is below eps: its first moment is divided by eps instead of the mass",
         "pinocchio: include/pinocchio/spatial/inertia.hpp, InertiaTpl::__plus__", inertia.pinocchio_sum),
    Rule("pinocchio-mimic", (PINOCCHIO,), Behaviour.ALTER,
         "<mimic> is ignored unless mimic=True is passed: the joint moves by itself",
         "pinocchio: include/pinocchio/parsers/urdf.hpp, buildModel, argument mimic", joints.mimicking),
    Rule("mujoco-eigenvalue", (MUJOCO,), Behaviour.REFUSE,
         "a principal moment is below 1e-14 kg m^2 (mjEPS), and the inertia is not all zero",
         "mujoco: src/user/user_util.cc, mjuu_fullInertia", inertia.mujoco_eigenvalue),
    Rule("mujoco-triangle", (MUJOCO,), Behaviour.REFUSE,
         "the principal moments violate A + B >= C, in floating point and without a tolerance",
         "mujoco: src/user/user_objects.cc, mjCBody::Compile", inertia.mujoco_triangle),
    Rule("mujoco-rounding", (MUJOCO,), Behaviour.EITHER,
         "one of the two limits above is so near that the rounding of the diagonalisation decides",
         "mujoco: src/user/user_util.cc, mjuu_eig3", inertia.mujoco_rounding),
    Rule("mujoco-minimum", (MUJOCO,), Behaviour.REFUSE,
         "a moving link, with what is fixed to it, has a mass or a principal moment below 1e-15 (mjMINVAL)",
         "mujoco: src/user/user_model.cc, mjCModel::CheckBodyMassInertia", inertia.mujoco_minimum),
    Rule("mujoco-negative", (MUJOCO,), Behaviour.ALTER,
         "a negative mass, merged with other masses, becomes 0 (boundmass)",
         "mujoco: src/user/user_objects.cc, mjCBody::Compile", inertia.mujoco_negative),
    Rule("mujoco-massless-tensor", (MUJOCO,), Behaviour.ALTER,
         "the inertia of a fixed link with a mass below 1e-15 kg (mjMINVAL) is dropped",
         "mujoco: src/user/user_model.cc, mjCModel::FuseStatic", inertia.mujoco_massless_tensor),
    Rule("mujoco-geometry", (MUJOCO,), Behaviour.ALTER,
         "a link without <inertial> gets mass and inertia from its collision shapes, at 1000 kg/m^3",
         "mujoco: src/user/user_objects.cc, mjCBody::InertiaFromGeom", inertia.mujoco_geometry),
    Rule("mujoco-products", (MUJOCO,), Behaviour.EITHER,
         "before version 3.14, products of inertia below 1e-12 kg m^2 are dropped (kEigEPS)",
         "mujoco: src/user/user_util.cc, mjuu_eig3", inertia.mujoco_products, at_worst=Behaviour.ALTER),
    Rule("mujoco-rpy", (MUJOCO,), Behaviour.EITHER,
         "before version 3.14, the rpy of <inertial> is ignored: its tensor is taken in the axes of the link",
         "mujoco: src/user/user_objects.cc, mjCBody::Compile", inertia.mujoco_rpy, at_worst=Behaviour.ALTER),
    Rule("mujoco-fused", (MUJOCO,), Behaviour.EITHER,
         "from version 3.3.3 to 3.10, a fixed link that is turned, or whose principal axes are, is merged wrongly",
         "mujoco: src/user/user_objects.cc, mjCBody::AccumulateInertia", inertia.mujoco_fused,
         at_worst=Behaviour.ALTER),
    Rule("mujoco-mimic", (MUJOCO,), Behaviour.ALTER,
         "<mimic> is ignored before version 3.13, and then a soft constraint: the joint can move by itself",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Joint", joints.mimicking),
    Rule("mujoco-range", (MUJOCO,), Behaviour.ALTER,
         "a range of length zero, or with an end left out, is no limit: the joint moves freely",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Joint", joints.degenerate_range),
    Rule("mujoco-continuous", (MUJOCO,), Behaviour.EITHER,
         "before version 4, the range of a continuous joint limits it",
         "mujoco: src/xml/xml_urdf.cc, mjXURDF::Joint", joints.continuous_range, at_worst=Behaviour.ALTER),
    Rule("mujoco-floating", (MUJOCO,), Behaviour.REFUSE,
         "a floating joint hangs on a link that moves",
         "mujoco: src/user/user_model.cc, mjCModel::CopyTree", joints.floating_on_moving),
    Rule("drake-inertia", (DRAKE,), Behaviour.ALTER,
         "an impossible inertia is replaced by that of a ball of water of the same mass, with a warning",
         "drake: multibody/parsing/detail_common.cc, ParseSpatialInertia", inertia.drake_inertia),
    Rule("drake-rounding", (DRAKE,), Behaviour.EITHER,
         "the triangle inequality is violated by just Drake's tolerance, 16 eps max(1 kg m^2, trace / 2)",
         "drake: multibody/tree/rotational_inertia.cc, AreMomentsOfInertiaNearPositiveAndSatisfyTriangleInequality",
         inertia.drake_rounding, at_worst=Behaviour.ALTER),
    Rule("drake-mass", (DRAKE,), Behaviour.ALTER,
         "a negative mass, or none with an inertia, becomes 1 kg of water, with a warning",
         "drake: multibody/parsing/detail_common.cc, ParseSpatialInertia", inertia.drake_mass),
    Rule("drake-floating", (DRAKE,), Behaviour.ALTER,
         "a floating joint is left out, with a warning: the link is free in the world, whatever its parent",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::ParseJoint", joints.floating),
    Rule("drake-mimic", (DRAKE,), Behaviour.REFUSE,
         "a fixed joint has a <mimic>",
         "drake: multibody/parsing/detail_urdf_parser.cc, UrdfParser::ParseMimicTag", joints.fixed_mimic),
    Rule("gazebo-inertia", (GAZEBO,), Behaviour.REFUSE,
         "a link, with what is fixed to it, has an invalid inertia (LINK_INERTIA_INVALID)",
         "sdformat: src/Link.cc, Link::Load; gz-math: MassMatrix3::IsValid", inertia.gazebo_inertia),
    Rule("gazebo-rounding", (GAZEBO,), Behaviour.EITHER,
         "the triangle inequality is violated by just gz-math's tolerance, 5 eps trace, or by its rounding",
         "gz-math: MassMatrix3::ValidMoments and MassMatrix3::PrincipalMoments", inertia.gazebo_rounding),
    Rule("gazebo-massless", (GAZEBO,), Behaviour.ALTER,
         "a link without mass, with what is fixed to it, is left out with all links beyond it, with a warning",
         "sdformat: src/parser_urdf.cc, CreateSDF", inertia.gazebo_massless),
    Rule("gazebo-empty", (GAZEBO,), Behaviour.REFUSE,
         "the root link, with what is fixed to it, has no mass: with it all links are left out, and a model needs one",
         "sdformat: src/parser_urdf.cc, CreateSDF; src/Model.cc, MODEL_WITHOUT_LINK", inertia.gazebo_empty),
    Rule("gazebo-joint", (GAZEBO,), Behaviour.ALTER,
         "planar and floating joints are left out: the link is free in the world",
         "sdformat: src/parser_urdf.cc, CreateJoint", joints.planar_or_floating),
    Rule("kdl-root", (KDL,), Behaviour.ALTER,
         "the inertia of the root link is left out, with a warning",
         "kdl_parser: src/kdl_parser.cpp, treeFromUrdfModel", inertia.kdl_root),
    Rule("kdl-joint", (KDL,), Behaviour.ALTER,
         "planar and floating joints become fixed, with a warning",
         "kdl_parser: src/kdl_parser.cpp, toKdl", joints.planar_or_floating),
    Rule("kdl-mimic", (KDL,), Behaviour.ALTER,
         "<mimic> is ignored: the joint moves by itself",
         "kdl_parser: src/kdl_parser.cpp, toKdl", joints.mimicking),
    Rule("yourdfpy-joint", (YOURDFPY,), Behaviour.ALTER,
         "planar and floating joints do not move, and a planar one counts as two degrees of freedom",
         "yourdfpy: urdf.py, URDF._forward_kinematics_joint and URDF.num_dofs", joints.planar_or_floating),
)  # fmt: skip


def verdicts(document: UrdfDocument) -> tuple[Verdict, ...]:
    """What each parser does with a file."""
    matches = [
        (rule, RuleMatch(rule.id, rule.behaviour, name, rule.reason, rule.source))
        for rule in RULES
        for name in rule.places(document)
    ]
    return tuple(_verdict(parser, [match for match in matches if parser in match[0].parsers]) for parser in PARSERS)


def _verdict(parser: str, matches: Sequence[tuple[Rule, RuleMatch]]) -> Verdict:
    return Verdict(parser, _worst({rule for rule, _ in matches}), tuple(match for _, match in matches))


def _worst(rules: Collection[Rule]) -> Behaviour:
    """What a parser does under these rules; "either" only where the open ones may make it worse than the others."""
    order = list(Behaviour)
    sure = max((rule.behaviour for rule in rules if rule.behaviour is not Behaviour.EITHER), key=order.index,
               default=Behaviour.ACCEPT)  # fmt: skip
    may = max((rule.at_worst for rule in rules if rule.behaviour is Behaviour.EITHER), key=order.index, default=sure)
    return Behaviour.EITHER if order.index(may) > order.index(sure) else sure
