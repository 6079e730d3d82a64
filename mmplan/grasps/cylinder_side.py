"""Grasps around a round body from its side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.grasps.family import poses_from
from mmplan.shapes import Array


@dataclass(frozen=True)
class CylinderSide:
    """The target point lies on the object's z axis, the approach may be inclined.

    Three genes: the height of the target point, in m, within `along`; the direction
    about the axis from which the hand comes, in rad; and how far it comes from above
    (positive) or below, in rad, at most `tilt`. The fingers close across the axis, so
    that they touch where the body is widest however the hand is inclined.
    """

    along: tuple[float, float]
    tilt: float = np.pi / 6

    @property
    def genes(self) -> GeneSpace:
        """Height, direction and inclination."""
        low, high = self.along
        return GeneSpace(
            np.array([low, -np.pi, -self.tilt]),
            np.array([high, np.pi, self.tilt]),
            np.array([False, True, False]),
        )

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4)."""
        height, angle, tilt = genes.T
        zero = np.zeros(len(genes))
        level = np.cos(tilt)
        approach = -np.stack(
            [level * np.cos(angle), level * np.sin(angle), np.sin(tilt)], axis=1
        )
        closing = np.stack([-np.sin(angle), np.cos(angle), zero], axis=1)
        return poses_from(approach, closing, np.stack([zero, zero, height], axis=1))

    def quality(self, genes: Array) -> Array:
        """1 for all: fingers on both sides of the axis always close."""
        return np.ones(len(genes))
