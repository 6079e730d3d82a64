"""Grasps of a straight bar: handles, stems and sticks anywhere on an object."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.grasps.family import poses_from
from mmplan.shapes import Array

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Handle:
    """The target point lies on a line, the approach is perpendicular to it.

    Two genes: the place on the line as a share of the way from `start` to `end`, and
    the direction from which the hand comes, as its angle about the line to `outward`,
    in rad, at most `spread` either way. `outward` points from the object to the free
    side of the bar; what of it lies along the bar is left out. The fingers close
    across the bar.
    """

    start: Point
    end: Point
    outward: Point
    spread: float = np.pi / 3

    @property
    def genes(self) -> GeneSpace:
        """Place and direction."""
        whole_turn = self.spread >= np.pi
        return GeneSpace(
            np.array([0.0, -self.spread]),
            np.array([1.0, self.spread]),
            np.array([False, whole_turn]),
        )

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4)."""
        place, turn = genes[:, :1], genes[:, 1:]
        along = np.subtract(self.end, self.start)
        bar = along / np.linalg.norm(along)
        outward = np.array(self.outward) - np.dot(self.outward, bar) * bar
        outward /= np.linalg.norm(outward)
        beside = np.cross(bar, outward)
        approach = -(np.cos(turn) * outward + np.sin(turn) * beside)
        closing = np.cross(bar, approach)
        return poses_from(approach, closing, np.array(self.start) + place * along)

    def quality(self, genes: Array) -> Array:
        """1 for all: fingers on both sides of a bar always close."""
        return np.ones(len(genes))
