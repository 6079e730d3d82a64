"""Zones of the floor that a base must keep out of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class Zone:
    """A polygon of the floor; its edges do not cross."""

    name: str
    corners: Array  # (k, 2), m, x and y in the world

    def distances(self, points: Array) -> Array:
        """Signed distances (n,) of points (n, 2), m, negative inside."""
        start, end = self.corners, np.roll(self.corners, -1, axis=0)
        edge = end - start  # (k, 2)
        away = points[:, None] - start  # (n, k, 2)
        share = np.einsum("nkd,kd->nk", away, edge) / (edge**2).sum(axis=1)
        nearest = np.clip(share, 0.0, 1.0)[..., None] * edge
        distance: Array = np.linalg.norm(away - nearest, axis=2).min(axis=1)
        return np.where(self._inside(points, start, end), -distance, distance)

    def _inside(self, points: Array, start: Array, end: Array) -> Array:
        """Whether points (n, 2) are inside: a ray along x meets the outline oddly."""
        x, y = points[:, :1], points[:, 1:]
        above = (start[:, 1] > y) != (end[:, 1] > y)  # (n, k)
        rise = np.where(end[:, 1] == start[:, 1], 1.0, end[:, 1] - start[:, 1])
        meets = start[:, 0] + (y - start[:, 1]) / rise * (end - start)[:, 0]
        inside: Array = np.sum(above & (x < meets), axis=1) % 2 == 1
        return inside


def base_clearances(zones: Sequence[Zone], q_base: Array, radius: float) -> Array:
    """How far bases (n, b) with a footprint circle keep from all zones, (n,), m.

    `radius` is that of the circle about the base's centre; negative values say how
    deep it is in a zone. Infinite where there are no zones.
    """
    clearance = np.full(len(q_base), np.inf)
    for zone in zones:
        clearance = np.minimum(clearance, zone.distances(q_base[:, :2]) - radius)
    return clearance
