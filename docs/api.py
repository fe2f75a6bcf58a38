"""Writes docs/api.md, the API reference, from the docstrings of every public name.

    python docs/api.py            writes the page
    python docs/api.py --check    exits 1 if the committed page is another

A name is public if it stands in `__all__` of one of `PACKAGES`; each is documented once, where it is listed first.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator
from enum import Enum
from importlib import import_module
from pathlib import Path
from typing import Any

PAGE = Path(__file__).with_name("api.md")

PACKAGES = (
    "rttrr_pin",
    "rttrr_pin.errors",
    "rttrr_pin.implementations",
    "rttrr_pin.validation",
    "rttrr_pin.diagnosis",
    "rttrr_pin.laws",
    "rttrr_pin.trajectories",
    "rttrr_pin.loads",
    "rttrr_pin.viewing",
    "rttrr_pin.conformance",
    "rttrr_pin.conformance.kit.strategies",
    "rttrr_pin.inspection",
    "rttrr_pin.auditing",
    "rttrr_pin.derivation",
    "rttrr_pin.compile",
    "rttrr_pin.exact",
)

SECTIONS = re.compile(r"^(Args|Attributes|Returns|Raises|Yields):$")


def page() -> str:
    """The whole page."""
    lines = [
        "# API reference",
        "",
        "Written by `python docs/api.py` from the docstrings. Frames, signs, units: [notation.md](notation.md).",
    ]
    seen: set[int] = set()
    for name in PACKAGES:
        package = import_module(name)
        entries = [(key, getattr(package, key)) for key in getattr(package, "__all__", ()) if key != "__version__"]
        fresh = [(key, value) for key, value in entries if id(value) not in seen]
        seen |= {id(value) for _, value in fresh}
        lines += ["", f"## `{name}`", "", summary(package)]
        for key, value in fresh:
            lines += ["", *entry(key, value)]
    return "\n".join(lines) + "\n"


def summary(thing: Any) -> str:
    """The first paragraph of a docstring on one line."""
    return " ".join((inspect.getdoc(thing) or "").split("\n\n")[0].split())


def entry(name: str, thing: Any) -> list[str]:
    """One public name: a heading, its signature, its docstring, and the methods of a class."""
    if not (inspect.isclass(thing) or inspect.isroutine(thing)):
        plain = (str, int, float)
        items = list(thing) if isinstance(thing, (dict, tuple, list, set)) else [thing]
        values = ", ".join(map(str, items)) if all(isinstance(item, plain) for item in items) else ""
        return [f"### `{name}`", "", f"Constant: {values or f'{len(items)} of {type(items[0]).__name__}'}"]
    if inspect.isclass(thing) and issubclass(thing, Enum):
        return [f"### `{name}`", "", *body(thing), "", f"One of {', '.join(f'`{own.name}`' for own in thing)}."]
    kind = "class " if inspect.isclass(thing) else ""
    lines = [f"### `{name}`", "", "```python", f"{kind}{name}{signature(thing)}", "```", "", *body(thing)]
    if inspect.isclass(thing):
        for method, member in members(thing):
            is_property = isinstance(member, property) or not callable(member)
            head = f"**`.{method}`**" if is_property else f"**`.{method}{signature(member)}`**"
            lines += ["", f"{head}: {summary(member)}", *body(member)[1:]]
    return lines


def members(thing: type) -> Iterator[tuple[str, Any]]:
    """The public methods and properties of a class and of its bases that are not public, in the order of the code."""
    bases = [each for each in reversed(thing.__mro__) if each is thing or _undocumented(each)]
    own: dict[str, Any] = {}
    for each in bases:  # what a class defines anew stands where it does so
        own = {name: member for name, member in own.items() if name not in vars(each)} | vars(each)
    for name, member in own.items():
        public = not name.startswith("_") or (name == "__call__" and inspect.isfunction(member))
        function = getattr(thing, name) if isinstance(member, (classmethod, staticmethod)) else member
        documented = inspect.isroutine(function) or isinstance(member, property)
        if public and documented and inspect.getdoc(member):
            yield name, function


def _undocumented(base: type) -> bool:
    """Whether a base class is ours and has no entry of its own: its methods stand with those of the class."""
    public = (value for name in PACKAGES for value in vars(import_module(name)).values())
    return base.__module__.startswith("rttrr_pin") and all(base is not value for value in public)


def signature(thing: Any) -> str:
    """The signature as written, without `self`; empty where Python cannot tell."""
    try:
        text = str(inspect.signature(thing))
    except (TypeError, ValueError):
        return ""
    text = re.sub(r"\(self(, )?", "(", text, count=1)
    text = re.sub(r"(: |-> )(?:'([^']*)'|\"([^\"]*)\")", r"\1\2\3", text)
    text = re.sub(r"PosixPath\('(?:[^']*/)?([^'/]*)'\)", r"\1", text)
    return re.sub(r"<function <lambda> [^>]*>|<(function|rttrr_pin|factory)[^>]*>", "...", text)


def body(thing: Any) -> list[str]:
    """A docstring as Markdown: its paragraphs, and its sections as lists."""
    text = inspect.getdoc(thing) or ""
    lines: list[str] = []
    section = ""
    for line in text.splitlines():
        heading = SECTIONS.match(line)
        if heading:
            section = heading[1]
            lines += [f"{section}:", ""]
        elif line and not line.startswith(" "):  # a paragraph behind a section ends it
            section = ""
            lines.append(line)
        elif section in ("Returns", "Yields"):  # a paragraph, or a list of its own
            lines.append(line.removeprefix("    "))
        elif section and re.match(r"^    \S", line):
            name, colon, rest = line.strip().partition(": ")
            lines.append(f"- `{name}`: {rest}" if colon and " " not in name.replace(", ", ",") else f"- {line.strip()}")
        elif section and line.strip():
            lines.append("  " + line.strip())
        else:
            lines.append(line)
    return lines


def main() -> int:
    """Write the page, or say whether the committed one is the same."""
    text = page()
    if "--check" in sys.argv[1:]:
        return int(not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text)
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
