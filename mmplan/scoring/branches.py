"""The best feasible configuration of each pair of base and grasp, found lazily."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
from mmplan.scoring.term import Grasped, ScoreTerm
from mmplan.shapes import Array

Indices = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]

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
    """The best feasible configuration of each pair that has one."""

    row: Indices  # (k,), the pair
    q: Array  # (k, nq)
    terms: Array  # (k, terms), weighted


class BranchSearch:
    """Rates branches: bounds of all at once, and in full only what can be the best.

    Grasp quality, manipulability and, where it counts, the joints' margin are exact at
    once, clutter is bounded above.
    """

    def __init__(
        self,
        robot: Robot,
        feasibility: Mapping[End, Feasibility],
        clutter: Clutter,
        factors: Array,
        more: Sequence[ScoreTerm] = (),
    ) -> None:
        """Prepare for the `factors` of grasp quality, manipulability and clutter.

        After these come the factors of the terms in `more`.
        """
        self._more = more
        self._kinematics = ForwardKinematics(robot.model)
        self._manipulability = Manipulability(robot)
        self._feasibility = feasibility
        self._clutter = clutter
        self._factors = factors

    def best(self, branches: Branches, outcome: npt.NDArray[np.int8]) -> Best:
        """The branch of the greatest total of each pair, the first of equals.

        `outcome` (n,) of the pairs, COLLISION at first, is raised to what the furthest
        of their branches came to.
        """
        feasibility = self._feasibility[branches.grasped.end]
        hand = feasibility.hand_outcomes(branches.grasped, branches.opened)
        left = np.flatnonzero(hand != Outcome.COLLISION)
        branches, hand = branches.take(left), hand[left]
        fits = hand == Outcome.SCORED
        terms, bound = self._bounds(branches, fits)

        def examine(places: Indices) -> Array:
            some, open_fits = branches.take(places), fits[places]
            found = feasibility.outcomes(some.grasped.q, some.opened, open_fits)
            np.maximum.at(outcome, some.row, found)
            free = np.flatnonzero(found == Outcome.SCORED)
            C = self._clutter(some.grasped.take(free))
            terms[places[free], 2] = self._factors[2] * C
            value = np.full(len(places), -np.inf)
            value[free] = terms[places[free]].sum(axis=1)
            # Where the opened hand does not fit, one branch that is free but for that
            # says all there is to know.
            value[~open_fits & (found > Outcome.COLLISION)] = np.inf
            return value

        place = best_of_rows(branches.row, bound, examine)
        place = place[fits[place]]
        return Best(branches.row[place], branches.grasped.q[place], terms[place])

    def _bounds(self, branches: Branches, fits: Mask) -> tuple[Array, Array]:
        """Terms (m, terms), clutter left out, and upper bounds of totals, (m,).

        Both are 0 for those whose hand does not fit.
        """
        terms = np.zeros((len(fits), len(self._factors)))
        clutter = np.zeros(len(fits))
        places = np.flatnonzero(fits)
        for start in range(0, len(places), _CHUNK):
            chunk = places[start : start + _CHUNK]
            grasped = branches.grasped.take(chunk)
            T = self._kinematics(grasped.q)
            terms[chunk, 0] = branches.quality[chunk]
            terms[chunk, 1] = self._manipulability.at(T)
            clutter[chunk] = self._clutter.bound(grasped, T)
            for column, term in enumerate(self._more, start=3):
                terms[chunk, column] = _sound(term(grasped), term)
        terms *= self._factors
        return terms, terms.sum(axis=1) + np.maximum(self._factors[2] * clutter, 0.0)


def _sound(values: Array, term: ScoreTerm) -> Array:
    """The values of a term, which may be anybody's.

    Raises:
        ValueError: One is negative or not finite.
    """
    if not np.all(np.isfinite(values) & (values >= 0.0)):
        name = type(term).__name__
        raise ValueError(f"{name}: a value of this term is negative or not finite")
    return values
