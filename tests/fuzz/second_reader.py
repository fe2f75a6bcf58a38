"""What a URDF says, read a second time: by another XML parser (expat), in rationals, with none of the package's code.

It is as short as it can be, since it must be right: it knows no fixes and no hints, only which numbers a file holds and
which of them the format defines where they are left out (origin 0, multiplier 1, limits 0).
"""

from __future__ import annotations

import math
import re
import sys
from collections.abc import Iterator
from fractions import Fraction
from typing import Any
from xml.etree import ElementTree as ET
from xml.parsers import expat

sys.set_int_max_str_digits(0)  # numbers of any length are read exactly

EPS = sys.float_info.epsilon
WORD = re.compile(r"([+-]?)([0-9]+)?(?:\.([0-9]*))?(?:[eE]([+-]?[0-9]+))?")
FOREIGN = ("gazebo", "transmission", "ros2_control", "sensor", "plugin")
TENSOR = (("ixx", 0, 0), ("ixy", 0, 1), ("ixz", 0, 2), ("iyy", 1, 1), ("iyz", 1, 2), ("izz", 2, 2))
ATTRIBUTES = {
    "origin": {"xyz", "rpy"},
    "mass": {"value"},
    "inertia": {name for name, _, _ in TENSOR},
    "axis": {"xyz"},
    "parent": {"link"},
    "child": {"link"},
}
Floats = list[float]

FIFTH_EDITION = re.compile(
    r"""<!--.*?-->|"[^"]*"|'[^']*'|"""
    "([\u2070-\u218f\u2c00-\u2fef\u3001-\ud7ff\uf900-\ufdcf\ufdf0-\ufffc\U00010000-\U000effff])",
    re.DOTALL,
)
"""Letters that XML 1.0 allows in names since its fifth edition, outside of comments and values."""


COMMENT, DECLARATION = re.compile("<!--.*?-->", re.DOTALL), re.compile(r"<\?xml\b.*?\?>", re.DOTALL)
"""What is no part of the tree: what stands in it does not matter."""


class UnreadableError(Exception):
    """The text says nothing that a strict reader may accept."""


def exact(word: str) -> float:
    """The float64 nearest to a decimal numeral."""
    match = WORD.fullmatch(word)
    if not match or not (match[2] or match[3]):
        raise UnreadableError(f"{word[:40]!r} is no number")
    digits, shift = (match[2] or "") + (match[3] or ""), int(match[4] or 0) - len(match[3] or "")
    whole = int(digits)
    if whole == 0:
        return 0.0
    if abs(shift) > 5000 + len(digits):
        raise UnreadableError(f"{word[:40]!r} is out of range")
    value = Fraction(whole) * Fraction(10) ** shift * (-1 if match[1] == "-" else 1)
    try:
        nearest = float(value)
    except OverflowError:
        nearest = math.inf
    if nearest == 0.0 or math.isinf(nearest):
        raise UnreadableError(f"{word[:40]!r} is out of range")
    return nearest


def numbers(element: Any, name: str, count: int, default: str | None = None) -> Floats:
    text = default if element is None else element.get(name, default)
    if text is None:
        raise UnreadableError(f"no {name}")
    words = [word for word in re.split("[ \t\r\n]", text) if word]
    if len(words) != count:
        raise UnreadableError(f"{name} has {len(words)} words")
    return [exact(word) for word in words]


def only(parent: Any, tag: str) -> Any:
    """The one child of that name, whatever its case or namespace, or several that are equal; None if there is none."""
    found = [child for child in parent if local(child).lower() == tag]
    if len({content(child) for child in found}) > 1 or any(child.tag != tag for child in found):
        raise UnreadableError(f"<{local(parent)}> holds {[child.tag for child in found]}")
    if found and tag in ATTRIBUTES and not whole(found[0]):
        raise UnreadableError(f"<{tag}> has {sorted(found[0].attrib)}")
    return found[0] if found else None


def content(element: Any) -> Any:
    return element.tag, tuple(sorted(element.attrib.items())), tuple(map(content, element))


def whole(element: Any) -> bool:
    """Whether no attribute of it stands in the place of one that is not there."""
    got = {name for name in element.attrib if not name.startswith("xmlns")}
    for other, name in (("iyx", "ixy"), ("izx", "ixz"), ("izy", "iyz")):
        if other in got and name in got and numbers(element, other, 1) == numbers(element, name, 1):
            got.remove(other)
    there = ATTRIBUTES[element.tag] & got
    more = {other for other in got - there if not any(other in name for name in there)}  # yz, where iyz is there
    return not more or (element.tag in ("origin", "axis", "parent", "child") and ATTRIBUTES[element.tag] <= got)


def local(element: Any) -> str:
    return str(element.tag).rpartition(":")[2]


