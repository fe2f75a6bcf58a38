"""What the terms of the recursion are called, by function and by the expression as its code has it.

Where an expression has no name of its own, it is told by its letters and by the named expression around it. What is not
here at all is told by its code, so that the list of errors never waits for this table.
"""

from __future__ import annotations

from collections.abc import Iterable

CARRIED = "R.T @ (w_dot_p.cross(p) + w_p.cross(w_p.cross(p)) + v_dot_p)"

TERMS: dict[str, dict[str, str]] = {
    "rotation": {
        "IDENTITY - along": "1 - u u^T in Rodrigues' formula for the rotation about an axis u",
        "along + across * c + Matrix.skew(axis) * s": "Rodrigues' formula for the rotation about an axis u",
        "across * c": "the cosine term cos q (1 - u u^T) of the rotation about an axis u",
        "Matrix.skew(axis) * s": "the sine term sin q [u]x of the rotation about an axis u",
    },
    "quaternion_rotation": {
        "1 - (y * y + z * z) * 2": "entry R_xx = 1 - 2 (y y + z z) of the rotation of a quaternion",
        "(x * y - w * z) * 2": "entry R_xy = 2 (x y - w z) of the rotation of a quaternion",
        "(x * z + w * y) * 2": "entry R_xz = 2 (x z + w y) of the rotation of a quaternion",
        "(x * y + w * z) * 2": "entry R_yx = 2 (x y + w z) of the rotation of a quaternion",
        "1 - (x * x + z * z) * 2": "entry R_yy = 1 - 2 (x x + z z) of the rotation of a quaternion",
        "(y * z - w * x) * 2": "entry R_yz = 2 (y z - w x) of the rotation of a quaternion",
        "(x * z - w * y) * 2": "entry R_zx = 2 (x z - w y) of the rotation of a quaternion",
        "(y * z + w * x) * 2": "entry R_zy = 2 (y z + w x) of the rotation of a quaternion",
        "1 - (x * x + y * y) * 2": "entry R_zz = 1 - 2 (x x + y y) of the rotation of a quaternion",
    },
    "newton_euler": {
        "f[payload.link] += _in_link_frame(payload.f, payload, parents, joints, call)": "the force of the payload",
        "n[payload.link] += _in_link_frame(payload.n, payload, parents, joints, call)": "the moment of the payload",
        "-gravity": "gravity, which enters as an upward acceleration of the base,",
        "gravity": "the gravity vector",
        "f[parents[i]] += R_f": "the force that the link hands down to its parent, R f,",
        "n[parents[i]] += R_n": "the moment that the link hands down to its parent, R n + p x R f,",
    },
    "outwards": {
        "R.T @ w_p": "the parent's angular velocity R^T w_p",
        "carried": "the parent's angular velocity R^T w_p in w",
        "joint.w": "the joint's own angular velocity in w",
        "R.T @ w_dot_p": "the parent's angular acceleration R^T w_dot_p",
        "carried.cross(joint.w)": "the angular acceleration R^T w_p x w_joint of a joint that is carried round",
        "joint.w_dot": "the joint's own angular acceleration in w_dot",
        CARRIED: "the acceleration of the link's origin as a point of the parent",
        "w_dot_p.cross(p)": "the tangential acceleration w_dot_p x p of the link's origin",
        "w_p.cross(w_p.cross(p))": "the centripetal acceleration w_p x (w_p x p) of the link's origin",
        "w_p.cross(p)": "the inner product w_p x p of the centripetal acceleration of the link's origin",
        "v_dot_p": "the acceleration of the parent's origin, with gravity,",
        "carried.cross(joint.v) * 2": "the Coriolis acceleration 2 w x v",
        "carried.cross(joint.v)": "w x v of the Coriolis acceleration",
        "joint.w.cross(joint.v)": "the acceleration w_joint x v_joint of a joint that turns and slides at once",
        "joint.v_dot": "the joint's own linear acceleration in v_dot",
        "w_dot.cross(r_C)": "the tangential acceleration w_dot x r_C of the centre of mass",
        "w.cross(w.cross(r_C))": "the centripetal acceleration w x (w x r_C) of the centre of mass",
        "w.cross(r_C)": "the inner product w x r_C of the centripetal acceleration of the centre of mass",
        "v_dot": "the acceleration of the link's origin, with gravity, in that of the centre of mass",
        "body.I @ w_dot": "the inertial moment I w_dot",
        "w.cross(body.I @ w)": "the gyroscopic moment w x I w",
        "body.I @ w": "the angular momentum I w in the gyroscopic moment",
        "(joint.R, joint.p, body.r_C)": "the whole step outwards",
    },
    "inwards": {
        "joint.R @ f": "the force R f that goes to the parent",
        "joint.R @ n": "the moment R n that goes to the parent",
        "F": "the link's own net force F in f",
        "f_on": "the force from the children and the payload in f",
        "N": "the link's own net moment N in n",
        "n_on": "the moment from the children and the payload in n",
        "body.r_C.cross(F)": "the moment r_C x F of the net force about the link's origin",
        "joint.p.cross(R_f)": "the moment p x R f of the force that goes to the parent",
    },
    "dynamics": {
        "x": "what crosses the joint, in tau",
        "y": "what the joint itself takes (armature, friction), in tau",
    },
    "mimicked": {
        "q * multiplier": "multiplier times q in the coordinate of a mimic joint",
        "offset": "the offset in the coordinate of a mimic joint",
    },
    "joint_effects": {
        "a * arithmetic.number(effects.armature, 0.0)": "the armature times the acceleration",
        "v * arithmetic.number(effects.damping, 0.0)": "the viscous friction",
        "arithmetic.sign(signed) * arithmetic.number(effects.friction, 0.0)": "the Coulomb friction",
        "v * arithmetic.number(effects.damping, 0.0) + force": "the sum of armature and viscous friction",
        "arithmetic.sign(signed) * arithmetic.number(effects.friction, 0.0) + force": "the sum with Coulomb friction",
    },
    "generalised_forces": {
        "total[joint.mimic.joint][0]": "the force of the joint that a mimic joint follows",
        "forces[i][0] * multiplier": "the force of a mimic joint, times its multiplier,",
    },
    "Revolute.motion": {
        "w=u * v": "the angular velocity u v of the joint",
        "w_dot=u * a": "the angular acceleration u a of the joint",
        "body.R @ rotation(u, q, sincos)": "the rotation R_0 R(u, q) of the joint",
        "p=body.p": "the place of the joint",
    },
    "Revolute.driving_force": {"body.axis.dot(n)": "the driving moment u . n"},
    "Prismatic.motion": {
        "v=u * v": "the velocity u v of the joint",
        "v_dot=u * a": "the acceleration u a of the joint",
        "body.p": "the place p_0 of the joint at zero",
        "body.R @ (u * q)": "the slide R_0 u q of the joint",
    },
    "Prismatic.driving_force": {"body.axis.dot(f)": "the driving force u . f"},
    "Planar.motion": {
        "w=Vector(0, 0, w_z)": "the angular velocity of the planar joint",
        "w_dot=Vector(0, 0, w_dot_z)": "the angular acceleration of the planar joint",
        "v=Vector(v_x, v_y, 0)": "the velocity of the planar joint",
        "v_dot=Vector(a_x, a_y, 0)": "the linear acceleration of the planar joint",
        "body.R @ rotation(body.axis, theta, sincos)": "the rotation R_0 R(z, theta) of the planar joint",
        "body.p": "the place p_0 of the planar joint at zero",
        "body.R @ Vector(x, y, 0)": "the slide R_0 (x, y, 0) of the planar joint",
    },
    "Planar.driving_force": {
        "f.x": "the driving force along x",
        "f.y": "the driving force along y",
        "n.z": "the driving moment about z",
    },
    "Floating.motion": {
        "w=Vector(*v[3:])": "the angular velocity of the floating joint",
        "w_dot=Vector(*a[3:])": "the angular acceleration of the floating joint",
        "v=Vector(*v[:3])": "the velocity of the floating joint",
        "v_dot=Vector(*a[:3])": "the linear acceleration of the floating joint",
        "body.R @ quaternion_rotation(*q[3:])": "the rotation R_0 R(quaternion) of the floating joint",
        "body.p": "the place p_0 of the floating joint at zero",
        "body.R @ Vector(*q[:3])": "the place R_0 (x, y, z) of the floating joint",
    },
    "Floating.driving_force": {
        "*f": "the driving force, components of f,",
        "*n": "the driving moment, components of n,",
    },
    "Fixed.motion": {"p=body.p": "the place of the fixed joint"},
}

