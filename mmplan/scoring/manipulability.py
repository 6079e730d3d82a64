"""Configuration desirability: the manipulability M."""

from __future__ import annotations

import numpy as np

from mmplan.kinematics import ForwardKinematics, FrameJacobians
from mmplan.robot import Robot
from mmplan.scoring.term import Grasped
from mmplan.shapes import Array


class Manipulability:
    """M = min(eigs(J Jᵀ)) (paper, eq. 1), J the arm's Jacobian at the tool.

    J is in metres and radians; the axes it is expressed in do not change M.
    """

    def __init__(self, robot: Robot) -> None:
        """Prepare for one robot."""
        self._kinematics = ForwardKinematics(robot.model)
        self._jacobians = FrameJacobians(
            robot.model, robot.tool_frame, robot.arm.indices
        )

    def __call__(self, grasped: Grasped) -> Array:
        """M of each configuration, (n,)."""
        return self.at(self._kinematics(grasped.q))

    def at(self, T_world_joint: Array) -> Array:
        """M, (n,), from the poses (n, njoints, 4, 4) of all joints."""
        J = self._jacobians(T_world_joint)  # (n, 6, k)
        smallest = np.linalg.eigvalsh(J @ J.transpose(0, 2, 1))[:, 0]
        M: Array = np.maximum(smallest, 0.0).astype(np.float64)
        return M


def manipulability(robot: Robot, q: Array) -> Array:
    """The smallest eigenvalue of J Jᵀ at configurations q (n, nq), (n,)."""
    return Manipulability(robot).at(ForwardKinematics(robot.model)(q))
