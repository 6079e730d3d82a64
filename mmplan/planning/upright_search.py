"""A search for paths along which a carried object stays upright.

Two trees that grow towards each other (RRT-Connect; J. Kuffner and S. LaValle, ICRA
2000), and all that is added to them is projected to where the rule holds, as in CBiRRT:
D. Berenson, S. Srinivasa, D. Ferguson and J. Kuffner, "Manipulation planning on
constraint manifolds", ICRA 2009. The smaller one has the turn, as with `Turns`. OMPL's
planners know nothing of the rule: few of their straight edges would keep it.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from mmplan.collision import planning_clock
from mmplan.planning.checking import PathChecker
from mmplan.planning.joints import MovingJoints
from mmplan.planning.metric import Metric
from mmplan.planning.search import SAME_STATE, Search
from mmplan.planning.upright import UprightRule
from mmplan.problem import PlannerSettings
from mmplan.shapes import Array

# How far apart the configurations are that are projected, m of weighted length.
STEP = 0.05
# Projected, neighbours must not be farther apart than this many steps.
MOST_APART = 2.0
# What adds less than this share of a step to a tree is not worth adding.
_LEAST_PROGRESS = 0.5
# So many configurations are projected and checked at once.
_AT_ONCE = 8
# So many random configurations are made at once.
_DRAWN = 64


class Tree:
    """Configurations connected to the roots, with the ways by which they are."""

    def __init__(self, roots: Array) -> None:
        """Begin with the roots (r, nq)."""
        self._q = np.array(roots)
        self.size = len(roots)
        self._parents = [-1] * len(roots)
        self._ways: list[Array] = [roots[i : i + 1] for i in range(len(roots))]

    @property
    def q(self) -> Array:
        """All configurations (size, nq)."""
        return self._q[: self.size]

    def add(self, parent: int, way: Array) -> int:
        """Add the end of a way (n, nq) on from a parent, which is left out."""
        if self.size == len(self._q):
            self._q = np.concatenate([self._q, np.empty_like(self._q)])
        self._q[self.size] = way[-1]
        self._parents.append(parent)
        self._ways.append(way)
        self.size += 1
        return self.size - 1

    def path(self, node: int) -> Array:
        """The way (n, nq) from a root to a node."""
        ways = []
        while node >= 0:
            ways.append(self._ways[node])
            node = self._parents[node]
        return np.concatenate(ways[::-1])


class UprightSearch:
    """One search, from a start to any of several goals, all of them sound."""

    def __init__(
        self,
        checker: PathChecker,
        rule: UprightRule,
        joints: MovingJoints,
        rng: np.random.Generator,
    ) -> None:
        """Prepare to move some joints under a rule, in the checker's world."""
        self._checker = checker
        self._rule = rule
        self._joints = joints
        self._rng = rng
        self.metric = Metric.of_joints(joints, checker.sweep.weights)

    def run(self, q_start: Array, q_goals: Array, settings: PlannerSettings) -> Search:
        """Search a path from q_start (nq,) to any of q_goals (g, nq).

        The time limit is one of CPU time: another path, or none, for the machine being
        busy would be a plan that cannot be repeated.
        """
        deadline = planning_clock() + settings.time_limit
        trees = Tree(q_start[None]), Tree(q_goals)
        longest = settings.longest_edge
        samples = self._samples(q_start)
        iterations, late, way = 0, False, None
        tries = [0, 0]
        while way is None and iterations < settings.iterations and not late:
            one, other = trees if iterations % 2 == 0 else trees[::-1]
            if one.size > other.size:
                one, other = other, one
            tries[one is trees[1]] += 1
            iterations += 1
            node = self._grow(one, next(samples), longest, longest)
            if node is not None:
                meeting = self._grow(other, one.q[node], np.inf, longest)
                way = self._joined(trees, one, node, meeting)
            late = planning_clock() > deadline
        q = trees[0].q
        gap = self.metric.distances(q[None], q_goals[:, None]).min()
        return Search(
            waypoints=way,
            iterations=iterations,
            out_of_time=late,
            gap=float(gap),
            start_tree=trees[0].size,
            goal_tree=trees[1].size,
            tries=(tries[0], tries[1]),
        )

    def _joined(
        self, trees: tuple[Tree, Tree], one: Tree, node: int, meeting: int | None
    ) -> Array | None:
        """The path from start to goal if the last nodes of the trees are the same."""
        if meeting is None:
            return None
        start, goal = trees
        here, there = (node, meeting) if one is start else (meeting, node)
        if self.metric.distances(start.q[here], goal.q[there]) > SAME_STATE:
            return None
        path = np.concatenate([start.path(here), goal.path(there)[::-1][1:]])
        return self.metric.unwrapped(path)

    def _grow(self, tree: Tree, q: Array, longest: float, edge: float) -> int | None:
        """The last node that is added to a tree on the way towards q (nq,), if any.

        It goes no farther than `longest`, in edges no longer than `edge`, m.
        """
        node = int(np.argmin(self.metric.distances(tree.q, q)))
        added, left = None, longest
        while left > 0.0:
            way = self.way(tree.q[node], q, min(left, edge))
            before = float(self.metric.distances(tree.q[node], q))
            after = float(self.metric.distances(way[-1], q)) if len(way) else before
            if after > before - min(before, _LEAST_PROGRESS * STEP) * (1.0 - 1e-9):
                break
            added = node = tree.add(node, way)
            left -= min(left, edge)
            if after <= SAME_STATE:
                break
        return added

    def way(self, q_from: Array, q_to: Array, longest: float) -> Array:
        """How far one comes from q_from (nq,) towards q_to, q_from left out, (n, nq).

        The straight way, of which every configuration is projected; it ends where
        neighbours come to lie apart, or where something is hit.
        """
        dq = q_to + self.metric.turns(q_to, q_from) - q_from
        length = float(self.metric.distances(q_to, q_from))
        share = min(1.0, longest / max(length, SAME_STATE))
        steps = max(1, int(np.ceil(share * length / STEP)))
        path = q_from[None]
        for first in range(0, steps, _AT_ONCE):
            k = np.arange(first, min(first + _AT_ONCE, steps)) + 1
            straight = q_from + share * (k / steps)[:, None] * dq
            part = self._sound(path[-1], straight, q_from + dq)
            path = np.vstack([path, part])
            if len(part) < len(k):
                break
        return path[1:]

    def _sound(self, q_from: Array, straight: Array, q_to: Array) -> Array:
        """The first of the configurations (n, nq), projected, that can be gone along.

        From q_from (nq,) on, nearer and nearer to q_to (nq,).
        """
        weights = self.metric.weights
        q, obeys = self._rule.project(straight, self._joints, weights)
        steps = np.diff(q, axis=0, prepend=q_from[None]) * weights
        left = np.linalg.norm((np.vstack([q_from, q]) - q_to) * weights, axis=1)
        sound = obeys & (np.diff(left) < 0.0)
        sound &= np.linalg.norm(steps, axis=1) <= MOST_APART * STEP
        good = len(q) if sound.all() else int(np.argmin(sound))
        path = np.vstack([q_from, q[:good]])
        blocked = self._checker.first_blocked_edge(path) if good else None
        if blocked is not None:
            path = path[: blocked[0] + 1]
        if self._checker.continuous:
            edge_free = self._checker.edge_free
            free = [edge_free(*edge, likely_free=True) for edge in pairwise(path)]
            path = path[: free.index(False) + 1] if False in free else path
        return path[1:]

    def _samples(self, q_still: Array) -> Iterator[Array]:
        """Random configurations (nq,): a half upright, a half in exempt regions.

        Those in the regions are half upright and half not. The other joints are as in
        q_still (nq,).
        """
        rule, joints, weights = self._rule, self._joints, self.metric.weights
        regions = rule.upright.exempt
        lower = np.where(joints.wraps, -np.pi, joints.lower)
        upper = np.where(joints.wraps, np.pi, joints.upper)
        while True:
            q = np.tile(q_still, (_DRAWN, 1))
            shape = (_DRAWN, len(lower))
            q[:, joints.indices] = self._rng.uniform(lower, upper, shape)
            q = joints.with_followers(q)
            inside = _DRAWN // 2 if regions else 0
            if inside:
                points = self._points(inside)
                q[:inside] = rule.brought(q[:inside], points, joints, weights)
            q[inside // 2 :], _ = rule.project(q[inside // 2 :], joints, weights)
            yield from q[self._rng.permutation(_DRAWN)]

    def _points(self, count: int) -> Array:
        """Random points (count, 3) in the exempt regions, each region as likely."""
        regions = self._rule.upright.exempt
        chosen = self._rng.integers(len(regions), size=count)
        local = self._rng.uniform(-0.5, 0.5, (count, 3))
        points = [
            regions[k].T_world_region[:3, :3] @ (regions[k].size * x)
            + regions[k].T_world_region[:3, 3]
            for k, x in zip(chosen, local, strict=True)
        ]
        return np.array(points)


def thinned(path: Array, checker: PathChecker) -> Array:
    """The path (n, nq) less waypoints that straight edges can do without.

    From each waypoint farther and farther ones are tried, twice as far each time.
    """
    kept, here = [path[0]], 0
    while here < len(path) - 1:
        there, ahead = here + 1, 2
        while there < len(path) - 1:
            tried = min(here + ahead, len(path) - 1)
            if not checker.edge_free(path[here], path[tried]):
                break
            there, ahead = tried, 2 * ahead
        kept.append(path[there])
        here = there
    return np.array(kept)
