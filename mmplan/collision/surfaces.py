"""What coal's geometries look like: as shapes of a problem, or as triangles."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import coal
import numpy as np
import numpy.typing as npt

from mmplan.exceptions import InputError
from mmplan.shapes import Array, Box, Capsule, Cone, Cylinder, Shape, Sphere


class TriangleMesh(NamedTuple):
    """Triangles, their corners counter-clockwise as seen from outside."""

    vertices: Array  # (n, 3), m
    triangles: npt.NDArray[np.int64]  # (m, 3), indices into vertices


def appearance(geometry: coal.CollisionGeometry) -> Shape | TriangleMesh:
    """A geometry as the shape that it is, or else as triangles.

    Raises:
        TypeError: mmplan makes no geometries of that type.
    """
    match geometry:
        case coal.Box():
            x, y, z = (2.0 * float(half) for half in geometry.halfSide)
            return Box((x, y, z))
        case coal.Sphere():
            return Sphere(geometry.radius)
        case coal.Cylinder():
            return Cylinder(geometry.radius, 2.0 * geometry.halfLength)
        case coal.Capsule():
            return Capsule(geometry.radius, 2.0 * geometry.halfLength)
        case coal.Cone():
            return Cone(geometry.radius, 2.0 * geometry.halfLength)
        case coal.ConvexBase():
            return _convex(geometry)
        case coal.BVHModelBase():
            return _mesh(geometry)
    raise TypeError(f"no surface for a geometry of type {type(geometry).__name__}")


def mesh_appearance(path: Path, scale: tuple[float, float, float]) -> TriangleMesh:
    """The triangles in a file, which need not be closed.

    Raises:
        InputError: The file cannot be read.
    """
    try:
        return _mesh(coal.MeshLoader().load(str(path), np.array(scale)))
    except (RuntimeError, ValueError) as error:
        raise InputError(f"{path}: this mesh cannot be read") from error


def _mesh(model: coal.BVHModelBase) -> TriangleMesh:
    corners = [
        (t[0], t[1], t[2]) for t in map(model.tri_indices, range(model.num_tris))
    ]
    triangles = np.array(corners, dtype=np.int64).reshape(-1, 3)
    return TriangleMesh(np.array(model.vertices()).reshape(-1, 3), triangles)


def _convex(convex: coal.ConvexBase) -> TriangleMesh:
    """The triangles of a convex geometry, turned so that they face outside."""
    points = np.array(convex.points()).reshape(-1, 3)
    polygons = [convex.polygons(i) for i in range(convex.num_polygons)]
    triangles = np.array([(p[0], p[1], p[2]) for p in polygons], np.int64)
    a, b, c = (points[triangles[:, i]] for i in range(3))
    outward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - points.mean(axis=0))
    inside = outward < 0.0
    triangles[inside] = triangles[inside][:, ::-1]
    return TriangleMesh(points, triangles)
