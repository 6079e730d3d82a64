"""What a robot's inverse kinematics and collision checks cost and find, measured."""

from __future__ import annotations

from time import perf_counter
from typing import NamedTuple

import numpy as np

from mmplan.collision import CollisionWorld, Scenery
from mmplan.kinematics import joint_placements
from mmplan.robot import Robot
from mmplan.robot_setup.configurations import draw
from mmplan.shapes import Array


class IkMeasurement(NamedTuple):
    """Over `poses` that the arm can reach.

    `solved` is the share with a solution within the limits of the joints, `branches`
    the mean number of solutions of a pose, `error` the largest distance (m) of the
    tool from its pose at any of them, `seconds` the time of a pose.
    """

    poses: int
    solved: float
    branches: float
    error: float
    seconds: float


def measure_ik(robot: Robot, poses: int, seed: int = 0) -> IkMeasurement:
    """Measure the inverse kinematics on poses of random configurations."""
    T_base_tool = reachable_poses(robot, poses, np.random.default_rng(seed))
    robot.ik.solve(T_base_tool[:2])  # what is done once is not counted
    start = perf_counter()
    solutions = robot.ik.solve(T_base_tool)
    seconds = perf_counter() - start
    row, branch = np.nonzero(solutions.exists)
    q = np.tile(robot.q_neutral, (len(row), 1))
    q[:, robot.arm.indices] = solutions.q[row, branch]
    found = base_to_tool(robot, q)
    errors = np.linalg.norm(found[:, :3, 3] - T_base_tool[row, :3, 3], axis=1)
    return IkMeasurement(
        poses=poses,
        solved=float(solutions.within.any(axis=1).mean()),
        branches=float(solutions.exists.sum(axis=1).mean()),
        error=float(errors.max(initial=0.0)),
        seconds=seconds / poses,
    )


def reachable_poses(robot: Robot, n: int, rng: np.random.Generator) -> Array:
    """Poses T_base_tool (n, 4, 4) at random configurations of the arm."""
    return base_to_tool(robot, draw(robot, n, rng))


def base_to_tool(robot: Robot, q: Array) -> Array:
    """The poses T_base_tool (n, 4, 4) at configurations q (n, nq)."""
    T_world_joint = joint_placements(robot.model, q)
    T_world_tool = T_world_joint[:, robot.tool_joint] @ robot.T_joint_tool
    return np.asarray(
        np.linalg.solve(T_world_joint[:, robot.base_joint], T_world_tool), float
    )


def measure_collision(robot: Robot, configurations: int, seed: int = 0) -> float:
    """Seconds for a check of the robot against itself, of random configurations."""
    world = CollisionWorld(robot, Scenery((), frozenset(), {}), {})
    q = draw(robot, configurations, np.random.default_rng(seed))
    world.in_collision(q[:2])
    start = perf_counter()
    world.in_collision(q)
    return (perf_counter() - start) / configurations
