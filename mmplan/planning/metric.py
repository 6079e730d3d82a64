"""How far configurations are apart: lever arms, and joints that turn without end."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from mmplan.planning.joints import MovingJoints
from mmplan.shapes import Array, read_only

_TURN = 2.0 * np.pi


@dataclass(frozen=True, eq=False)
class Metric:
    """Lengths in the space of configurations.

    A joint that wraps is where it is at every whole turn: values of it mean the same
    place on a circle, and a way between two is the short way round.
    """

    weights: Array  # (nq,), m per rad or per m
    wraps: npt.NDArray[np.bool_]  # (nq,)

    @classmethod
    def of_joints(cls, joints: MovingJoints, levers: Array) -> Metric:
        """The metric of moving joints with lever arms (nq,), m; others never wrap."""
        weights, wraps = levers.copy(), np.zeros(len(levers), dtype=np.bool_)
        weights[joints.indices] *= joints.costs
        wraps[joints.indices] = joints.wraps
        return cls(read_only(weights), wraps)

    def turns(self, q: Array, q_near: Array) -> Array:
        """The whole turns (..., nq) to add to q (..., nq) to be nearest to q_near."""
        if not self.any_wraps:
            return np.zeros(np.broadcast_shapes(q.shape, q_near.shape))
        turns: Array = np.where(self.wraps, _TURN * np.rint((q_near - q) / _TURN), 0.0)
        return turns

    @cached_property
    def any_wraps(self) -> bool:
        """Whether there is a joint that wraps."""
        return bool(self.wraps.any())

    def distances(self, q: Array, q_from: Array) -> Array:
        """The lengths (...,) of straight ways between configurations (..., nq)."""
        apart = (q + self.turns(q, q_from) - q_from) * self.weights
        lengths: Array = np.linalg.norm(apart, axis=-1)
        return lengths

    def unwrapped(self, path: Array) -> Array:
        """The path (n, nq) with whole turns added so that each edge is the short way.

        The first waypoint stays as it is.
        """
        path = path.copy()
        for i in range(1, len(path)) if self.any_wraps else ():
            path[i] += self.turns(path[i], path[i - 1])
        return path
