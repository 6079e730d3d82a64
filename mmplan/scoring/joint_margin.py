"""How far the arm's joints stay from their limits."""

from __future__ import annotations

import numpy as np

from mmplan.robot import Robot
from mmplan.scoring.term import Grasped
from mmplan.shapes import Array


class JointMargin:
    """The margin of the arm's joints as a term of the score."""

    def __init__(self, robot: Robot) -> None:
        """Prepare for one robot."""
        self._robot = robot

    def __call__(self, grasped: Grasped) -> Array:
        """The margin of each configuration, (n,)."""
        return joint_margin(self._robot, grasped.q)


def joint_margin(robot: Robot, q: Array) -> Array:
    """The margin of configurations q (n, nq), (n,), from 0 to 1.

    It is that of the arm's joint nearest to a limit: its distance from there as a share
    of half its range, 1 in the middle and 0 at a limit. Joints without limits do not
    count.
    """
    arm = robot.arm
    limited = ~arm.wraps
    lower, upper = arm.lower[limited], arm.upper[limited]
    at = q[:, arm.indices[limited]]
    nearest = np.minimum(at - lower, upper - at) / (0.5 * (upper - lower))
    margin: Array = np.clip(nearest.min(axis=1, initial=1.0), 0.0, 1.0)
    return margin
