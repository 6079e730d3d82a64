"""Searching triples of start base, goal base and grasp as one joint vector."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.optimizers.archive import Archive, Triple, distinct
from mmplan.optimizers.optimizer import Queries, SearchSpace
from mmplan.scoring import End
from mmplan.shapes import Array

# What a joint vector is worth that works at its start alone: as little as the paper
# gives a grasp that works at exactly one end (section IV.B), and above nothing.
START_ONLY_VALUE = 1.0


class Triples(NamedTuple):
    """n start bases, goal bases and grasps that belong together."""

    starts: Array  # (n, base joints)
    goals: Array  # (n, base joints)
    grasps: Array  # (n, grasp genes)

    def queries(self, end: End) -> Queries:
        """Their evaluations at one end."""
        n = len(self.grasps)
        return Queries(np.full(n, end, np.int8), self[end], self.grasps)

    def rows(self, which: npt.NDArray[np.bool_]) -> Triples:
        """Some of them, by a mask (n,)."""
        return Triples(*(part[which] for part in self))


class JointSearch(ABC):
    """An optimizer that proposes whole triples and learns both of their scores.

    A triple costs one evaluation where its start already fails and two otherwise.
    """

    cycles = None

    def __init__(self, space: SearchSpace) -> None:
        """Start with nothing proposed."""
        self._space = space
        self._proposed: Triples | None = None
        self._start_totals: Array | None = None  # (n,), once told

    @abstractmethod
    def propose(self, most: int) -> Triples:
        """The next triples, at least one.

        At most `most` can still be evaluated at both ends; what is more may be cut off.
        """

    @abstractmethod
    def learn(self, scores: Array) -> None:
        """Take the scores (n, 2) at start and goal of all that was proposed last."""

    def ask(self, limit: int) -> Queries:
        """The starts of new triples, or the goals of those whose start is feasible."""
        if self._proposed is None or self._start_totals is None:
            self._proposed = self.propose((limit + 1) // 2)
            return self._proposed.queries(End.START).head(limit)
        feasible = self._start_totals > 0.0
        return self._proposed.rows(feasible).queries(End.GOAL).head(limit)

    def tell(self, totals: Array) -> None:
        """Take the scores at the start; with those at the goal, learn from both.

        What the budget cut off counts as 0; there is nothing to be asked for then.
        """
        assert self._proposed is not None
        if self._start_totals is None:
            self._start_totals = _filled(totals, len(self._proposed.grasps))
            if self._start_totals.any():
                return
        scores = np.zeros((len(self._start_totals), len(End)))
        scores[:, End.START] = self._start_totals
        feasible = self._start_totals > 0.0
        if feasible.any():
            scores[feasible, End.GOAL] = _filled(totals, int(feasible.sum()))
        self._start_totals = None
        self.learn(scores)

    def candidates(self, archive: Archive, most: int) -> list[Triple]:
        """The best triples evaluated; both ends are feasible."""
        return distinct(archive.triples(), self._space.grasps, most)


def sample_triples(space: SearchSpace, n: int, rng: np.random.Generator) -> Triples:
    """N triples, all parts drawn independently from annuli and bounds."""
    start, goal = (space.bases[end] for end in End)
    goals = goal.q_base(goal.sample(n, rng))
    starts = start.q_base(start.sample(n, rng))
    return Triples(starts, goals, space.grasps.sample(n, rng))


def joint_values(scores: Array) -> Array:
    """What triples with scores (n, 2) are worth to an optimizer of one number, (n,).

    The sum of both scores; `START_ONLY_VALUE` where the goal fails, so that no such
    triple passes for better than one that works; 0 where the start fails.
    """
    start, goal = scores.T
    one_end = np.where(start > 0.0, START_ONLY_VALUE, 0.0)
    return np.where((start > 0.0) & (goal > 0.0), start + goal, one_end)


def _filled(totals: Array, n: int) -> Array:
    """The scores, with zeros for what was not evaluated, (n,)."""
    return np.concatenate([totals, np.zeros(n - len(totals))])
