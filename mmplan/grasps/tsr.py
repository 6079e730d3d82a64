"""Task space regions: a frame, bounds on its motion, and the tool in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.shapes import Array

_FULL_TURN = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class TaskSpaceRegion:
    """Grasps from a task space region (Berenson, Srinivasa and Kuffner 2011).

    Six genes: the displacement x, y, z (m) and roll, pitch, yaw (rad, about the fixed
    axes x, y, z) of a frame w that stands at `T_object_w`, within `bounds`; the tool
    is at `T_w_tool` in the displaced frame. An angle that is free by a whole turn is
    periodic.
    """

    T_object_w: Array  # (4, 4)
    T_w_tool: Array  # (4, 4)
    bounds: Array  # (6, 2)

    @property
    def genes(self) -> GeneSpace:
        """The six displacements."""
        lower, upper = self.bounds.T
        turn = np.isclose(upper - lower, _FULL_TURN)
        return GeneSpace(lower, upper, turn & (np.arange(6) >= 3))

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4)."""
        return self.T_object_w @ displacements(genes) @ self.T_w_tool

    def quality(self, genes: Array) -> Array:
        """1 for all: whoever states a region vouches for it."""
        return np.ones(len(genes))


def displacements(values: Array) -> Array:
    """The poses (n, 4, 4) of x, y, z (m), roll, pitch and yaw (rad), (n, 6)."""
    cosine, sine = np.cos(values[:, 3:]).T, np.sin(values[:, 3:]).T
    (cr, cp, cy), (sr, sp, sy) = cosine, sine
    T = np.zeros((len(values), 4, 4))
    T[:, 0, :3] = np.stack([cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr], 1)
    T[:, 1, :3] = np.stack([sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr], 1)
    T[:, 2, :3] = np.stack([-sp, cp * sr, cp * cr], 1)
    T[:, :3, 3] = values[:, :3]
    T[:, 3, 3] = 1.0
    return T
