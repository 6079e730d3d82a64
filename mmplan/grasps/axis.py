"""Grasps across the principal axis: the paper's family for the wineglass."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.grasps.family import poses_from
from mmplan.shapes import Array


@dataclass(frozen=True)
class Axis:
    """The target point lies on the object's z axis, the approach is perpendicular.

    Two genes (paper, section V): the height of the target point along the axis, in m,
    within `along`, and the direction about the axis from which the hand comes, in rad.
    """

    along: tuple[float, float]

    @property
    def genes(self) -> GeneSpace:
        """Height and direction."""
        low, high = self.along
        return GeneSpace(
            np.array([low, -np.pi]), np.array([high, np.pi]), np.array([False, True])
        )

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4): y is perpendicular to the axis, too."""
        height, angle = genes.T
        zero = np.zeros(len(genes))
        approach = np.stack([-np.cos(angle), -np.sin(angle), zero], axis=1)
        closing = np.stack([-np.sin(angle), np.cos(angle), zero], axis=1)
        return poses_from(approach, closing, np.stack([zero, zero, height], axis=1))

    def quality(self, genes: Array) -> Array:
        """1 for all: fingers on both sides of the axis always close (paper, V)."""
        return np.ones(len(genes))
