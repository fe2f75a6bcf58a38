"""Damage to URDF texts: of bytes, of attributes, of structure."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from typing import Any
from xml.etree import ElementTree as ET

REFUSED_NUMBERS = (
    "nan", "NaN", "inf", "-inf", "Infinity", "INF", "1e400", "-1e400", "1e-400", "4e-324e", "0x1", "0x1p3", "1,5",
    "1.5kg", "90deg", "1_0", "1e", "--1", "+-1", "1e1.5", ".", "e5", "-", "+", "1d5", "\u0661\u0662", "\uff11",
    "1\u00a02", "1\u20032", "\u00bd", "\u00b2", "1e99999999999999999999", "-1e-99999999999", "${m}", "$(arg)", "None",
    "null", "true", "1/2", "0b1", "0o7", "1j", "1;2",
)  # fmt: skip
TAKEN_NUMBERS = (
    "0", "-0", "+0", "-0.0", "1e-310", "4.9e-324", "2.2250738585072014e-308", "1.7976931348623157e308", "1e300",
    "-1e300", "1e160", "1e-160", "+.5", "5.", "1E+2", "1e-7", "0.1", "00012.500", "3.141592653589793", "0.1e1",
    "1e22", "9007199254740993", "0.30000000000000004", "7.2057594037927933e16", "1e0000002", "123456789.125",
)  # fmt: skip
NAMES = (
    *("", " ", "base", "universe", "world", "root_joint", "a/b", "a b", "\u00e9\u4e2d", "&amp;", "&quot;", "&#10;"),
    *("x" * 5000, "1", "tool"),
)
TAGS = (
    "robot", "link", "joint", "inertial", "mass", "inertia", "origin", "axis", "limit", "mimic", "parent", "child",
    "dynamics", "visual", "gazebo", "group", "Link", "x:link",
)  # fmt: skip
ATTRIBUTE = re.compile(r"(?<![\w:])([\w:]+)\s*=\s*(\"[^\"]*\"|'[^']*')")
DOCTYPES = (
    '<!DOCTYPE robot [<!ENTITY a "b">]>',
    "<!DOCTYPE robot>",
    '<!DOCTYPE robot SYSTEM "file:///etc/passwd">',
    '<!DOCTYPE robot [<!ENTITY a SYSTEM "file:///etc/passwd">]>',
    '<!DOCTYPE robot [<!ENTITY % p SYSTEM "http://127.0.0.1:9/x">%p;]>',
    "<!DOCTYPE robot ["
    + '<!ENTITY a0 "lol">'
    + "".join(f'<!ENTITY a{i + 1} "{f"&a{i};" * 10}">' for i in range(12))
    + "]>",
    '<!DOCTYPE robot [<!ATTLIST mass value CDATA "7">]>',
)
INSERTED = (
    *(
        "<",
        ">",
        '"',
        "&",
        "]]>",
        "<!--",
        "-->",
        "<![CDATA[x]]>",
        "<?p i?>",
        "\0",
        "\ufeff",
        "\x85",
        "&#0;",
        "&a0;",
        "0",
        " ",
    ),
    *(
        "&#x110000;",
        "<x:y/>",
        "<link/>",
        "stray text",
        "<!DOCTYPE robot>",
        "\u20ac",
    ),  # expat knows no names beyond U+FFFF
    *("\n" * 500, "<a>" * 300, "9" * 3000, "-" * 2000, "<!--" * 500),
)
Mutation = Callable[[str, random.Random], str]


def span(text: str, rng: random.Random, longest: int = 200) -> tuple[int, int]:
    start = rng.randrange(len(text) + 1)
    return start, min(len(text), start + int(longest ** rng.random()))


def flip_byte(text: str, rng: random.Random) -> str:
    data = bytearray(text.encode(errors="surrogateescape"))
    for _ in range(rng.choice((1, 1, 3, 20))):
        if data:
            data[rng.randrange(len(data))] = rng.choice((rng.randrange(256), 0, 0xFF, ord("<"), ord('"'), ord("&")))
    return data.decode(errors="surrogateescape")


def insert(text: str, rng: random.Random) -> str:
    at = rng.randrange(len(text) + 1)
    new = rng.choice(INSERTED)
    return text[:at] + new + text[at:]


def delete(text: str, rng: random.Random) -> str:
    start, end = span(text, rng)
    return text[:start] + text[end:]


def duplicate(text: str, rng: random.Random) -> str:
    start, end = span(text, rng, 600)
    return text[:end] + text[start:end] * rng.choice((1, 1, 2, 50)) + text[end:]


def truncate(text: str, rng: random.Random) -> str:
    start, end = sorted((rng.choice((0, rng.randrange(len(text) + 1))), rng.randrange(len(text) + 1)))
    return text[start:end]


def swap_spans(text: str, rng: random.Random) -> str:
    (a, b), (c, d) = sorted((span(text, rng), span(text, rng)))
    return text if b > c else text[:a] + text[c:d] + text[b:c] + text[a:b] + text[d:]


def doctype(text: str, rng: random.Random) -> str:
    head = rng.choice(DOCTYPES)
    entity = rng.choice(("&a;", "&a12;", "&a3;", ""))
    text = (
        text.replace('name="', f'name="{entity}', 1) if rng.random() < 0.5 else text.replace(">\n", f">{entity}\n", 1)
    )
    at = text.find("<robot")
    return text[: max(at, 0)] + head + text[max(at, 0) :]


def declaration(text: str, rng: random.Random) -> str:
    encoding = rng.choice(("utf-8", "UTF-16", "latin-1", "ISO-8859-1", "EBCDIC-CP-US", "nope", "ascii", "utf-7", ""))
    return f'<?xml version="{rng.choice(("1.0", "1.1", "2"))}" encoding="{encoding}"?>' + re.sub(
        r"<\?xml.*?\?>", "", text
    )


def attribute(text: str, rng: random.Random) -> str:
    """One attribute gets another value, name or twin, or goes."""
    found = list(ATTRIBUTE.finditer(text))
    if not found:
        return text
    match = rng.choice(found)
    name, value = match[1], match[2][1:-1]
    kind = rng.random()
    if kind < 0.6:
        new = f'{name}="{_value(name, value, rng)}"'
    elif kind < 0.7:
        new = ""
    elif kind < 0.78:
        new = match[0] + " " + match[0]
    elif kind < 0.9:
        other = rng.choice(
            (name.upper(), name[1:], name + "s", name[::-1], "x:" + name, "xml:" + name, rng.choice(found)[1])
        )
        new = f'{other}="{value}"'
    else:
        new = f'{name}="{rng.choice(found)[2][1:-1]}"'
    return text[: match.start()] + new + text[match.end() :]


def _value(name: str, value: str, rng: random.Random) -> str:
    if name in ("name", "link", "joint", "type"):
        return rng.choice((*NAMES, value + " ", value.upper(), "fixed", "planar", "revolut", "spherical", "continuous"))
    words = value.split() or [""]
    number = rng.choice(REFUSED_NUMBERS if rng.random() < 0.4 else TAKEN_NUMBERS)
    if rng.random() < 0.3:
        number = repr(rng.uniform(-3, 3) * 10.0 ** rng.randrange(-5, 4))
    if rng.random() < 0.03:
        number = rng.choice(
            (
                "9" * 5000,
                "9" * 200_000 + "x",
                "0." + "3" * 20000,
                "1" + "0" * 400,
                "0." + "0" * 400 + "1",
                "-" * 3000,
                "0" * 9000 + "2",
            )
        )
    words[rng.randrange(len(words))] = number
    kind = rng.random()
    if kind < 0.05:
        words = words[:-1]
    elif kind < 0.1:
        words.append(number)
    return rng.choice((" ", " ", " ", "  ", "\t", "\n", "\u00a0", ",")).join(words)


def structure(text: str, rng: random.Random) -> str:
    """One element goes, comes twice, moves, or is called otherwise."""
    try:
        root = ET.fromstring(text)
    except (ET.ParseError, ValueError):
        return text
    parents = {child: parent for parent in root.iter() for child in parent}
    if not parents:
        return text
    pick = rng.choice(list(parents))
    rng.choice(STRUCTURAL)(root, parents, pick, rng)
    return ET.tostring(root, encoding="unicode")


def _drop(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    parents[pick].remove(pick)


def _twin(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    parents[pick].insert(rng.randrange(len(parents[pick]) + 1), pick)


def _move(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    inside = set(pick.iter())
    target = rng.choice([element for element in root.iter() if element not in inside])
    parents[pick].remove(pick)
    target.insert(rng.randrange(len(target) + 1), pick)


def _rename(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    tag = pick.tag
    pick.tag = rng.choice(
        (*TAGS, tag + "s", tag[:-1] or "x", tag.upper(), "{urn:x}" + tag, "{http://www.ros.org/wiki/xacro}" + tag)
    )


def _wrap(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    wrapper = ET.Element(rng.choice(TAGS[:-1]))
    at = list(parents[pick]).index(pick)
    parents[pick][at] = wrapper
    wrapper.append(pick)


def _reroute(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    """A joint hangs on, or carries, or follows, another: loops, two roots, links out of reach."""
    names = [element.get("name", "") for element in root if element.tag in ("link", "joint")]
    ends = [element for element in root.iter() if element.tag in ("parent", "child", "mimic")]
    if ends and names:
        end = rng.choice(ends)
        end.set("joint" if end.tag == "mimic" else "link", rng.choice(names))


def _text(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    pick.text = rng.choice(("1.5", "text", " \n", "&"))


def _comment(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    at = rng.choice((pick, root))
    at.insert(0, rng.choice((ET.Comment(" <link name='no'/> "), ET.ProcessingInstruction("p", "<joint/>"))))


def _shuffle(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    children = list(root)
    rng.shuffle(children)
    root[:] = children


def _follow(root: Any, parents: Any, pick: Any, rng: random.Random) -> None:
    joints = [element for element in root if element.tag == "joint"]
    if joints:
        number = rng.choice(TAKEN_NUMBERS)
        ET.SubElement(rng.choice(joints), "mimic", joint=rng.choice(joints).get("name", ""), multiplier=number)


STRUCTURAL = (_drop, _twin, _move, _rename, _wrap, _reroute, _text, _comment, _shuffle, _follow)
TEXTUAL: tuple[Mutation, ...] = (flip_byte, insert, delete, duplicate, truncate, swap_spans, doctype, declaration)


def mutate(text: str, rng: random.Random) -> str:
    """A text with one to four things done to it."""
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 4))):
        chance = rng.random()
        change = rng.choice(TEXTUAL) if chance < 0.15 else structure if chance < 0.4 else attribute
        text = change(text, rng)
    return text
