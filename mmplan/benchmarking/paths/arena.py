"""A robot among the obstacles of one path problem, ready to plan in."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mmplan.benchmarking.paths.problems import PathProblem
from mmplan.collision import CollisionWorld, Scenery
from mmplan.collision.solids import solids_of_obstacle
from mmplan.planning import MovingJoints
from mmplan.problem import Obstacle
from mmplan.robot import Robot
from mmplan.robot_build import load_robot
from mmplan.shapes import Array, read_only

# The robot of MotionBenchMaker's problems, and how far open its hand is (m a finger).
# That is what VAMP's model has, with which the problems come; at 0.04, the most that
# the real hand can do, the fingers collide with a cube at 6 of the 70 goals.
PANDA = Path(__file__).with_name("panda.yaml")
PANDA_HAND = (0.065,)


@dataclass(frozen=True, eq=False)
class Arena:
    """What a planner is given: the world, what moves in it, and both ends."""

    world: CollisionWorld
    joints: MovingJoints
    q_start: Array  # (nq,)
    q_goal: Array


def panda() -> Robot:
    """The robot of MotionBenchMaker's problems."""
    return load_robot(PANDA)


def make_arena(
    robot: Robot, problem: PathProblem, hand: tuple[float, ...] = PANDA_HAND
) -> Arena:
    """The world of a problem; the hand's leading joints stand still at `hand`."""
    solids = tuple(
        s for o in _distinct(problem.obstacles) for s in solids_of_obstacle(o)
    )
    world = CollisionWorld(robot, Scenery(solids, frozenset(), {}), {})
    q = np.zeros(robot.model.nq)
    q[robot.hand.indices[robot.hand.leads]] = hand
    ends = np.stack([q, q])
    ends[:, robot.arm.indices] = problem.q_start, problem.q_goal
    q_start, q_goal = (read_only(robot.with_followers(q)) for q in ends)
    return Arena(world, MovingJoints.of_groups([robot.arm]), q_start, q_goal)


def _distinct(obstacles: tuple[Obstacle, ...]) -> list[Obstacle]:
    """The obstacles with a name each."""
    return [replace(o, name=f"{o.name} {i}") for i, o in enumerate(obstacles)]
