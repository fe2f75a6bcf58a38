"""What an installation weighs: megabytes by distribution, and which dependency brings each in.

    python benchmarks/installed_size.py [--save]

Run it in a virtual environment that holds what is to be weighed. Sizes are those of the files that each distribution
lists, without compiled bytecode; a distribution that several dependencies need is told once, with the first.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from common import arguments, finish

EXTRAS = ("", "mujoco", "robots", "xacro", "test", "dev")
"""Those of ours that are weighed if they are installed; the empty one is what comes with the package itself."""


def megabytes(name: str) -> float:
    """The files of a distribution."""
    paths = (Path(str(file.locate())) for file in metadata.files(name) or [] if file.suffix != ".pyc")
    return sum(path.stat().st_size for path in paths if path.is_file()) / 1e6


def requirements(name: str, extra: str = "") -> Iterator[tuple[str, set[str]]]:
    """What a distribution asks for here, with the extras of it."""
    for text in metadata.requires(name) or []:
        wanted = Requirement(text)
        if wanted.marker is None or wanted.marker.evaluate({"extra": extra}):
            yield canonicalize_name(wanted.name), set(wanted.extras)


def closure(name: str, extras: set[str], seen: set[tuple[str, str]]) -> set[str]:
    """A distribution and all that it brings in, but for what was seen."""
    try:
        metadata.distribution(name)
    except metadata.PackageNotFoundError:
        return set()
    fresh = {(name, extra) for extra in ("", *extras)} - seen
    whole = {name} if (name, "") in fresh else set()
    seen |= fresh
    for _, extra in sorted(fresh):
        for other, more in requirements(name, extra):
            whole |= closure(other, more, seen)
    return whole


def main() -> None:
    """Weigh each direct dependency with what it alone brings in."""
    options = arguments(__doc__.partition("\n")[0]).parse_args()
    seen = {("rttrr-pin", extra) for extra in EXTRAS}
    rows: dict[str, dict[str, dict[str, float]]] = {}
    for extra in EXTRAS:
        direct = dict(requirements("rttrr-pin", extra))
        if extra:
            direct = {name: more for name, more in direct.items() if name not in dict(requirements("rttrr-pin"))}
        for name in sorted(direct):
            parts = closure(name, direct[name], seen)
            if parts:
                own = megabytes(name) if name in parts else 0.0
                whole = sum(map(megabytes, parts))
                numbers = {"own_mb": round(own, 1), "with_its_own_mb": round(whole, 1), "packages": len(parts)}
                rows.setdefault(extra or "always", {})[name] = numbers
    finish("installed_size", {"megabytes": rows}, options.save)


if __name__ == "__main__":
    main()
