"""Meshes, and hulls of many points: the only module that loads trimesh and SciPy."""

from __future__ import annotations

import logging
import warnings
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from scipy.spatial import ConvexHull

from rttrr_pin.core.arrays import Array


@lru_cache(maxsize=512)
def load_corners(path: Path) -> Array:
    """The corners of a mesh's hull, (N, 3) [m]; none where it cannot be read."""
    logger = logging.getLogger("trimesh")
    level = logger.level
    logger.setLevel(logging.CRITICAL)
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            mesh: Any = trimesh.load(path, force="mesh", process=False, skip_materials=True)
            if mesh.units not in (None, "m", "meter", "meters"):
                mesh.convert_units("meters")
            points = np.asarray(mesh.vertices, dtype=np.float64)
            points = points[np.isfinite(points).all(axis=1)]
            return points[ConvexHull(points).vertices] if len(points) > 100 else points
    except Exception:  # whatever a damaged mesh does to its reader, inspection goes on without it
        return np.zeros((0, 3))
    finally:
        logger.setLevel(level)


def hull_faces(points: Array) -> Array:
    """Triangles of the hull of points that do not lie in a plane, (F, 3) indices."""
    return np.asarray(ConvexHull(points).simplices)
