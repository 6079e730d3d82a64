"""What coal's geometries look like: as shapes of a problem, or as triangles."""

from __future__ import annotations

import coal
import numpy as np

from mmplan.collision.mesh_files import TriangleMesh, read_triangles
from mmplan.shapes import Box, Capsule, Cone, Cylinder, Shape, Sphere


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
            return read_triangles(geometry)
    raise TypeError(f"no surface for a geometry of type {type(geometry).__name__}")


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
