"""Grasps of the outer lip: the paper's family for the plate."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.grasps.family import poses_from
from mmplan.shapes import Array


@dataclass(frozen=True)
class Rim:
    """The target point lies on a circle about z, the approach in the circle's plane.

    Two genes (paper, section V): the place on the lip as an angle about z, in rad, and
    the approach direction as its angle to the direction towards the axis, at most
    `spread` either way. `radius` and `height` (m) are those of the lip's circle. The
    fingers close across the plane. With a `tilt` (rad) the hand comes from above the
    plane: at pi/2 straight down, its fingers on both sides of the wall of a bowl.
    """

    radius: float
    height: float
    spread: float = np.pi / 3
    tilt: float = 0.0

    @property
    def genes(self) -> GeneSpace:
        """Place on the lip and approach direction."""
        return GeneSpace(
            np.array([-np.pi, -self.spread]),
            np.array([np.pi, self.spread]),
            np.array([True, False]),
        )

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4)."""
        place, turn = genes.T
        zero, up = np.zeros(len(genes)), np.array([0.0, 0.0, 1.0])
        position = self.radius * np.stack([np.cos(place), np.sin(place), zero], axis=1)
        position[:, 2] = self.height
        direction = place + np.pi + turn
        inward = np.stack([np.cos(direction), np.sin(direction), zero], axis=1)
        level, steep = np.cos(self.tilt), np.sin(self.tilt)
        return poses_from(
            level * inward - steep * up, steep * inward + level * up, position
        )

    def quality(self, genes: Array) -> Array:
        """1 for all: fingers on both sides of the lip always close (paper, V)."""
        return np.ones(len(genes))