LETTERS: dict[str, str] = {
    "IDENTITY": "1",
    "along": "u u^T",
    "force": "what was added before",
    "R.T": "R^T",
    "joint.R": "R",
    "body.R": "R_0",
    "p": "p (from the parent's origin to the link's)",
    "r_C": "r_C (from the link's origin to its centre of mass)",
    "joint.p": "p (from the parent's origin to the link's)",
    "body.p": "p (from the parent's origin to the link's)",
    "body.r_C": "r_C (from the link's origin to its centre of mass)",
    "f": "the force f",
    "n": "the moment n",
    "(y * y + z * z) * 2": "2 (y y + z z)",
    "(x * x + z * z) * 2": "2 (x x + z z)",
    "(x * x + y * y) * 2": "2 (x x + y y)",
    "1": "1",
    **{f"{a} * {b}": f"{a} {b}" for a in "xyzw" for b in "xyzw"},
}
"""How an expression is written in a sentence, where it has no name."""

SENTENCES: dict[str, tuple[str, str]] = {
    "drop": ("{term} is left out{place}", "add {term}{place}"),
    "negate": ("{term} has the wrong sign{place}", "change the sign of {term}{place}"),
    "drop the sign of": ("{term} has the wrong sign{place}", "change the sign of {term}{place}"),
    "transpose": (
        "{term} is formed with {wrong} instead of {right}{place}",
        "form {term} with {right}, not {wrong}{place}",
    ),
    "turn the first term alone of": (
        "of the terms of {term}, R^T turns the first alone{place}",
        "turn the sum of all terms of {term}{place}",
    ),
    "do not turn": ("{term} is not turned by R^T{place}", "turn {term} by R^T with the other terms{place}"),
    "exchange operands of": (
        "{term} has the operands of its cross product exchanged{place}",
        "exchange the operands of the cross product in {term}{place}",
    ),
    "keep the last of": ("{term} lacks its outer w x{place}", "multiply twice by w x in {term}{place}"),
    "keep the diagonal of": (
        "{term} is without the products of inertia{place}",
        "take the whole tensor, with its products of inertia, for {term}{place}",
    ),
    "forget the factor of": ("{term} lacks its factor 2{place}", "multiply {term} by 2{place}"),
    "take z alone of": ("only the z component of {term} is used{place}", "use all three components of {term}{place}"),
    "take": ("{wrong} is used instead of {right} in {term}{place}", "use {right}, not {wrong}, in {term}{place}"),
}
"""For each operator what the program does, and what to do about it."""

UNKNOWN = ("`{statement}` is computed{place}", "compute what the recursion does{place}")
"""For an operator that is not among them."""


def named(function: str, expressions: Iterable[str]) -> tuple[str, str] | None:
    """The first of the expressions that has a name, and its name."""
    names = TERMS.get(function, {})
    return next(((text, names[text]) for text in expressions if text in names), None)
