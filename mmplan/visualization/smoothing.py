"""Surfaces made fit to be drawn: edges kept sharp, large meshes made coarse."""

from __future__ import annotations

import numpy as np

from mmplan.shapes import Array
from mmplan.visualization.surface import Surface, Triangles

# Triangles that meet at a greater angle meet in an edge, cos.
_EDGE = np.cos(np.radians(40.0))
# Of a mesh with more triangles than this every triangle keeps corners of its own.
_MOST_SMOOTHED = 60_000


def with_edges(surface: Surface) -> Surface:
    """The surface with vertices split wherever it has an edge.

    The normal of a corner of a triangle is the mean of those of all triangles about
    its vertex that meet it at less than 40 degrees; corners of one vertex with the same
    normal become one vertex again.
    """
    vertices, triangles = _welded(surface)
    corner = triangles.reshape(-1)  # (3 m,), the vertex of each corner
    if len(triangles) > _MOST_SMOOTHED:
        return Surface(vertices[corner], np.arange(len(corner)).reshape(-1, 3))
    normals = _corner_normals(vertices, triangles)
    key = np.concatenate([corner[:, None], np.round(normals * 50.0)], axis=1)
    _, first, vertex = np.unique(key, axis=0, return_index=True, return_inverse=True)
    return Surface(vertices[corner[first]], vertex.reshape(-1, 3))


def coarsened(surface: Surface, most: int) -> Surface:
    """The surface with at most `most` triangles, its vertices drawn together.

    The space is cut into cubes, larger ones until it is enough; all vertices in a cube
    become their mean.
    """
    if len(surface.triangles) <= most:
        return surface
    size = float(np.ptp(surface.vertices, axis=0).max())
    cells = float(np.sqrt(most))
    while cells > 2.0:
        coarse = _clustered(surface, size / cells)
        if len(coarse.triangles) <= most:
            return coarse
        cells *= 0.85
    return coarse


def _welded(surface: Surface) -> tuple[Array, Triangles]:
    """Vertices at the same place (to 1e-7 m) made one; triangles without area left."""
    _, first, place = np.unique(
        np.round(surface.vertices * 1e7), axis=0, return_index=True, return_inverse=True
    )
    triangles = place.reshape(-1)[surface.triangles]
    return surface.vertices[first], _proper(triangles)


def _corner_normals(vertices: Array, triangles: Triangles) -> Array:
    """The unit normals (3 m, 3) of the triangles' corners."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    area = np.cross(b - a, c - a)
    length = np.linalg.norm(area, axis=1, keepdims=True)
    unit = area / np.where(length > 0.0, length, 1.0)
    mine, other = _neighbours(triangles.reshape(-1))
    near = np.einsum("ij,ij->i", unit[mine // 3], unit[other // 3]) > _EDGE
    normals = np.zeros((triangles.size, 3))
    for axis in range(3):
        weights = area[other[near] // 3, axis]
        normals[:, axis] = np.bincount(mine[near], weights, triangles.size)
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    means: Array = normals / np.where(length > 0.0, length, 1.0)
    return means


def _neighbours(corner: Triangles) -> tuple[Triangles, Triangles]:
    """All pairs of corners that share their vertex, each corner with itself too."""
    order = np.argsort(corner, kind="stable")
    count = np.bincount(corner)
    start = np.cumsum(count) - count
    size = count[corner[order]]  # of the group that each corner in order belongs to
    mine = np.repeat(order, size)
    within = np.arange(len(mine)) - np.repeat(np.cumsum(size) - size, size)
    other = order[np.repeat(start[corner[order]], size) + within]
    return mine, other


def _clustered(surface: Surface, cell: float) -> Surface:
    cube = np.floor(surface.vertices / cell).astype(np.int64)
    _, place, count = np.unique(cube, axis=0, return_inverse=True, return_counts=True)
    place = place.reshape(-1)
    sums = [np.bincount(place, surface.vertices[:, axis]) for axis in range(3)]
    triangles = _proper(place[surface.triangles])
    _, first = np.unique(np.sort(triangles, axis=1), axis=0, return_index=True)
    return Surface(np.stack(sums, axis=1) / count[:, None], triangles[np.sort(first)])


def _proper(triangles: Triangles) -> Triangles:
    """The triangles whose three vertices differ."""
    a, b, c = triangles.T
    proper: Triangles = triangles[(a != b) & (b != c) & (c != a)]
    return proper
