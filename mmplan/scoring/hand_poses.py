"""Where the hand's joints are, from the tool's pose alone."""

from __future__ import annotations

import numpy as np

from mmplan.kinematics import ForwardKinematics
from mmplan.robot import Robot
from mmplan.shapes import Array


class HandPoses:
    """Poses of the joints that move with the tool, whatever arm holds them there.

    What depends on the grasp alone is computed from these, and so comes out the same,
    to the last bit, for every base that the grasp is met with.
    """

    def __init__(self, robot: Robot) -> None:
        """Prepare for one robot."""
        self._robot = robot
        self._kinematics = ForwardKinematics(robot.model)
        T_world_tool = robot.tool_pose(robot.q_neutral)
        self._T_tool_world = np.linalg.inv(T_world_tool)

    def __call__(self, T_world_tool: Array, q: Array) -> Array:
        """Poses (n, njoints, 4, 4) at tool poses (n, 4, 4), the hand as in q (n, nq).

        Those of joints that do not move with the tool are of no meaning.
        """
        alone = np.tile(self._robot.q_neutral, (len(q), 1))
        hand = self._robot.hand.indices
        alone[:, hand] = q[:, hand]
        moved = T_world_tool @ self._T_tool_world
        return moved[:, None] @ self._kinematics(alone)
