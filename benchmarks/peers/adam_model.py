"""The robot as adam reads it, for both of its back ends."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from typing import Any

import numpy as np
from protocol import Job


def load(job: Job, kind: Any) -> tuple[Any, list[str]]:
    """An adam `KinDynComputations` and the names of its joints, in the order we choose."""
    text = job.bare_urdf()
    prismatic = [joint.get("name") for joint in ET.fromstring(text).iter("joint") if joint.get("type") == "prismatic"]
    if prismatic:
        raise SystemExit(
            f"adam 0.5.0 gives prismatic joints ({', '.join(map(str, prismatic))}) a motion subspace of 12 rows"
        )
    names = [*job.joints, *sorted(job.followers)]
    return kind(text, names, gravity=np.array([*job.gravity, 0, 0, 0])), names
