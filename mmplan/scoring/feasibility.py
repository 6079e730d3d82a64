"""Which bases and grasps are feasible at one end of a task, and in which configurations.

Feasible means free of collision with the hand closed on the object and with the hand
opened around it, as it must be just before grasping and just after releasing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.collision import CollisionWorld
from mmplan.problem import Problem
from mmplan.robot import Robot
from mmplan.scoring.outcome import Outcome
from mmplan.shapes import Array

Mask = npt.NDArray[np.bool_]


class Holds(NamedTuple):
    """Grasps of the object, ready for kinematics: one row for each."""

    T_object_tool: Array  # (n, 4, 4)
    opened: Array  # (n, hand joints)
    closed: Array  # (n, hand joints)
    outcome: npt.NDArray[np.int8]  # NO_CONTACT, LOW_QUALITY or SCORED, (n,)


class Feasible(NamedTuple):
    """What came of n pairs of base and grasp, and the m configurations that are left.

    `row` (m,) says which pair a configuration belongs to.
    """

    outcome: npt.NDArray[np.int8]  # (n,)
    row: npt.NDArray[np.int64]  # (m,)
    q: Array  # (m, nq), hand closed


class Feasibility:
    """The tests of one end of a task, cheapest first."""

    def __init__(
        self, problem: Problem, world: CollisionWorld, object_name: str
    ) -> None:
        """Prepare for a world in which the object stands at that end."""
        self._robot: Robot = problem.robot
        self._bounds = problem.base_bounds
        self._T_world_object = world.standing[object_name]
        self._open_world = world
        self._closed_world = world.permit_touch(object_name, fingers=True)
        self._base_world = world.base_alone()

    def base_outcomes(self, q_base: Array) -> npt.NDArray[np.int8]:
        """OUT_OF_BOUNDS, BASE_COLLISION or SCORED for base placements (n, b), (n,)."""
        q = np.tile(self._robot.q_neutral, (len(q_base), 1))
        q[:, self._robot.base.indices] = q_base
        outcome = np.full(len(q_base), Outcome.SCORED, np.int8)
        outcome[self._base_world.in_collision(q)] = Outcome.BASE_COLLISION
        low, high = self._bounds.T
        outside = np.any((q_base < low) | (q_base > high), axis=1)
        outcome[outside] = Outcome.OUT_OF_BOUNDS
        return outcome

    def __call__(self, q_base: Array, holds: Holds) -> Feasible:
        """Test bases (n, b), already free by themselves, with grasps, row by row."""
        q, exists, within = self._inverse_kinematics(q_base, holds)
        outcome = np.full(len(q_base), Outcome.NO_IK, np.int8)
        outcome[exists.any(axis=1)] = Outcome.JOINT_LIMITS
        outcome[within.any(axis=1)] = Outcome.COLLISION
        row, branch = np.nonzero(within)
        closed = q[row, branch]
        free = ~self._closed_world.in_collision(closed)
        row, closed = row[free], closed[free]
        outcome[row] = Outcome.HAND_OPEN_COLLISION
        opened = closed.copy()
        opened[:, self._robot.hand.indices] = holds.opened[row]
        free = ~self._open_world.in_collision(opened)
        row, closed = row[free], closed[free]
        outcome[row] = Outcome.SCORED
        return Feasible(outcome, row, closed)

    def _inverse_kinematics(
        self, q_base: Array, holds: Holds
    ) -> tuple[Array, Mask, Mask]:
        """All configurations (n, b, nq) that hold the object, and their masks (n, b)."""
        robot = self._robot
        T_world_base = robot.base_poses(q_base)
        T_base_tool = (
            np.linalg.inv(T_world_base) @ self._T_world_object @ holds.T_object_tool
        )
        solutions = robot.ik.solve(T_base_tool)
        n, branches = solutions.exists.shape
        q = np.tile(robot.q_neutral, (n, branches, 1))
        q[..., robot.base.indices] = q_base[:, None]
        q[..., robot.arm.indices] = solutions.q
        q[..., robot.hand.indices] = holds.closed[:, None]
        return q, solutions.exists, solutions.within
