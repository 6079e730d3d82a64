"""Convex polytopes of few corners that enclose convex ones of many."""

from __future__ import annotations

import numpy as np

from mmplan.shapes import Array

# A piece with no more corners stays as it is: coal takes hardly longer for so many.
_FEW = 128
# How far an enclosing piece may stand off the true one, m, or as a share of its size.
TOLERANCE, RELATIVE_TOLERANCE = 5e-4, 1e-3
# To what share of the tolerance nearest points are looked for, among corners of which
# those nearer to each other count as one.
_PRECISION = 0.1
_MOST_STEPS, _MOST_ROUNDS = 100, 100
# Points nearby that are looked at before all others.
_NEIGHBOURS = 32


def enclosing(corners: Array) -> Array:
    """The corners of a polytope about the hull of some (m, 3), where these are many.

    No point of it is farther from that hull than `TOLERANCE`, or `RELATIVE_TOLERANCE`
    of its size where that is more; no point of the hull is outside of it. It begins
    with the box about the hull. In each round, corners that stand off too far are cut
    off, by planes across the way to the hull's nearest point.
    """
    if len(corners) <= _FEW:
        return corners
    size = float(np.ptp(corners, axis=0).max())
    tolerance = max(TOLERANCE, RELATIVE_TOLERANCE * size)
    middle = corners.mean(axis=0)
    points = corners - middle
    sample = _thinned(points, _PRECISION * tolerance)
    normals = np.concatenate([np.eye(3), -np.eye(3)])
    close: set[bytes] = set()
    for _ in range(_MOST_ROUNDS):
        found = _intersection(points, normals)
        if len(found) >= len(corners):
            break
        places = np.array([p for p in found if _name(p) not in close]).reshape(-1, 3)
        away = _ways(sample, places, _PRECISION * tolerance)
        distances = np.linalg.norm(away, axis=1)
        far = np.flatnonzero(distances > tolerance)
        if len(far) == 0:
            return np.asarray(found + middle)
        close.update(_name(p) for p in places[distances <= tolerance])
        far = far[np.argsort(-distances[far])]
        cuts = away[far] / distances[far, None]
        normals = np.concatenate([normals, _enough(points, places[far], cuts)])
    return corners


def _name(place: Array) -> bytes:
    """What a place is called, whatever its last digits."""
    name: bytes = (np.round(place * 1e9) + 0.0).tobytes()
    return name


def _thinned(points: Array, cell: float) -> Array:
    """One of the points (m, 3) in each cube of a grid."""
    _, first = np.unique(np.floor(points / cell), axis=0, return_index=True)
    thinned: Array = points[np.sort(first)]
    return thinned


def _ways(points: Array, places: Array, precision: float) -> Array:
    """The ways (k, 3) to places from points of the hull of some points (m, 3).

    They are longer than those from the nearest points by at most a precision (m).
    """
    from scipy.spatial import cKDTree

    count = min(_NEIGHBOURS, len(points))
    neighbours = cKDTree(points).query(places, count)[1].reshape(len(places), count)
    ways = np.empty_like(places)
    for i, place in enumerate(places):
        # The nearest point of all is most often one between points nearby.
        chosen, _ = _projected(points[neighbours[i]], place, precision, places[:0])
        _, ways[i] = _projected(points, place, precision, chosen)
    return ways


def _projected(
    points: Array, place: Array, precision: float, chosen: Array
) -> tuple[Array, Array]:
    """Points (j, 3) with the hull's nearest one to a place between them, and its way.

    The place is projected on the hull of those `chosen`, and the outermost of all in
    that direction joins these until none is farther out by more than a precision (m).
    """
    from scipy.optimize import nnls

    if len(chosen) == 0:
        chosen = points[[int(np.argmax(points @ place))]]
    weigh = 1e3 * float(np.abs(place).max())
    away = place
    for _ in range(_MOST_STEPS):
        # Weights that add up to one, as a row that counts more than all others.
        rows = np.vstack([chosen.T, np.full(len(chosen), weigh)])
        weights, _ = nnls(rows, np.append(place, weigh))
        used = weights > 0.0
        chosen = chosen[used]
        nearest = weights[used] @ chosen / weights[used].sum()
        away = place - nearest
        heights = points @ away
        outermost = int(np.argmax(heights))
        beyond = heights[outermost] - nearest @ away
        if beyond <= precision * np.linalg.norm(away):
            break
        chosen = np.vstack([chosen, points[outermost]])
    return chosen, away


def _enough(points: Array, places: Array, normals: Array) -> Array:
    """Those normals whose planes at the points cut off a place no plane before did."""
    left = np.ones(len(places), np.bool_)
    taken = []
    for i, normal in enumerate(normals):
        if left[i]:
            taken.append(normal)
            left &= places @ normal <= np.max(points @ normal)
    return np.array(taken)


def _intersection(points: Array, normals: Array) -> Array:
    """The corners (k, 3) of the polytope with faces of some normals about points."""
    from scipy.spatial import HalfspaceIntersection

    offsets = np.max(points @ normals.T, axis=0)
    planes = np.column_stack([normals, -offsets])
    corners = HalfspaceIntersection(planes, np.zeros(3)).intersections
    _, first = np.unique(np.round(corners * 1e9), axis=0, return_index=True)
    distinct: Array = corners[first]
    return distinct
