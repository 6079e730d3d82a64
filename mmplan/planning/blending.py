"""Polylines with their corners rounded by parabolas, each checked for collision.

After T. Kunz, M. Stilman, "Time-optimal trajectory generation for path following with
bounded acceleration and velocity", RSS 2012, with parabolas instead of circles.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from mmplan.planning.checking import PathChecker
from mmplan.shapes import Array

# A blend takes at most this share of either edge, so that a straight part remains.
EDGE_SHARE = 0.45
# A blend in collision is halved so often before the motion stops at its corner.
HALVINGS = 5
# Where the cosine of the turn is below this, the path reverses: the motion stops.
REVERSAL = -0.95


@dataclass(frozen=True, eq=False)
class SmoothCurve:
    """A curve q(s), s in [0, length], with continuous q'(s): lines and parabolas.

    Piece i begins at s = starts[i], where q = a + b x + c x² with x = s - starts[i].
    s counts metres of lever-arm-weighted length along the polyline that was rounded.
    """

    starts: Array  # (k,)
    a: Array  # (k, nq)
    b: Array  # (k, nq)
    c: Array  # (k, nq), 0 on lines
    length: float

    def __call__(self, s: Array, order: int = 0) -> Array:
        """The curve's derivative of that order (0, 1 or 2) at s (n,), (n, nq)."""
        piece = np.searchsorted(self.starts, s, side="right") - 1
        # Where pieces meet, the parabola counts: it bounds what acceleration is needed.
        earlier = np.maximum(piece - 1, 0)
        piece = np.where(
            (s == self.starts[piece]) & np.any(self.c[earlier], axis=1), earlier, piece
        )
        x = (s - self.starts[piece])[:, None]
        a, b, c = self.a[piece], self.b[piece], self.c[piece]
        value: Array = (a + x * (b + x * c), b + 2.0 * x * c, 2.0 * c)[order]
        return value

    @property
    def moving(self) -> npt.NDArray[np.int64]:
        """The joints that move along it, by their places in q."""
        return np.flatnonzero(np.any(self.b, axis=0))

    def corners(self, turn: float) -> Array:
        """Ends (n,) of the parabolas that turn by more than `turn` (rad, about)."""
        before, after = self.b[:-2:2], self.b[2::2]
        turns = np.linalg.norm(after - before, axis=1) / np.linalg.norm(before, axis=1)
        sharp = 2 * np.flatnonzero(turns > turn) + 1
        ends: Array = self.starts[np.concatenate([sharp, sharp + 1])]
        return ends


def blend_sizes(path: Array, checker: PathChecker, deviation: float) -> Array:
    """How far before and after each waypoint of a polyline (n, nq) its blend begins.

    No point of the robot comes farther than `deviation` (m) from where the polyline
    would take it. Blends in collision shrink; 0 says that the motion must stop there,
    as at both ends.

    Returns:
        Sizes in metres of weighted length, (n,).
    """
    lengths, directions = _edges(path, checker.sweep.weights)
    sizes = np.zeros(len(path))
    for i in range(1, len(path) - 1):
        before, after = directions[i - 1], directions[i]
        if _cosine(before, after, checker.sweep.weights) < REVERSAL:
            continue
        turn = float(checker.sweep.distance(after - before))
        size = EDGE_SHARE * min(lengths[i - 1], lengths[i])
        size = min(size, 4.0 * deviation / turn) if turn > 0.0 else size
        sizes[i] = _free_size(path[i], before, after, size, checker)
    return sizes


def smooth_curves(path: Array, sizes: Array, weights: Array) -> list[SmoothCurve]:
    """The polyline (n, nq) as curves from stop to stop, its corners rounded."""
    stops = np.flatnonzero(sizes == 0.0)
    return [
        _smooth_curve(path[i : j + 1], sizes[i : j + 1], weights)
        for i, j in pairwise(stops)
    ]


def _smooth_curve(path: Array, sizes: Array, weights: Array) -> SmoothCurve:
    lengths, directions = _edges(path, weights)
    n = len(path)
    before, after = directions[:-1], directions[1:]
    inner = sizes[1:-1, None]
    a, b, c = (np.zeros((2 * n - 3, path.shape[1])) for _ in range(3))
    extents = np.zeros(2 * n - 3)
    a[0::2], b[0::2] = path[:-1] + sizes[:-1, None] * directions, directions
    extents[0::2] = lengths - sizes[:-1] - sizes[1:]
    a[1::2], b[1::2] = path[1:-1] - inner * before, before
    c[1::2] = (after - before) / (4.0 * inner)
    extents[1::2] = 2.0 * sizes[1:-1]
    ends = np.cumsum(extents)
    return SmoothCurve(ends - extents, a, b, c, float(ends[-1]))


def _edges(path: Array, weights: Array) -> tuple[Array, Array]:
    """Weighted lengths (n - 1,) of the edges and their directions, joints per metre."""
    dq = np.diff(path, axis=0)
    lengths = np.linalg.norm(dq * weights, axis=1)
    return lengths, dq / lengths[:, None]


def _cosine(before: Array, after: Array, weights: Array) -> float:
    """The cosine of the turn between two directions of unit weighted length."""
    return float((before * weights) @ (after * weights))


def _free_size(
    corner: Array, before: Array, after: Array, size: float, checker: PathChecker
) -> float:
    """The largest of size, size / 2, ... whose blend is free; 0 if none is."""
    for _ in range(HALVINGS + 1):
        steps = int(checker.steps(2.0 * size * np.maximum(abs(before), abs(after))))
        x = np.linspace(0.0, 1.0, steps + 1)[:, None]
        blend = corner + size * (x**2 * after - (1.0 - x) ** 2 * before)
        if checker.states_free(blend):
            return size
        size /= 2.0
    return 0.0
