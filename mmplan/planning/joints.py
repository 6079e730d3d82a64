"""Which joints move along a path, and how far each may go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mmplan.problem import Problem
from mmplan.robot import Robot
from mmplan.shapes import Array, read_only


@dataclass(frozen=True, eq=False)
class MovingJoints:
    """The joints that a path may move; all others stand still."""

    names: tuple[str, ...]
    indices: npt.NDArray[np.int64]  # (k,), places in q
    lower: Array  # (k,), m or rad
    upper: Array  # (k,)

    def outside(self, q: Array) -> str | None:
        """What is beyond its limits at a configuration (nq,), in words."""
        for name, value, lower, upper in zip(
            self.names, q[self.indices], self.lower, self.upper, strict=True
        ):
            if not lower <= value <= upper:
                return f"{name} = {value:.6g} is outside [{lower:.6g}, {upper:.6g}]"
        return None


@dataclass(frozen=True, eq=False)
class MotionLimits:
    """How fast the joints may move, in the order of q."""

    velocity: Array  # (nq,), m/s or rad/s
    acceleration: Array  # (nq,), m/s^2 or rad/s^2


def transit_joints(problem: Problem) -> MovingJoints:
    """All joints: the robot moves alone."""
    return _moving_joints(problem, hand=True)


def transfer_joints(problem: Problem) -> MovingJoints:
    """Base and arm: the fingers hold an object and stay still."""
    return _moving_joints(problem, hand=False)


def motion_limits(robot: Robot) -> MotionLimits:
    """The robot's own velocity and acceleration limits."""
    velocity = np.full(robot.model.nq, np.inf)
    acceleration = np.full(robot.model.nq, np.inf)
    for group in (robot.base, robot.arm, robot.hand):
        velocity[group.indices] = group.velocity
        acceleration[group.indices] = group.acceleration
    return MotionLimits(read_only(velocity), read_only(acceleration))


def _moving_joints(problem: Problem, *, hand: bool) -> MovingJoints:
    """The joints of the groups that move; the base keeps to the problem's bounds."""
    robot = problem.robot
    base_lower, base_upper = problem.base_bounds.T
    groups = [robot.base, robot.arm, *([robot.hand] if hand else [])]
    lower = [np.maximum(robot.base.lower, base_lower), *(g.lower for g in groups[1:])]
    upper = [np.minimum(robot.base.upper, base_upper), *(g.upper for g in groups[1:])]
    return MovingJoints(
        names=tuple(name for g in groups for name in g.names),
        indices=np.concatenate([g.indices for g in groups]).astype(np.int64),
        lower=read_only(np.concatenate(lower)),
        upper=read_only(np.concatenate(upper)),
    )
