"""Solids of revolution cut into convex pieces that enclose them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from mmplan.shapes import Array

# How far a piece may stand off the true surface of revolution, m.
SURFACE_TOLERANCE = 0.0005
# Slices of a turn; the most suffice for the tolerance up to a radius of 0.41 m.
_LEAST_SLICES, _MOST_SLICES = 8, 64
_EPSILON = 1e-9


def convex_pieces(profile: Array) -> list[Array]:
    """The corners (m, 3) of convex pieces whose union encloses the solid.

    The profile (n, 2) of (r, z), a simple polygon in r >= 0, is cut at the heights of
    its corners into trapezoids. A trapezoid that reaches the axis turns into one
    convex frustum, any other into a ring of wedges. Pieces are never smaller than the
    solid: its outer faces are circumscribed, and its inner ones are chords. Both stand
    off the surface towards the free side by at most `SURFACE_TOLERANCE`, or 0.0012 of
    the radius where that is more.
    """
    pieces: list[Array] = []
    trapezoids = _trapezoids(np.asarray(profile, dtype=np.float64))
    for polygon in _merge([t for t in trapezoids if _reaches_axis(t)]):
        pieces += [_turned(polygon, 0.0, 2 * np.pi, _slice_count(polygon))]
    for polygon in _merge([t for t in trapezoids if not _reaches_axis(t)]):
        step = 2 * np.pi / _slice_count(polygon)
        starts = np.arange(0.0, 2 * np.pi - step / 2, step)
        pieces += [_turned(polygon, start, step, 1) for start in starts]
    return pieces


def _reaches_axis(trapezoid: Array) -> bool:
    """Whether the trapezoid is without a hole at every height."""
    return bool(trapezoid[[0, 3], 0].max() <= _EPSILON)


def _slice_count(polygon: Array) -> int:
    """Slices of a turn, a multiple of 4, so that tangents stay within tolerance."""
    radius = polygon[:, 0].max()
    half = np.arccos(1.0 / (1.0 + SURFACE_TOLERANCE / max(radius, SURFACE_TOLERANCE)))
    return int(np.clip(4 * np.ceil(np.pi / half / 4), _LEAST_SLICES, _MOST_SLICES))


def _turned(polygon: Array, start: float, angle: float, slices: int) -> Array:
    """Corners (m, 3) of the hull of a polygon turned about z by `angle` (rad).

    Between two slice boundaries the circle is enclosed by its tangents there.
    """
    step = angle / slices
    edges = start + step * np.arange(slices + 1)
    middles = edges[:-1] + step / 2
    theta = np.concatenate([edges, middles])  # (t,)
    stretch = np.concatenate(
        [np.ones(len(edges)), np.full(slices, 1 / np.cos(step / 2))]
    )
    r = polygon[:, 0, None] * stretch  # (corners, t)
    z = np.broadcast_to(polygon[:, 1, None], r.shape)
    points = np.stack([r * np.cos(theta), r * np.sin(theta), z], axis=-1)
    return np.unique(points.reshape(-1, 3), axis=0)


def _trapezoids(profile: Array) -> list[Array]:
    """Cut the polygon at the heights of its corners, bottom to top.

    Each trapezoid is (4, 2): inner bottom, outer bottom, outer top, inner top.
    """
    a, b = profile, np.roll(profile, -1, axis=0)
    heights = np.unique(np.round(profile[:, 1], 9))
    cut: list[Array] = []
    for low, high in pairwise(heights):
        middle = 0.5 * (low + high)
        crosses = (a[:, 1] < middle) != (b[:, 1] < middle)
        p, d = a[crosses], b[crosses] - a[crosses]
        along = [np.clip((z - p[:, 1]) / d[:, 1], 0, 1) for z in (low, middle, high)]
        r = [p[:, 0] + d[:, 0] * t for t in along]
        order = np.argsort(r[1])
        for i, o in zip(order[0::2], order[1::2], strict=True):
            cut.append(
                np.array(
                    [[r[0][i], low], [r[0][o], low], [r[2][o], high], [r[2][i], high]]
                )
            )
    return cut


def _merge(trapezoids: list[Array]) -> list[Array]:
    """Join polygons that share a whole edge where the union stays convex.

    Corners run from the inner bottom along the outside to the inner top.
    """
    merged: list[Array] = []
    for trapezoid in trapezoids:
        for i, below in enumerate(merged):
            joined = _joined(below, trapezoid)
            if joined is not None:
                merged[i] = joined
                break
        else:
            merged.append(trapezoid)
    return merged


def _joined(below: Array, above: Array) -> Array | None:
    """The union of two polygons stacked in z if it is convex, else None."""
    top = int(np.argmax(below[:, 1] >= below[:, 1].max() - _EPSILON))  # outer top
    shared = np.allclose(below[top : top + 2], above[[1, 0]], atol=_EPSILON)
    if not shared or top + 2 > len(below):
        return None
    union = np.concatenate(
        [below[: top + 1], above[2:], below[top + 1 :]], axis=0
    )  # outer side up, inner side down
    edges = np.roll(union, -1, axis=0) - union
    edges = edges[np.linalg.norm(edges, axis=1) > _EPSILON]
    following = np.roll(edges, -1, axis=0)
    turn = edges[:, 0] * following[:, 1] - edges[:, 1] * following[:, 0]
    return union if np.all(turn >= -1e-12) else None
