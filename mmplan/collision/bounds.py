"""Axis-aligned bounds of bodies, and how far apart bounds are at least."""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np

from mmplan.kinematics import turned
from mmplan.shapes import Array


class Bounds(NamedTuple):
    """Axis-aligned boxes as centres and half extents, each (..., 3), in metres."""

    centre: Array
    half: Array

    def gap(self, other: Bounds) -> Array:
        """A lower bound on the distance between what the boxes enclose, broadcast."""
        squares: Array | float = 0.0
        for axis in range(3):
            apart = np.abs(self.centre[..., axis] - other.centre[..., axis])
            apart -= self.half[..., axis] + other.half[..., axis]
            np.maximum(apart, 0.0, out=apart)
            squares = squares + apart * apart
        gap: Array = np.sqrt(np.asarray(squares))
        return gap


def local_bounds(geometry: coal.CollisionGeometry) -> Bounds:
    """The bounds of a geometry in its own frame."""
    geometry.computeLocalAABB()
    box = geometry.aabb_local
    low, high = np.asarray(box.min_).ravel(), np.asarray(box.max_).ravel()
    return Bounds((low + high) / 2, (high - low) / 2)


def touching_depth(first: Bounds, second: Bounds, tolerance: float) -> float:
    """How deep (m) two bodies that may touch may overlap.

    That is `tolerance`, but no more than half the thickness of the thinner one, lest
    the tolerance lets thin bodies pass through each other. Bounds are in the bodies'
    own frames.
    """
    return min(tolerance, float(first.half.min()), float(second.half.min()))


def moved_bounds(local: Bounds, T: Array) -> Bounds:
    """Bounds in the world of boxes `local` (m, 3) moved by poses T (..., m, 4, 4)."""
    R = T[..., :3, :3]
    centre = turned(R, local.centre) + T[..., :3, 3]
    return Bounds(centre, turned(np.abs(R), local.half))