def parse(data: bytes) -> Any:
    """The root, by expat.

    Expat knows the letters of XML 1.0's fourth edition, libxml2 those of the fifth: where it stumbles over a letter
    that only the fifth allows in names, it is shown an underscore there.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise UnreadableError("not UTF-8") from None
    try:
        return _parse(text)
    except UnreadableError:
        return _parse(FIFTH_EDITION.sub(lambda match: "_" if match[1] else match[0], text))


def _parse(text: str) -> Any:
    """The root; a document type is refused. What stands behind the root's end is no part of it, well-formed or not."""
    tree, parser, closed = ET.TreeBuilder(), expat.ParserCreate("utf-8"), False
    path: list[str] = []

    def refuse(*_: Any) -> None:
        raise UnreadableError("document type")

    def start(tag: str, attributes: dict[str, str]) -> None:
        path.append(tag)
        tree.start(tag, attributes)

    def end(_: str) -> None:
        nonlocal closed
        tree.end(path.pop())
        closed = not path

    parser.StartDoctypeDeclHandler = refuse
    parser.StartElementHandler = start
    parser.EndElementHandler = end
    try:
        parser.Parse(DECLARATION.sub("", COMMENT.sub("", text)).encode(), True)
        return tree.close()
    except expat.ExpatError as error:
        if closed:
            return tree.close()
        raise UnreadableError(f"not XML: {error}") from None
    except ValueError as error:
        raise UnreadableError(f"not XML: {error}") from None


def differences(data: bytes, model: Any) -> list[str]:
    """What an accepted model says otherwise than the text; one line each."""
    try:
        return list(_differences(parse(data), model))
    except UnreadableError as error:
        return [f"accepted, but {error}"]


def _differences(root: Any, model: Any) -> Iterator[str]:
    links = {link.get("name"): link for link in root if link.tag == "link"}
    joints = {joint.get("name"): joint for joint in root if joint.tag == "joint"}
    yield from _nothing_dropped(root, links, joints)
    got = {link.name: link for link in (model.root, *model.links)}
    name = root.get("name", "")
    if root.tag != "robot" or (name if name.strip() else "robot") != model.name:
        yield f"robot {model.name!r}, the text has <{root.tag} name={root.get('name')!r}>"
    if set(got) != set(links) or len(model.links) + 1 != len(links):
        yield f"links {sorted(got)}, the text has {sorted(map(str, links))}"
        return
    if sorted(joint.name for joint in model.joints) != sorted(map(str, joints)):
        yield f"joints {[joint.name for joint in model.joints]}, the text has {sorted(map(str, joints))}"
        return
    for name, link in links.items():
        yield from (f"link {name!r} {line}" for line in _link(link, got[name]))
    for i, joint in enumerate(model.joints):
        xml = joints[joint.name]
        ends = [only(xml, tag).get("link") for tag in ("parent", "child")]
        parent = model.root if joint.parent < 0 else model.links[joint.parent]
        if ends != [parent.name, model.links[i].name]:
            yield f"joint {joint.name!r}: between {parent.name!r} and {model.links[i].name!r}, the text has {ends}"
        yield from (f"joint {joint.name!r} {line}" for line in _joint(xml, joint, model, joints))


def _nothing_dropped(root: Any, links: Any, joints: Any) -> Iterator[str]:
    """Every element that is a link or joint by its content, wherever it stands, was counted; names were not shared."""
    for tag, parts, known in (("link", {"inertial"}, links), ("joint", {"parent", "child"}, joints)):
        count = 0
        waiting = [root]
        while waiting:
            element = waiting.pop()
            waiting += [child for child in element if local(child) not in FOREIGN]
            holds = {local(child) for child in element}
            count += local(element).lower() == tag and (element in list(root) or bool(parts & holds))
        if count != len(known):
            yield f"{len(known)} {tag}s, the text has {count}"
    for part in ("mass", "inertia", "axis", "mimic"):
        if any(local(child).lower() == part for child in root):
            yield f"<{part}> stands in <robot>"


def _link(xml: Any, link: Any) -> Iterator[str]:
    inertial = only(xml, "inertial")
    if inertial is None:
        yield from _same("mass", [link.mass], [0.0])
        return
    origin, tensor = only(inertial, "origin"), only(inertial, "inertia")
    yield from _same("mass", [link.mass], numbers(only(inertial, "mass"), "value", 1))
    yield from _same("centre of mass", link.com, numbers(origin, "xyz", 3, "0 0 0"))
    rpy = numbers(origin, "rpy", 3, "0 0 0")
    wanted = [[0.0] * 3 for _ in range(3)]
    for name, i, j in TENSOR:
        wanted[i][j] = wanted[j][i] = numbers(tensor, name, 1)[0]
    if any(rpy):
        R = rotation(rpy)
        wanted = product(product(R, wanted), [list(column) for column in zip(*R, strict=True)])
        size = max(abs(x) for row in wanted for x in row)
        yield from _near("tensor", link.inertia.ravel(), flat(wanted), 64 * size)
    else:
        yield from _same("tensor", link.inertia.ravel(), flat(wanted))


