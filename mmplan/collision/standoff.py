"""How far convex bodies stand off the surfaces that they replace."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import coal
import numpy as np

from mmplan.collision.mesh_files import Triangles, read_triangles
from mmplan.collision.separation import signed_distance, transform
from mmplan.collision.solids import Solid
from mmplan.shapes import Array

_POINTS = 300  # on each surface
# Points of a piece this near another piece lie on a cut, not on the surface, m.
_CUT = 1e-3


class Standoff(NamedTuple):
    """Distances (m) over samples of the surfaces of bodies.

    Points of the bodies are `mean` and at most `largest` away from the surface, which
    is a shell; points of the surface are outside of the bodies by at most `uncovered`.
    """

    mean: float
    largest: float
    uncovered: float


def standoff(bodies: Sequence[Solid], surfaces: Sequence[Solid]) -> Standoff:
    """How far bodies stand off surfaces, both placed in one frame.

    Bodies are convex; surfaces are triangle meshes or primitives. Only bodies that
    have corners stand for surfaces: primitives are taken as they are given.
    """
    rng = np.random.default_rng(0)
    outside = [
        max(0.0, _distance(point, surfaces)) for point in _outer_points(bodies, rng)
    ]
    uncovered = [
        max(0.0, _distance(point, bodies))
        for surface in surfaces
        for point in _moved(surface, _mesh_points(surface.geometry, rng))
    ]
    return Standoff(
        float(np.mean(outside or [0.0])),
        max(outside, default=0.0),
        max(uncovered, default=0.0),
    )


def _outer_points(bodies: Sequence[Solid], rng: np.random.Generator) -> Iterator[Array]:
    """Points on the bodies, but for those where pieces of one meet."""
    for i, body in enumerate(bodies):
        others = [*bodies[:i], *bodies[i + 1 :]]
        for point in _moved(body, _hull_points(body.geometry, rng)):
            if not others or _distance(point, others) > _CUT:
                yield point


def _hull_points(geometry: coal.CollisionGeometry, rng: np.random.Generator) -> Array:
    """Points (n, 3) on the surface of a convex body with corners."""
    if not isinstance(geometry, coal.ConvexBase):
        return np.empty((0, 3))
    faces = [geometry.polygons(i) for i in range(geometry.num_polygons)]
    triangles = np.array([(f[0], f[1], f[2]) for f in faces], dtype=np.int64)
    return _spread(np.array(geometry.points()), triangles, rng)


def _mesh_points(geometry: coal.CollisionGeometry, rng: np.random.Generator) -> Array:
    """Points (n, 3) on a triangle mesh."""
    if not isinstance(geometry, coal.BVHModelBase):
        return np.empty((0, 3))
    return _spread(*read_triangles(geometry), rng)


def _spread(vertices: Array, triangles: Triangles, rng: np.random.Generator) -> Array:
    """Points (n, 3) drawn evenly by area."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    which = rng.choice(len(areas), _POINTS, p=areas / areas.sum())
    u, v = rng.random((2, _POINTS, 1))
    u, v = np.where(u + v > 1.0, (1.0 - u, 1.0 - v), (u, v))
    points: Array = a[which] + u * (b - a)[which] + v * (c - a)[which]
    return points


def _moved(solid: Solid, points: Array) -> Iterator[Array]:
    yield from points @ solid.placement[:3, :3].T + solid.placement[:3, 3]


def _distance(point: Array, solids: Sequence[Solid]) -> float:
    """The distance (m) of a point to the nearest solid, negative inside of it."""
    at = coal.Transform3s(np.eye(3), point)
    return min(
        signed_distance(solid.geometry, transform(solid.placement), _POINT, at)
        for solid in solids
    )


_POINT = coal.Sphere(1e-9)
