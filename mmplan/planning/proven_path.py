"""Paths that are searched at coarse steps and proven to be free all along."""

from __future__ import annotations

from dataclasses import replace
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


def proven_path(
    checker: PathChecker,
    q_start: Array,
    q_goals: Array,
    joints: MovingJoints,
    settings: PlannerSettings,
    seed: int,
) -> tuple[Search, Array | None]:
    """A search and the path (n, nq) that it found, free as far as the checker tells.

    The path leads from q_start (nq,) to one of q_goals (g, nq); None where there is
    none.
    """
    if checker.continuous:
        looking = checker.coarser()
        found, path = _found(looking, q_start, q_goals, joints, settings, seed)
        checker.states += looking.states
        checker.edges += looking.edges
        if path is not None:
            path = _mended(checker, path, joints, settings, seed)
        if found.waypoints is None or path is not None:
            return found, path
    return _found(checker, q_start, q_goals, joints, settings, seed)


def _found(
    checker: PathChecker,
    q_start: Array,
    q_goals: Array,
    joints: MovingJoints,
    settings: PlannerSettings,
    seed: int,
) -> tuple[Search, Array | None]:
    """A search and the path (n, nq) that it found."""
    found = _search(checker, q_start, q_goals, joints, settings, seed)
    if found.waypoints is None:
        return found, None
    metric = Metric.of_joints(joints, checker.sweep.weights)
    path = metric.unwrapped(np.vstack([q_start, found.waypoints[1:]]))
    return found, _with_exact_end(path, metric, q_goals)


def _mended(
    checker: PathChecker,
    path: Array,
    joints: MovingJoints,
    settings: PlannerSettings,
    seed: int,
) -> Array | None:
    """The path (n, nq) with a way around for each edge that is not free.

    None where one is not found soon.
    """
    few = replace(settings, iterations=min(settings.iterations, _MENDING))
    path = path.copy()
    parts = [path[:1]]
    for i, (q_from, q_to) in enumerate(pairwise(path), start=1):
        around: Array | None = path[i - 1 : i + 1]
        if not checker.edge_free(q_from, q_to):
            _, around = _found(checker, q_from, q_to[None], joints, few, seed)
        if around is None:
            return None
        parts.append(around[1:])
        path[i:] += around[-1] - q_to  # whole turns
    return np.vstack(parts)


def _search(
    checker: PathChecker,
    q_start: Array,
    q_goals: Array,
    joints: MovingJoints,
    settings: PlannerSettings,
    seed: int,
) -> Search:
    """A search by the planner wanted; where an object is kept upright, by our own."""
    if isinstance(checker.world, UprightWorld):
        rng = np.random.default_rng(seed)
        own = UprightSearch(checker, checker.world.rule, joints, rng)
        return own.run(q_start, q_goals, settings)
    return search(checker, q_start, q_goals, joints, settings, seed)


def _with_exact_end(path: Array, metric: Metric, q_goals: Array) -> Array:
    """The path with the end asked for instead of what scaling made of it."""
    q_goals = q_goals + metric.turns(q_goals, path[-1])
    off = np.abs(q_goals - path[-1]).max(axis=1)
    return np.vstack([path[:-1], q_goals[np.argmin(off)]])
