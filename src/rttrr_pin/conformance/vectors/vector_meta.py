"""What a folder of vectors says of itself: the robot, its conventions, its levels, and the SHA-256 of each file."""

from __future__ import annotations

import hashlib
import json
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rttrr_pin.conformance.levels import ProvenCase
from rttrr_pin.conformance.vectors.mjcf_file import Mjcf
from rttrr_pin.conformance.vectors.vector_tables import ends_of, widths
from rttrr_pin.core.joint import EFFECTS, Joint, JointEffects
from rttrr_pin.core.model import Model
from rttrr_pin.errors import InputError, LoadWarning, RttrrError
from rttrr_pin.implementations.text_results import column_names
from rttrr_pin.loading import load
from rttrr_pin.robot import Robot
from rttrr_pin.urdf.document import UrdfDocument
from rttrr_pin.version import __version__

FORMAT, SCHEMA = "rttrr-pin vectors", 1

LICENCE = "CC-BY-4.0"
"""Of the data of the bundled robots; a user's own robot is the user's."""

MANIFEST, META, URDF, MJCF, STATES, TRUTH = (
    "manifest.json",
    "meta.json",
    "robot.urdf",
    "robot.xml",
    "states.csv",
    "truth.csv",
)

CONVENTIONS = {
    "units": "SI: m, rad, s, kg, N, N m",
    "parameters": "the doubles nearest to the decimals of robot.urdf; rotations, axes, tensors follow without rounding",
    "joint types": "q of a revolute or continuous joint is its angle, of a prismatic one its length",
    "floating base": "q is x, y, z and the quaternion; v is the twist of the root link in its own frame, linear before "
    "angular; a holds the time derivatives of the components of v",
    "quaternion": "x, y, z, w",
    "rotation of a quaternion": "row by row 1-2(yy+zz), 2(xy-wz), 2(xz+wy); 2(xy+wz), 1-2(xx+zz), 2(yz-wx); "
    "2(xz-wy), 2(yz+wx), 1-2(xx+yy); it is not divided by its length",
    "gravity": "the field in base axes; the base accelerates upwards",
    "tau": "driving force of each rate: the component of n or f along it, plus armature a + damping v + friction "
    "sign(v); a joint that follows another adds its own times its multiplier to the other's",
    "F": "net force on the link, mass times acceleration of its centre of mass, gravity included; in the link frame",
    "N": "net moment on the link about its centre of mass; in the link frame",
    "f": "force that the parent link exerts on the link; in the link frame",
    "n": "moment that the parent link exerts on the link, about the origin of the link frame; in the link frame",
    "link frame": "URDF's child-link frame of the joint that carries the link",
    "payload": "what the robot exerts on its surroundings, at the origin of the link",
    "root link": "where the base is fixed it is not counted, and its inertia does not enter",
    "enclosure": "each true value lies between lower and upper, both included; proven in interval arithmetic",
}


def sha256(content: str | bytes) -> str:
    """Of a file's bytes, or of a text in UTF-8."""
    return hashlib.sha256(content.encode() if isinstance(content, str) else content).hexdigest()


def meta_of(
    name: str, cases: Sequence[ProvenCase], payload: Sequence[str], mjcf: Mjcf, seed: int, own: bool
) -> dict[str, Any]:
    """What meta.json says, without the sums of the other files.

    Args:
        name: the robot's.
        cases: its levels, in the order of the rows.
        payload: the links that payloads act at.
        mjcf: the robot as MJCF.
        seed: that the states were drawn with.
        own: whether the robot is a user's own, so that the licence is not ours to say.
    """
    model = cases[0].robot.model
    levels, row = [], 0
    for case in cases:
        states = len(case.batch)
        levels.append(
            {
                "id": case.level.id,
                "asks": case.level.sentence,
                "states": states,
                "first_row": row,
                "bits": int(case.enclosures.bits.max()),
                "tight": bool(case.enclosures.tight.all()),
                "payload": bool(case.batch.loads),
                "widths": widths(*ends_of(case.enclosures)),
            }
        )
        row += states
    names = column_names(model)
    return {
        "format": FORMAT,
        "schema": SCHEMA,
        "robot": name,
        "licence": "that of the robot" if own else LICENCE,
        "made_by": f"rttrr-pin {__version__}",
        "seed": seed,
        "base": "floating" if model.floating else "fixed",
        "gravity": model.gravity.tolist(),
        "quaternion": "x, y, z, w",
        "payload": [{"link": link, "axes": "link"} for link in payload],
        "joints": [_joint(joint, model, i) for i, joint in enumerate(model.joints)],
        "order": {key: [x.partition("_")[2] for x in names[key]] for key in ("q", "v", "a", "tau")},
        "links": list(model.link_names),
        "levels": levels,
        "mjcf": {"file": MJCF if mjcf.text else None, "reason": mjcf.reason, "equal_to_urdf": mjcf.proven},
        "conventions": CONVENTIONS,
    }


