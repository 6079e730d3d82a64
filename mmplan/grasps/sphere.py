"""Grasps of a ball from anywhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.grasps.family import poses_from
from mmplan.shapes import Array


@dataclass(frozen=True)
class SphereGrasps:
    """The target point is the middle, the approach any direction.

    Three genes: the direction from which the hand comes as its angle about z, in rad,
    and as the cosine of its angle to z, so that all directions are drawn alike; and
    the turn of the hand about its approach, in rad.
    """

    centre: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def genes(self) -> GeneSpace:
        """Azimuth, cosine of the polar angle, turn."""
        return GeneSpace(
            np.array([-np.pi, -1.0, -np.pi]),
            np.array([np.pi, 1.0, np.pi]),
            np.array([True, False, True]),
        )

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4)."""
        azimuth, cosine, turn = genes.T
        sine = np.sqrt(np.maximum(1.0 - cosine**2, 0.0))
        ca, sa = np.cos(azimuth), np.sin(azimuth)
        east = np.stack([-sa, ca, np.zeros(len(genes))], axis=1)
        north = np.stack([-cosine * ca, -cosine * sa, sine], axis=1)
        approach = -np.stack([sine * ca, sine * sa, cosine], axis=1)
        closing = np.cos(turn)[:, None] * east + np.sin(turn)[:, None] * north
        position = np.tile(np.array(self.centre), (len(genes), 1))
        return poses_from(approach, closing, position)

    def quality(self, genes: Array) -> Array:
        """1 for all: fingers on both sides of the middle always close."""
        return np.ones(len(genes))
