"""Paths that are searched at coarse steps and proven to be free all along."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from mmplan.planning.checking import PathChecker
from mmplan.planning.joints import MovingJoints
from mmplan.planning.metric import Metric
from mmplan.planning.search import Search, search
from mmplan.planning.upright import UprightWorld
from mmplan.planning.upright_search import UprightSearch
from mmplan.problem import PlannerSettings
from mmplan.shapes import Array

# So many iterations are spent on the way around an edge that collides after all.
_MENDING = 200
# Ways whose directions, unit vectors, differ by no more are one.
_STRAIGHT = 1e-9


@dataclass(frozen=True, eq=False)
class PathFinder:
    """Finds ways of some joints with a planner and its settings, from one seed."""

    joints: MovingJoints
    settings: PlannerSettings
    seed: int

    def find(
        self, checker: PathChecker, q_start: Array, q_goals: Array
    ) -> tuple[Search, Array | None]:
        """A search and the path (n, nq) found, free as far as the checker tells.

        The path leads from q_start (nq,) to one of q_goals (g, nq); None where there
        is none.
        """
        if checker.continuous:
            looking = checker.coarser()
            found, path = self._look(looking, q_start, q_goals)
            checker.states += looking.states
            checker.edges += looking.edges
            if path is not None:
                path = self._mended(checker, path)
            if found.waypoints is None or path is not None:
                return found, path
        return self._look(checker, q_start, q_goals)

    def _mended(self, checker: PathChecker, path: Array) -> Array | None:
        """The path (n, nq) with a way around for each edge that is not free.

        None where one is not found soon.
        """
        iterations = min(self.settings.iterations, _MENDING)
        soon = replace(self, settings=replace(self.settings, iterations=iterations))
        path = path.copy()
        parts = [path[:1]]
        for i, (q_from, q_to) in enumerate(pairwise(path), start=1):
            around: Array | None = path[i - 1 : i + 1]
            if not checker.edge_free(q_from, q_to, likely_free=True):
                _, around = soon._look(checker, q_from, q_to[None])
            if around is None:
                return None
            parts.append(around[1:])
            path[i:] += around[-1] - q_to  # whole turns
        return np.vstack(parts)

    def _look(
        self, checker: PathChecker, q_start: Array, q_goals: Array
    ) -> tuple[Search, Array | None]:
        """A search and the path (n, nq) that it found, as this checker sees it."""
        found = self._search(checker, q_start, q_goals)
        if found.waypoints is None:
            return found, None
        metric = Metric.of_joints(self.joints, checker.sweep.weights)
        path = metric.unwrapped(np.vstack([q_start, found.waypoints[1:]]))
        path = _with_exact_end(path, metric, q_goals)
        return found, _without_halts(path)

    def _search(self, checker: PathChecker, q_start: Array, q_goals: Array) -> Search:
        """By the planner wanted; where an object is kept upright, by our own."""
        joints, settings = self.joints, self.settings
        if isinstance(checker.world, UprightWorld):
            rng = np.random.default_rng(self.seed)
            own = UprightSearch(checker, checker.world.rule, joints, rng)
            return own.run(q_start, q_goals, settings)
        return search(checker, q_start, q_goals, joints, settings, self.seed)


def _with_exact_end(path: Array, metric: Metric, q_goals: Array) -> Array:
    """The path with the end asked for instead of what scaling made of it."""
    q_goals = q_goals + metric.turns(q_goals, path[-1])
    off = np.abs(q_goals - path[-1]).max(axis=1)
    return np.vstack([path[:-1], q_goals[np.argmin(off)]])


def _without_halts(path: Array) -> Array:
    """The path (n, nq) less the waypoints at which it goes straight on.

    Planners make a long way in steps of their range; it is proven sooner as one edge.
    """
    ways = np.diff(path, axis=0)
    lengths = np.linalg.norm(ways, axis=1)
    headings = ways / np.where(lengths > 0.0, lengths, 1.0)[:, None]
    turns = np.abs(np.diff(headings, axis=0)).max(axis=1, initial=0.0) > _STRAIGHT
    kept: Array = path[np.concatenate([[True], turns, [True]])]
    return kept
