"""What a grasp family is."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.shapes import Array


class GraspFamily(Protocol):
    """Grasps of one object that differ in a few genes."""

    @property
    def genes(self) -> GeneSpace:
        """The bounds of the genes."""
        ...

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4) that genes (n, d) stand for."""
        ...

    def quality(self, genes: Array) -> Array:
        """The grasp quality G in [0, 1] of genes (n, d), (n,)."""
        ...


def poses_from(approach: Array, closing: Array, position: Array) -> Array:
    """Tool poses (n, 4, 4) from z and y axes and origins, each (n, 3), orthonormal."""
    T = np.zeros((len(position), 4, 4))
    T[:, :3, 0] = np.cross(closing, approach)
    T[:, :3, 1] = closing
    T[:, :3, 2] = approach
    T[:, :3, 3] = position
    T[:, 3, 3] = 1.0
    return T
