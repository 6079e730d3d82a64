"""The pair of base and grasp whose tool comes nearest to where the grasp wants it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.explanation.near_miss import NearMiss, line_between
from mmplan.explanation.near_steps import Steps
from mmplan.kinematics import joint_placements
from mmplan.optimizers import Queries
from mmplan.scoring import End, Outcome, ScoreFunction
from mmplan.shapes import Array

_LOOKED_AT = 60  # pairs, those nearest to the arm's root
_LADDER = np.geomspace(0.01, 2.5, 16)  # m by which the tool may fall short, at first
_STEPS = 60  # of the descent to a nearer miss
_STEP = 0.2  # m, or the share of a grasp gene's range, at first
_SHORTER = (0.5, 0.8, 0.95)  # of the way missing, tried in each step


def nearest_reach(steps: Steps, queries: Queries) -> NearMiss | None:
    """The least way by which the tool falls short of a grasp, turned as that wants it.

    The way leads towards the arm's root, or straight up or down. It is sought among
    the queries, and by random steps from the best of them. None where the tool cannot
    be turned so anywhere near.
    """
    score, end = steps.score, steps.end
    attempts = _Attempts(score, end)
    best = attempts.least(_nearest(score, end, queries), _LADDER)
    if best is None:
        return None
    for size in steps.sizes(_STEP, _STEPS):
        pair = steps.taken(best.q_base, best.grasp, size)
        if score.base_outcomes(end, pair.q_base)[0] == Outcome.SCORED:
            best = attempts.least(pair, best.way * np.array(_SHORTER)) or best
    target = _targets(score, end, steps.pair(best.q_base, best.grasp))[0, :3, 3]
    return _miss(score, end, best, target)


@dataclass(frozen=True, eq=False)
class _Attempt:
    """The tool, short of a grasp by a way (m)."""

    way: float
    q: Array  # (nq,)
    q_base: Array  # (b,)
    grasp: Array  # (g,)


@dataclass(frozen=True)
class _Attempts:
    """Tries whether the arm reaches places short of grasps at one end."""

    score: ScoreFunction
    end: End

    def least(self, pairs: Queries, ways: Array) -> _Attempt | None:
        """The least of some rising ways (m) by which one of the pairs falls short."""
        if len(pairs.end) == 0:
            return None
        T = _targets(self.score, self.end, pairs)
        directions = _directions(_roots(self.score, pairs.q_base) - T[:, :3, 3])
        for way in ways.tolist():
            for direction in directions:
                found = self._reached(pairs, T, way * direction)
                if found is not None:
                    row, q = found
                    return _Attempt(way, q, pairs.q_base[row], pairs.grasps[row])
        return None

    def _reached(
        self, pairs: Queries, T: Array, offset: Array
    ) -> tuple[int, Array] | None:
        """The first pair that reaches its target T (n, 4, 4) moved by (n, 3), and q."""
        T = T.copy()
        T[:, :3, 3] += offset
        world = self.score.worlds[self.end]
        T_world_object = world.standing[self.score.task.object]
        T_object_tool = np.linalg.inv(T_world_object) @ T
        arms = self.score.arms_to(self.end, pairs.q_base, T_object_tool)
        rows, branches = np.nonzero(arms.within)
        if len(rows) == 0:
            return None
        q = arms.q[rows[0], branches[0]].copy()
        hand = self.score.problem.robot.hand
        q[hand.indices] = self.score.holds(pairs.grasps[rows[:1]]).opened[0]
        return int(rows[0]), q


def _nearest(score: ScoreFunction, end: End, queries: Queries) -> Queries:
    """Those of the queries whose grasps are nearest to the arm's root."""
    targets = _targets(score, end, queries)[:, :3, 3]
    away = np.linalg.norm(targets - _roots(score, queries.q_base), axis=1)
    return queries.take(np.argsort(away, kind="stable")[:_LOOKED_AT])


def _targets(score: ScoreFunction, end: End, pairs: Queries) -> Array:
    """Where the grasps want the tool, T_world_tool (n, 4, 4)."""
    T_world_object = score.worlds[end].standing[score.task.object]
    T: Array = T_world_object @ score.family.tool_poses(pairs.grasps)
    return T


def _roots(score: ScoreFunction, q_base: Array) -> Array:
    """Where the arm's first joint is in the world, (n, 3), m."""
    robot = score.problem.robot
    q = np.tile(robot.q_neutral, (len(q_base), 1))
    q[:, robot.base.indices] = q_base
    first = robot.model.getJointId(robot.arm.names[0])
    positions: Array = joint_placements(robot.model, q)[:, first, :3, 3]
    return positions


def _directions(way: Array) -> Array:
    """Unit vectors (3, n, 3): along ways (n, 3), level along them, up or down."""
    level, steep = way * [1.0, 1.0, 0.0], way * [0.0, 0.0, 1.0]
    directions = np.stack([way, level, steep])
    length = np.linalg.norm(directions, axis=2, keepdims=True)
    unit: Array = directions / np.where(length > 0.0, length, 1.0)
    return unit


def _miss(score: ScoreFunction, end: End, best: _Attempt, target: Array) -> NearMiss:
    robot = score.problem.robot
    return NearMiss(
        end=end,
        kind="reach",
        first=robot.model.frames[robot.tool_frame].name,
        second=score.task.object,
        amount=best.way,
        base=tuple(best.q_base.tolist()),
        grasp=tuple(best.grasp.tolist()),
        q=tuple(best.q.tolist()),
        line=line_between(robot.tool_pose(best.q)[:3, 3], target),
    )
