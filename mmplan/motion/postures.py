"""Postures of the arm in which a base may drive."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mmplan.kinematics import joint_placements
from mmplan.planning import PlanningWorld
from mmplan.robot import Robot
from mmplan.shapes import Array

# So many postures are drawn beside those that are known by name.
_DRAWN = 200
# So many of all that are free at both ends of the drive are tried.
_TRIED = 4


def drive_postures(
    robot: Robot,
    world: PlanningWorld,
    q_start: Array,
    q_goal: Array,
    rng: np.random.Generator,
) -> Iterator[Array]:
    """Postures of the arm (arm joints,), free with the base at either end.

    Those of the two configurations (nq,), those that the robot file names and some at
    random; the ones that reach out least come first. The hand is as at the start.
    """
    arm, base = robot.arm, robot.base.indices
    lower = np.where(arm.wraps, -np.pi, arm.lower)
    upper = np.where(arm.wraps, np.pi, arm.upper)
    known = [q_start[arm.indices], q_goal[arm.indices], *robot.configurations.values()]
    postures = np.vstack([*known, rng.uniform(lower, upper, (_DRAWN, len(arm)))])
    q = np.tile(q_start, (len(postures), 1))
    q[:, arm.indices] = postures
    q_there = q.copy()
    q_there[:, base] = q_goal[base]
    free = np.flatnonzero(~(world.in_collision(q) | world.in_collision(q_there)))
    order = free[np.argsort(_reach(robot, q[free]), kind="stable")]
    yield from postures[order[:_TRIED]]


def _reach(robot: Robot, q: Array) -> Array:
    """How far out joints and tool are from the base's centre at q (n, nq), (n,), m."""
    T = joint_placements(robot.model, q)
    tool = T[:, robot.tool_joint] @ robot.T_joint_tool
    points = np.concatenate([T[:, :, :2, 3], tool[:, None, :2, 3]], axis=1)
    moved = [j for j in range(1, robot.model.njoints) if j > robot.base_joint]
    centre = T[:, robot.base_joint, None, :2, 3]
    reach: Array = np.linalg.norm(points[:, [*moved, -1]] - centre, axis=2).max(axis=1)
    return reach
