"""Fewer triangles for solids to be cut, and pieces grown to hold all of a solid."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mmplan.collision.mesh_files import TriangleMesh
from mmplan.collision.pairs import Indices
from mmplan.shapes import Array

# CoACD takes half a minute for so many triangles of a simple shape.
MOST_TRIANGLES = 10_000
# How far the surface is moved at first, as a share of the solid's size, how much more
# each time that this does not suffice, and at last.
_FIRST_MOVE, _MORE, _LAST_MOVE = 2.5e-4, 1.5, 0.01
# Points looked at in one go.
_CHUNK = 20_000


def simplified(surface: TriangleMesh) -> TriangleMesh:
    """A closed surface as it is or, where it has too many triangles, with fewer.

    Its vertices are some of those that there were. A surface that is closed but crosses
    or touches itself along edges stays as it is.

    Raises:
        ImportError: Manifold is not installed.
    """
    if len(surface.triangles) <= MOST_TRIANGLES:
        return surface
    import manifold3d

    # Sizes far from one would be lost in Manifold's own precision.
    middle = surface.vertices.mean(axis=0)
    size = float(np.ptp(surface.vertices, axis=0).max())
    solid = manifold3d.Manifold(
        manifold3d.Mesh64(
            (surface.vertices - middle) / size, surface.triangles.astype(np.uint64)
        )
    )
    move = _FIRST_MOVE
    while solid.num_tri() > MOST_TRIANGLES and move < _LAST_MOVE:
        solid = solid.simplify(move)
        move *= _MORE
    if solid.is_empty():
        return surface
    mesh = solid.to_mesh64()
    vertices = np.asarray(mesh.vert_properties)[:, :3] * size + middle
    return TriangleMesh(vertices, np.asarray(mesh.tri_verts).astype(np.int64))


def grown(pieces: list[Array], points: Array) -> list[Array]:
    """Convex pieces (m, 3) grown so that points (n, 3) are in one of them, each.

    A point that is in none joins the piece that it is the least outside of.
    """
    outside = np.full(len(points), np.inf)
    piece_of = np.full(len(points), -1)
    planes = [_planes(piece) for piece in pieces]
    reach = _LAST_MOVE * float(np.ptp(points, axis=0).max())
    while len(left := np.flatnonzero(piece_of < 0)):
        for number, piece in enumerate(pieces):
            for rows in _near(piece, points, left, reach):
                depth = _depth(points[rows], planes[number])
                better = depth < outside[rows]
                outside[rows[better]], piece_of[rows[better]] = depth[better], number
        reach *= 2.0
    return [
        np.concatenate([piece, points[(piece_of == number) & (outside > 0.0)]])
        for number, piece in enumerate(pieces)
    ]


def _planes(piece: Array) -> Array:
    """The planes (k, 4) of a hull: outward normals and offsets."""
    from scipy.spatial import ConvexHull

    planes: Array = ConvexHull(piece, qhull_options="QJ Pp").equations
    return planes


def _depth(points: Array, planes: Array) -> Array:
    """How far points (n, 3) are beyond the plane that they are farthest beyond."""
    depth: Array = (points @ planes[:, :3].T + planes[:, 3]).max(axis=1)
    return depth


def _near(
    piece: Array, points: Array, rows: Indices, reach: float
) -> Iterator[Indices]:
    """Those rows of points that are within reach of the box about a piece."""
    low, high = piece.min(axis=0) - reach, piece.max(axis=0) + reach
    inside = np.all((points[rows] >= low) & (points[rows] <= high), axis=1)
    rows = rows[inside]
    for start in range(0, len(rows), _CHUNK):
        yield rows[start : start + _CHUNK]
