"""Speed profiles of curves, and the grids on which they are computed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.planning.checking import even_fractions
from mmplan.planning.curve import Curve
from mmplan.planning.joints import MotionLimits
from mmplan.planning.toppra_speeds import fastest_speeds
from mmplan.shapes import Array

# How fine a curve is seen at first, points from stop to stop.
FIRST_GRID = 150
# Where the direction turns by more than this, rad, the curvature jumps noticeably.
SHARP = 0.05


@dataclass(frozen=True, eq=False)
class SpeedProfile:
    """How fast a curve is passed, the acceleration even between points of a grid."""

    grid: Array  # (n,), s from 0 to the curve's length
    speeds: Array  # (n,), ds/dt there
    times: Array  # (n,), s, when the points are passed

    @classmethod
    def fastest(cls, curve: Curve, grid: Array, limits: MotionLimits) -> SpeedProfile:
        """The fastest profile within the limits, from rest to rest."""
        speeds = fastest_speeds(curve, grid, limits)
        steps = 2.0 * np.diff(grid) / (speeds[1:] + speeds[:-1])
        return cls(grid, speeds, np.append(0.0, np.cumsum(steps)))

    def at(self, t: Array) -> Array:
        """Where on the curve the motion is at times (n,)."""
        i = np.clip(np.searchsorted(self.times, t) - 1, 0, len(self.times) - 2)
        tau = t - self.times[i]
        acceleration = np.diff(self.speeds)[i] / np.diff(self.times)[i]
        along: Array = self.grid[i] + tau * (self.speeds[i] + tau * acceleration / 2.0)
        return along


def even_in_length(curve: Curve) -> Array:
    """Points (n,) that cover every piece of a curve evenly, at least two each."""
    ends = np.append(curve.starts[1:], curve.length)
    extents = ends - curve.starts
    counts = np.ceil(extents * (FIRST_GRID / curve.length)).astype(np.int64)
    piece, fraction = even_fractions(np.maximum(counts, 2))
    grid: Array = curve.starts[piece] + fraction * extents[piece]
    grid[fraction == 1.0] = ends  # not a rounding error beside them
    return np.append(0.0, grid)


def even_in_time(curve: Curve, rough: SpeedProfile, rate: float) -> Array:
    """Points (n,) passed at even times, and every place where the curvature jumps."""
    samples = max(4, int(np.ceil(rough.times[-1] * rate)))
    even = np.linspace(0.0, rough.times[-1], samples + 1)[1:-1]
    jumps = curve.corners(SHARP)
    # An even point that almost coincides with a jump gives way to it.
    apart = np.abs(even[:, None] - np.interp(jumps, rough.grid, rough.times))
    even = even[apart.min(axis=1, initial=np.inf) > 0.3 / rate]
    return np.unique(np.concatenate([[0.0], rough.at(even), jumps, [curve.length]]))
