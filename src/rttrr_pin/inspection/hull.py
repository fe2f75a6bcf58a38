"""The convex hull of points, and the homogeneous solid that fills it.

A hull grows point by point: the faces that see a point go, and the edges around them are joined to it (the
beneath-beyond method; Preparata and Shamos, *Computational Geometry*, section 3.4). Corners of boxes and rings of
cylinders lie in common planes, where rounding would decide which faces a point sees; so the points are first moved by
a ten-billionth of the size, at random and the same in every run, after which no four lie in a plane.
"""

from __future__ import annotations

import numpy as np

from rttrr_pin.core.arrays import Array
from rttrr_pin.core.solids import RigidBody

SHIFT, FLAT = 1e-10, 1e-8
"""Of the size: how far points are moved, and how thick a hull must be to have a volume."""

MANY = 400
"""Points from which Qhull, in SciPy, is faster, its import included."""


def filled_hull(points: Array) -> RigidBody | None:
    """The solid of unit density, its mass the volume [m^3]; None where the points, (N, 3) [m], lie in a plane."""
    centre = points.mean(axis=0)
    away = points - centre
    extents = np.linalg.svd(away, compute_uv=False) if len(points) > 3 else np.zeros(3)
    if not extents[-1] > FLAT * extents[0]:
        return None
    size = float(np.abs(away).max())
    corners = away / size
    a, b, c = np.moveaxis(corners[_faces(corners)], 1, 0)
    volumes = np.abs(np.einsum("ij,ij->i", a, np.cross(b, c))) / 6.0  # of tetrahedra on the centre, which is inside
    volume = volumes.sum()
    total = a + b + c
    com = volumes @ total / (4.0 * volume)
    products = sum(np.einsum("i,ij,ik->jk", volumes, x, x) for x in (a, b, c, total)) / 20.0
    sigma = products - volume * np.outer(com, com)
    inertia = np.trace(sigma) * np.eye(3) - sigma
    return RigidBody(float(volume * size**3), centre + size * com, inertia * size**5)


def _faces(points: Array) -> Array:
    """Triangles of the hull, (F, 3) indices."""
    if len(points) > MANY:
        from scipy.spatial import ConvexHull

        return np.asarray(ConvexHull(points).simplices)
    moved = points + SHIFT * np.random.default_rng(0).standard_normal(points.shape)
    start = _tetrahedron(moved)
    inside = moved[start].mean(axis=0)
    faces = np.array([[start[i] for i in corners] for corners in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))])
    normals, heights = _planes(moved, faces)
    inward = normals @ inside > heights
    faces[inward] = faces[inward][:, ::-1]
    normals, heights = _planes(moved, faces)
    # Farthest first: most points lie inside by the time they come up, and cost one product.
    for k in np.argsort(-np.linalg.norm(moved - inside, axis=1)):
        sees = normals @ moved[k] > heights
        if sees.any() and k not in start:
            # An edge between a face that goes and one that stays is met once; one between two that go, in both senses.
            edges = {(face[i - 1], face[i]) for face in faces[sees].tolist() for i in range(3)}
            new = np.array([(i, j, k) for i, j in edges if (j, i) not in edges])
            planes = _planes(moved, new)
            faces = np.concatenate([faces[~sees], new])
            normals = np.concatenate([normals[~sees], planes[0]])
            heights = np.concatenate([heights[~sees], planes[1]])
    return faces


def _tetrahedron(points: Array) -> list[int]:
    """Four points far from each other."""
    i = int(points[:, 0].argmin())
    j = int(np.linalg.norm(points - points[i], axis=1).argmax())
    k = int(np.linalg.norm(np.cross(points - points[i], points[j] - points[i]), axis=1).argmax())
    normal = np.cross(points[j] - points[i], points[k] - points[i])
    return [i, j, k, int(np.abs((points - points[i]) @ normal).argmax())]


def _planes(points: Array, faces: Array) -> tuple[Array, Array]:
    """Normals of faces, outwards if the faces are counterclockwise, and normal . x of their planes."""
    a, b, c = points[faces[:, 0]], points[faces[:, 1]], points[faces[:, 2]]
    normals = np.cross(b - a, c - a)
    return normals, np.einsum("ij,ij->i", normals, a)