def _joint(joint: Joint, model: Model, i: int) -> dict[str, Any]:
    effects = {key: float(getattr(joint.effects, key)) for key in EFFECTS}
    parent = model.root if joint.parent < 0 else model.links[joint.parent]
    own = {"name": joint.name, "link": model.links[i].name, "parent": parent.name, "type": joint.type.name}
    follows = {} if joint.mimic is None else {"follows": model.joints[joint.mimic.joint].name}
    return own | {"moves": joint.independent} | follows | effects


def robot_of(urdf: str, meta: dict[str, Any]) -> Robot:
    """The robot that a folder of vectors is about: its URDF with the base, gravity and joint effects of meta.json.

    Raises:
        InputError: joints and links are not in the order that meta.json has.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", LoadWarning)  # of friction in the file, which meta.json decides on
        robot = load(urdf, gravity=meta["gravity"], base=meta["base"])
    moving = {joint.name for joint in robot.model.joints if joint.nv}
    effects = {x["name"]: JointEffects(*(x[key] for key in EFFECTS)) for x in meta["joints"] if x["name"] in moving}
    robot = robot.with_joint_effects({name: own for name, own in effects.items() if own != JointEffects()})
    names = column_names(robot.model)
    for key in ("q", "v"):
        got, wanted = [x.partition("_")[2] for x in names[key]], meta["order"][key]
        if got != wanted:
            raise InputError(
                f"{key} of {meta['robot']!r} is {', '.join(wanted)}, and the URDF has {', '.join(got)}: vectors are of "
                "robots as their file has them; load the URDF without other options than base, gravity and friction"
            )
    if list(robot.model.link_names) != meta["links"]:
        raise InputError(
            f"the links of {meta['robot']!r} are {', '.join(meta['links'])}, and the URDF has "
            f"{', '.join(robot.model.link_names)}: vectors are of robots as their file has them; load the URDF"
        )
    return robot


def read_files(folder: Path, meta: dict[str, Any]) -> dict[str, bytes]:
    """The bytes of each file that meta.json names, which must say of all of them and of all rows what they are.

    Raises:
        InputError: a file has no SHA-256 or another, or rows of a level do not begin where those of the one before end.
    """
    path = folder / META
    lacking = [name for name in (URDF, STATES, TRUTH) if not isinstance(meta["sha256"].get(name), str)]
    if lacking:
        raise InputError(f"{path} has no SHA-256 of {', '.join(lacking)}: fetch or write it again")
    row = 0
    for level in meta["levels"]:
        if level["first_row"] != row:
            raise InputError(
                f"{path}: level {level['id']} begins at row {level['first_row']}, expected {row}: fetch or write it "
                "again"
            )
        row += level["states"]
    return {name: read_file(folder / name, own) for name, own in meta["sha256"].items()}


def read_robot(path: Path, content: bytes, meta: dict[str, Any]) -> Robot:
    """`robot_of` what stands in a file.

    Raises:
        InputError: it is no URDF, or not that of meta.json.
    """
    try:
        urdf = content.decode()
        if not urdf.lstrip("\ufeff \t\r\n").startswith("<"):  # a name or a path would be loaded in its place
            raise InputError("is no URDF")
        return robot_of(urdf, meta)
    except (RttrrError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: {error}; fetch or write it again") from error


def described(robot: Robot, name: str) -> tuple[str, dict[str, Any]]:
    """The URDF of a robot, and as much of meta.json as `robot_of` takes.

    Raises:
        InputError: the robot has no URDF.
    """
    model = robot.model
    if not isinstance(model.document, UrdfDocument):
        raise InputError(f"robot {model.name!r} was made from numbers and has no URDF: load it from a file")
    names = column_names(model)
    return model.urdf, {
        "robot": name,
        "base": "floating" if model.floating else "fixed",
        "gravity": model.gravity.tolist(),
        "joints": [_joint(joint, model, i) for i, joint in enumerate(model.joints)],
        "order": {key: [x.partition("_")[2] for x in names[key]] for key in ("q", "v")},
        "links": list(model.link_names),
    }


def read_json(path: Path) -> dict[str, Any]:
    """A file of the format.

    Raises:
        InputError: it is missing, no JSON, or of another format or schema.
    """
    try:
        data = json.loads(read_file(path))
    except ValueError as error:
        raise InputError(f"{path} is no JSON: {error}; fetch or write it again") from None
    if not isinstance(data, dict) or data.get("format") != FORMAT:
        raise InputError(f"{path} is no {path.name} of {FORMAT}: name a folder that `rttrr-pin vectors` wrote")
    if data.get("schema") != SCHEMA:
        raise InputError(f"{path} has schema {data.get('schema')}, expected {SCHEMA}: install the rttrr-pin it is from")
    return data


def read_file(path: Path, sum: str | None = None) -> bytes:
    """The bytes of a file of a folder.

    Raises:
        InputError: it cannot be read, or its SHA-256 is another.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}; name a folder of vectors") from error
    if sum is not None and sha256(content) != sum:
        raise InputError(
            f"{path} has SHA-256 {sha256(content)}, expected {sum}: it was altered since it was written; fetch or "
            "write it again"
        )
    return content
