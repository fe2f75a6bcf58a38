"""Compiles LaTeX documents, for tests that are marked `tex`."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

COMMAND = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "-no-shell-escape", "a.tex"]


@dataclass(frozen=True)
class Compiled:
    """What TeX says of a document: how many pages, and how far boxes stick out, in points."""

    pages: int
    overfull: list[float]


def compiled(text: str, folder: Path, runs: int = 1) -> Compiled:
    """A document that compiles; tables of several pages want two runs."""
    (folder / "a.tex").write_text(text, encoding="utf-8")
    for _ in range(runs):
        done = subprocess.run(
            COMMAND, cwd=folder, capture_output=True, text=True, errors="replace", check=False, timeout=300
        )
        assert done.returncode == 0, done.stdout[-2000:]
    log = (folder / "a.log").read_text(errors="replace").replace("\n", "")
    found = re.search(r"Output written on a\.pdf \((\d+) page", log)
    assert found, log[-2000:]
    return Compiled(int(found[1]), [float(x) for x in re.findall(r"Overfull \\hbox \(([\d.]+)pt", log)])