def _joint(xml: Any, joint: Any, model: Any, joints: Any) -> Iterator[str]:
    kind, origin = xml.get("type"), only(xml, "origin")
    if joint.type.name != kind:
        yield f"type {joint.type.name}, the text has {kind}"
    yield from _same("origin", joint.p, numbers(origin, "xyz", 3, "0 0 0"))
    rpy = numbers(origin, "rpy", 3, "0 0 0")
    R = flat(rotation(rpy))
    yield from _near("rotation", joint.R.ravel(), R, 8.0) if any(rpy) else _same("rotation", joint.R.ravel(), R)
    if kind in ("revolute", "continuous", "prismatic"):
        x = [Fraction(value) for value in numbers(only(xml, "axis"), "xyz", 3)]
        largest = max(abs(value) for value in x)
        length = math.sqrt(sum(float(value / largest) ** 2 for value in x))
        yield from _near("axis", joint.axis, [float(value / largest) / length for value in x], 4.0)
    if kind not in ("fixed", "floating"):
        yield from _limits(kind, only(xml, "limit"), joint.limits)
    dynamics = only(xml, "dynamics")
    for name in ("damping", "friction"):
        yield from _same(name, [getattr(joint.effects, name)], numbers(dynamics, name, 1, "0"))
    if kind != "fixed" and only(xml, "mimic") is not None:
        yield from _mimic(xml, joint, model, joints)
    elif joint.mimic is not None:
        yield "follows another joint, which the text does not say"


def _limits(kind: str, limit: Any, got: Any) -> Iterator[str]:
    wanted = {"lower": -math.inf, "upper": math.inf, "velocity": math.inf, "effort": math.inf}
    if limit is not None:
        if kind in ("revolute", "prismatic"):
            wanted["lower"] = wanted["upper"] = 0.0
        for name in wanted:
            if name in limit.attrib and not (kind == "continuous" and name in ("lower", "upper")):
                wanted[name] = numbers(limit, name, 1)[0]
        for name, value in wanted.items():
            yield from _same(f"{name} limit", [getattr(got, name)], [value])


def _mimic(xml: Any, joint: Any, model: Any, joints: Any) -> Iterator[str]:
    """Chains of followers are multiplied out."""
    multiplier, offset, seen = Fraction(1), Fraction(0), 0
    size = Fraction(0)
    while (mimic := only(xml, "mimic")) is not None and seen <= len(joints):
        own, add = (
            Fraction(numbers(mimic, name, 1, default)[0]) for name, default in (("multiplier", "1"), ("offset", "0"))
        )
        multiplier, offset, size = multiplier * own, multiplier * add + offset, size + abs(multiplier * add)
        xml, seen = joints[mimic.get("joint")], seen + 1
    if seen > len(joints) or joint.mimic is None or model.joints[joint.mimic.joint].name != xml.get("name"):
        yield f"follows {joint.mimic}, the text has {xml.get('name')!r}"
        return
    got = joint.mimic
    if abs(Fraction(got.multiplier) - multiplier) > (seen - 1) * Fraction(EPS) * abs(multiplier):
        yield f"multiplier {got.multiplier!r}, the text has {float(multiplier)!r}"
    if abs(Fraction(got.offset) - offset) > 2 * (seen - 1) * Fraction(EPS) * size:
        yield f"offset {got.offset!r}, the text has {float(offset)!r}"


def rotation(rpy: Floats) -> list[Floats]:
    """R_z(yaw) R_y(pitch) R_x(roll)."""
    (cr, cp, cy), (sr, sp, sy) = map(math.cos, rpy), map(math.sin, rpy)
    return product(
        product([[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]], [[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]]),
        [[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]],
    )


def product(a: list[Floats], b: list[Floats]) -> list[Floats]:
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def flat(a: list[Floats]) -> Floats:
    return [x for row in a for x in row]


def _same(what: str, got: Any, wanted: Floats) -> Iterator[str]:
    if [float(x) for x in got] != wanted:
        yield f"{what} {[float(x) for x in got]}, the text has {wanted}"


def _near(what: str, got: Any, wanted: Floats, size: float) -> Iterator[str]:
    if not all(abs(float(x) - y) <= size * EPS for x, y in zip(got, wanted, strict=True)):
        yield f"{what} {[float(x) for x in got]}, the text has {wanted}"
