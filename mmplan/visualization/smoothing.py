"""Surfaces made fit to be drawn: edges kept sharp, large meshes made coarse."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array
from mmplan.visualization.surface import Surface, Triangles

# Triangles that meet at a greater angle meet in an edge, cos.
_EDGE = np.cos(np.radians(40.0))
# Odd and large, so that products of small numbers spread over all of 64 bits.
_MIXERS = np.array([0x1E3779B97F4A7C15, 0x3F58476D1CE4E5B9, 0x14D049BB133111EB])
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
    x, y, z = np.round(normals.T * 50.0).astype(np.int64) + 50
    key = ((corner * 101 + x) * 101 + y) * 101 + z
    _, first, vertex = np.unique(key, return_index=True, return_inverse=True)
    return Surface(vertices[corner[first]], vertex.reshape(-1, 3))


def coarsened(surface: Surface, most: int) -> Surface:
    """The surface with at most `most` triangles, its vertices drawn together.

    The space is cut into cubes, larger ones until it is enough; all vertices in a cube
    become their mean.
    """
    if len(surface.triangles) <= most:
        return surface
    size = float(np.ptp(surface.vertices, axis=0).max())
    coarse, cells = surface, float(np.sqrt(most))
    while len(coarse.triangles) > most and cells > 2.0:
        coarse = _clustered(surface, size / cells)
        # The triangles of a surface grow as the square of the cells along an edge.
        cells *= min(0.9, 0.97 * float(np.sqrt(most / max(1, len(coarse.triangles)))))
    return coarse


def _welded(surface: Surface) -> tuple[Array, Triangles]:
    """Vertices at the same place (to 1e-7 m) made one; triangles without area left."""
    rounded = np.round(surface.vertices * 1e7).astype(np.int64)
    _, first, place = np.unique(_mixed(rounded), return_index=True, return_inverse=True)
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
    _, place, count = np.unique(_mixed(cube), return_inverse=True, return_counts=True)
    place = place.reshape(-1)
    sums = [np.bincount(place, surface.vertices[:, axis]) for axis in range(3)]
    triangles = _proper(place[surface.triangles])
    _, first = np.unique(_mixed(np.sort(triangles, axis=1)), return_index=True)
    return Surface(np.stack(sums, axis=1) / count[:, None], triangles[np.sort(first)])


def _mixed(rows: Triangles) -> npt.NDArray[np.int64]:
    """A number for each row (n, 3) of integers, hardly ever the same for two.

    Sorting numbers is ten times quicker than sorting rows.
    """
    mixed: npt.NDArray[np.int64] = rows @ _MIXERS
    return mixed ^ (mixed >> 29)


def _proper(triangles: Triangles) -> Triangles:
    """The triangles whose three vertices differ."""
    a, b, c = triangles.T
    proper: Triangles = triangles[(a != b) & (b != c) & (c != a)]
    return proper
