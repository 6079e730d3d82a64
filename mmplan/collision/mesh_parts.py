"""The parts of a surface that do not hang together."""

from __future__ import annotations

import numpy as np

from mmplan.collision.mesh_files import TriangleMesh
from mmplan.collision.pairs import Indices
from mmplan.shapes import Array

# Triangles at smaller angles lie on each other, rad.
_SAME = 1e-6


def parts(surface: TriangleMesh) -> list[TriangleMesh]:
    """The surfaces of a mesh that do not hang together.

    Surfaces that only touch each other, at corners, along edges or with whole sides, do
    not. A surface that bounds a cavity inside of another stays with all others.
    """
    vertices, triangles = surface
    part_of = _linked(surface)
    order = np.argsort(part_of, kind="stable")
    ends = np.flatnonzero(np.diff(part_of[order])) + 1
    found = []
    for own in np.split(triangles[order], ends):
        used, compact = np.unique(own, return_inverse=True)
        found.append(TriangleMesh(vertices[used], compact.reshape(-1, 3)))
    if len(found) == 1 or any(
        signed_volume(part) <= 0.0 or not is_closed(part) for part in found
    ):
        return [surface]
    return found


def is_closed(surface: TriangleMesh) -> bool:
    """Whether every edge is passed as often one way as the other.

    So it is only where the surface has no border and all triangles face the same side.
    """
    a, b, c = surface.triangles.T
    start, end = np.concatenate([a, b, c]), np.concatenate([b, c, a])
    n = len(surface.vertices)
    return np.array_equal(np.sort(start * n + end), np.sort(end * n + start))


def signed_volume(surface: TriangleMesh) -> float:
    """The volume by the divergence theorem; negative where triangles face inward."""
    vertices, triangles = surface
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0


def _linked(surface: TriangleMesh) -> Indices:
    """A number for each triangle (t,), the same for those that hang together.

    Two triangles do that have an edge in common, and of four at an edge each two that
    the inside lies between.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    n, t = len(surface.vertices), len(surface.triangles)
    ends = np.sort(surface.triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2)
    edge = (ends[:, :, 0] * n + ends[:, :, 1]).ravel()
    order = np.argsort(edge, kind="stable")
    start = np.flatnonzero(np.diff(edge[order], prepend=-1))
    count = np.diff(start, append=len(edge))
    two = order[start[count == 2, None] + np.arange(2)]
    four = order[start[count == 4, None] + np.arange(4)]
    links = np.concatenate([two, _across(surface, four)]) // 3
    graph = coo_array((np.ones(len(links), np.int8), tuple(links.T)), shape=(t, t))
    labels: Indices = connected_components(graph, directed=False)[1]
    return labels


def _across(surface: TriangleMesh, sides: Indices) -> Indices:
    """Pairs (k, 2) of sides with the inside between, of four sides (e, 4) at an edge.

    Side 3 i + j of the surface is that of triangle i from its corner j on.
    """
    vertices, triangles = surface
    number, corner = np.divmod(sides, 3)
    a, b, c = (triangles[number, (corner + k) % 3] for k in range(3))
    forward = a < b
    sound = forward.sum(axis=1) == 2
    sides, a, b, c, forward = (x[sound] for x in (sides, a, b, c, forward))
    low, high = vertices[np.minimum(a, b)[:, 0]], vertices[np.maximum(a, b)[:, 0]]
    angle = _angles(vertices[c] - low[:, None], high - low)
    ahead = np.argsort(~forward, axis=1, kind="stable")
    sides = np.take_along_axis(sides, ahead, axis=1)
    angle = np.take_along_axis(angle, ahead, axis=1)
    # From a triangle that runs along the edge, the inside is where angles fall.
    turn = (angle[:, :2, None] - angle[:, None, 2:]) % (2 * np.pi)
    turn[turn > 2 * np.pi - _SAME] = 0.0
    turn[turn < _SAME] = 2 * np.pi
    nearest = np.take_along_axis(sides[:, 2:], np.argmin(turn, axis=2), axis=1)
    pairs: Indices = np.stack([sides[:, :2], nearest], axis=2).reshape(-1, 2)
    return pairs


def _angles(arms: Array, axes: Array) -> Array:
    """The angles (e, k) of arms (e, k, 3) about axes (e, 3), from the first arm on."""
    axes = axes / np.linalg.norm(axes, axis=1, keepdims=True)
    across = np.cross(axes[:, None], arms)
    first, second = across[:, :1], np.cross(axes[:, None], across[:, :1])
    x, y = (np.einsum("eki,eji->ek", across, side) for side in (first, second))
    angles: Array = np.arctan2(y, x)
    return angles
