"""Processes of a program that is run apart, to see that none is left behind."""

from __future__ import annotations

import time
from pathlib import Path


def of_session(session: int) -> list[int]:
    """The processes of a session that still run."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        try:
            state, _, _, own = (place / "stat").read_text().rpartition(")")[2].split()[:4]
        except (OSError, ValueError):
            continue
        if int(own) == session and state != "Z":
            found.append(int(place.name))
    return found


def left_behind(session: int, seconds: float = 10.0) -> list[int]:
    """The processes of a session that have not ended after some seconds."""
    deadline = time.monotonic() + seconds
    while (found := of_session(session)) and time.monotonic() < deadline:
        time.sleep(0.05)
    return found
