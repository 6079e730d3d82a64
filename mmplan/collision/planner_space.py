"""What a planner's own coordinates mean."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from mmplan.collision.pairs import Indices
from mmplan.robot import Follower
from mmplan.shapes import Array

# A share of a step beyond a whole number of them that is rounding.
ROUNDING = 1e-9


class PlannerSpace(NamedTuple):
    """How coordinates become configurations, and edges steps.

    A coordinate belongs to the joint at its place and is divided by this joint's scale.
    Edges go the short way round where a joint wraps. They are cut into steps of which
    none moves any point farther than `resolution` (m), going by the lever arms.
    """

    places: Indices  # (k,), places in q
    q_still: Array  # (nq,), of joints that have no coordinate
    scales: Array  # (nq,), m/rad or 1
    wraps: Array  # (nq,), 1 or 0
    levers: Array  # (rows, nq), m/rad or m/m
    followers: tuple[Follower, ...]
    resolution: float

    @property
    def rows(self) -> Array:
        """Still values, scales, wraps and lever arms, (3 + rows, nq)."""
        return np.vstack([self.q_still, self.scales, self.wraps, self.levers])
