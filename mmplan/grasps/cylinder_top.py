"""Grasps around the end of a round body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.grasps.family import poses_from
from mmplan.shapes import Array


@dataclass(frozen=True)
class CylinderTop:
    """The hand comes along the object's z axis and closes around its end.

    Two genes: how far the target point lies inside the end, in m, within `depth`, and
    the turn of the hand about the axis, in rad. The end is at z = `end` (m); `below`
    says that it is the lower one, to which the hand comes from below.
    """

    end: float
    depth: tuple[float, float]
    below: bool = False

    @property
    def genes(self) -> GeneSpace:
        """Depth and turn."""
        low, high = self.depth
        return GeneSpace(
            np.array([low, -np.pi]), np.array([high, np.pi]), np.array([False, True])
        )

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4)."""
        depth, turn = genes.T
        zero, one = np.zeros(len(genes)), np.ones(len(genes))
        inward = 1.0 if self.below else -1.0
        approach = np.stack([zero, zero, inward * one], axis=1)
        closing = np.stack([np.cos(turn), np.sin(turn), zero], axis=1)
        position = np.stack([zero, zero, self.end + inward * depth], axis=1)
        return poses_from(approach, closing, position)

    def quality(self, genes: Array) -> Array:
        """1 for all: fingers on both sides of the axis always close."""
        return np.ones(len(genes))
