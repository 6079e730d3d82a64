"""The best feasible configuration of each pair of base and grasp, found lazily."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.kinematics import ForwardKinematics
from mmplan.robot import Robot
from mmplan.scoring.clutter import Clutter
from mmplan.scoring.feasibility import Feasibility
from mmplan.scoring.manipulability import Manipulability
from mmplan.scoring.outcome import End, Outcome
from mmplan.scoring.selection import best_of_rows
from mmplan.scoring.term import Grasped
from mmplan.shapes import Array

Indices = npt.NDArray[np.int64]

# Configurations bounded in one go, so that the arrays stay in the cache.
_CHUNK = 256


class Branches(NamedTuple):
    """Configurations within the joint limits that reach pairs of base and grasp."""

    row: Indices  # (m,), the pair that each belongs to
    grasped: Grasped  # m configurations
    opened: Array  # (m, hand joints), before the hand closes
    quality: Array  # G, (m,)

    def take(self, places: Indices) -> Branches:
        """Some of them."""
        return Branches(
            self.row[places],
            self.grasped.take(places),
            self.opened[places],
            self.quality[places],
        )


class Best(NamedTuple):
    """The best feasible branch of each pair that has one."""

    place: Indices  # (k,), of the branch
    terms: Array  # (k, 3), weighted


class BranchSearch:
    """Rates branches: bounds of all at once, and in full only what can be the best.

    Grasp quality and manipulability are exact at once, clutter is bounded above.
    """

    def __init__(
        self,
        robot: Robot,
        feasibility: Mapping[End, Feasibility],
        clutter: Clutter,
        factors: Array,
    ) -> None:
        """Prepare for the `factors` (3,) of grasp quality, manipulability, clutter."""
        self._kinematics = ForwardKinematics(robot.model)
        self._manipulability = Manipulability(robot)
        self._feasibility = feasibility
        self._clutter = clutter
        self._factors = factors

    def best(self, branches: Branches, outcome: npt.NDArray[np.int8]) -> Best:
        """The branch of the greatest total of each pair, the first of equals.

        `outcome` (n,) of the pairs that have branches is raised to what the furthest
        of their branches came to.
        """
        terms = np.zeros((len(branches.row), 3))
        if len(terms) == 0:
            return Best(branches.row, terms)
        terms[:, 0] = branches.quality
        terms[:, 1], clutter = self._bounds(branches.grasped)
        terms *= self._factors
        bound = terms.sum(axis=1) + self._factors[2] * clutter

        def examine(places: Indices) -> Array:
            some = branches.take(places)
            feasibility = self._feasibility[some.grasped.end]
            found = feasibility.outcomes(some.grasped.q, some.opened)
            np.maximum.at(outcome, some.row, found)
            free = found == Outcome.SCORED
            C = self._clutter(some.grasped.take(np.flatnonzero(free)))
            terms[places[free], 2] = self._factors[2] * C
            return np.where(free, terms[places].sum(axis=1), -np.inf)

        place = best_of_rows(branches.row, bound, examine)
        return Best(place, terms[place])

    def _bounds(self, grasped: Grasped) -> tuple[Array, Array]:
        """M, (m,), and upper bounds of C, (m,)."""
        m = len(grasped.q)
        M, C = np.empty(m), np.empty(m)
        for start in range(0, m, _CHUNK):
            chunk = np.arange(start, min(start + _CHUNK, m))
            some = grasped.take(chunk)
            T = self._kinematics(some.q)
            M[chunk] = self._manipulability.at(T)
            C[chunk] = self._clutter.bound(some, T)
        return M, C
