"""The saved results, for those who make tables of them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

HERE = Path(__file__).parent

TOP = HERE.parent


def result(name: str) -> dict[str, Any]:
    """What a benchmark saved."""
    data: dict[str, Any] = json.loads((HERE / "results" / f"{name}.json").read_text())
    return data


def machine(data: dict[str, Any]) -> str:
    """The kind of machine that it ran on."""
    kind = data["machine"]
    return ", ".join([kind["processor"], *([kind["vectors"]] if "vectors" in kind else []), f"{kind['cores']} cores"])
