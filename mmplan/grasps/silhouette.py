"""Where a solid of revolution can be held: its bodies, stems, ends and rims."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import groupby

import numpy as np

from mmplan.grasps.hand import HandSize
from mmplan.shapes import Array

# Heights at which a profile is looked at.
_HEIGHTS = 800
# A side is held where its radius changes by at most this much per height.
_STEEPEST = 0.35
# The shortest piece of a side that fingers hold, as a share of their width.
_SHORTEST = 0.5
# A stem is at most this share of the widest radius.
_STEM = 0.4
# The thickest wall of a vessel and the least radius inside it, in widths of a finger.
_WALL, _INSIDE = 1.0, 1.5
# How much the radius of a wall changes per height at most.
_WALL_SLOPE = 1.0


@dataclass(frozen=True)
class Side:
    """A piece of the outside, from height `low` to `high` (m), that fingers go around.

    `radius` (m) is the largest in it.
    """

    low: float
    high: float
    radius: float


@dataclass(frozen=True, eq=False)
class Silhouette:
    """Outer and inner radius of a solid of revolution over its height.

    `inner` is that of the hollow next to the outermost wall, 0 where there is none.
    """

    height: Array  # (h,), rising
    outer: Array  # (h,)
    inner: Array  # (h,)

    @classmethod
    def of_profile(cls, profile: Array) -> Silhouette:
        """The silhouette of an outline (r, z), (n, 2), closed from last to first."""
        low, high = profile[:, 1].min(), profile[:, 1].max()
        step = (high - low) / _HEIGHTS
        height = low + step * (np.arange(_HEIGHTS) + 0.5)
        a, b = profile, np.roll(profile, -1, axis=0)
        crosses = (a[:, 1] < height[:, None]) != (b[:, 1] < height[:, None])
        rise = np.where(a[:, 1] == b[:, 1], 1.0, b[:, 1] - a[:, 1])
        share = (height[:, None] - a[:, 1]) / rise
        radius = np.where(crosses, a[:, 0] + share * (b[:, 0] - a[:, 0]), -1.0)
        radius = np.sort(radius, axis=1)
        return cls(height, radius[:, -1], np.maximum(radius[:, -2], 0.0))

    def sides(self, hand: HandSize) -> list[Side]:
        """The pieces that are narrow and upright enough to be held, bottom to top."""
        slope = np.abs(np.gradient(self.outer, self.height))
        held = (2.0 * self.outer <= hand.widest) & (slope <= _STEEPEST)
        found = []
        for good, run in groupby(range(len(held)), key=lambda i: bool(held[i])):
            rows = list(run)
            low, high = self.height[rows[0]], self.height[rows[-1]]
            if good and high - low >= _SHORTEST * hand.width:
                found.append(
                    Side(float(low), float(high), float(self.outer[rows].max()))
                )
        return found

    def is_stem(self, side: Side) -> bool:
        """Whether a side is much narrower than the whole."""
        return bool(side.radius <= _STEM * self.outer.max())

    def above(self, side: Side) -> float | None:
        """How far the top is above a side (m); None where the way is not free."""
        over = self.height > side.high
        if np.any(self.outer[over] > side.radius):
            return None
        return float(self.height[-1] - side.high)

    def flipped(self) -> Silhouette:
        """The silhouette upside down."""
        return Silhouette(-self.height[::-1], self.outer[::-1], self.inner[::-1])

    def wall(self, hand: HandSize) -> float | None:
        """Radius (m) of the middle of an open vessel's wall at its top, if it has one.

        That is where one finger fits inside and the wall is thin for a finger's width.
        """
        below = self.height >= self.height[-1] - hand.width
        inner, outer = self.inner[below], self.outer[below]
        slope = np.abs(np.gradient(outer, self.height[below]))
        steep = bool(np.all(slope <= _WALL_SLOPE))
        thin = bool(np.all(outer - inner <= _WALL * hand.width))
        roomy = bool(np.all(inner >= _INSIDE * hand.width))
        return (
            float((inner[-1] + outer[-1]) / 2.0) if thin and roomy and steep else None
        )

    def is_flat(self, hand: HandSize) -> bool:
        """Whether fingers above and below reach the edge, as of a plate."""
        thickness = self.height[-1] - self.height[0]
        return bool(thickness <= min(hand.widest, self.outer.max() / 2.0))
