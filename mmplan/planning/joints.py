"""Which joints move along a path, and how far each may go."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from mmplan.planning.path_limit import PathLimit
from mmplan.problem import Problem
from mmplan.robot import Follower, JointGroup, Robot
from mmplan.shapes import Array, read_only


@dataclass(frozen=True, eq=False)
class MovingJoints:
    """The joints that a path may move; all others stand still.

    But for `followers`, which go with those that they mimic. A joint that `wraps` is
    the same at every whole turn and has no limits. `costs` say how much more a way of
    a joint counts than the way of the robot's points that it moves.
    """

    names: tuple[str, ...]
    indices: npt.NDArray[np.int64]  # (k,), places in q
    lower: Array  # (k,), m or rad
    upper: Array  # (k,)
    wraps: npt.NDArray[np.bool_]  # (k,)
    costs: Array  # (k,), above 0
    followers: tuple[Follower, ...] = ()

    @classmethod
    def of_groups(
        cls, groups: Sequence[JointGroup], costs: Sequence[float] | None = None
    ) -> MovingJoints:
        """All joints of some groups that follow no others; one cost a group."""
        costs = costs or [1.0] * len(groups)
        leads = np.concatenate([g.leads for g in groups])
        names = [name for g in groups for name in g.names]
        every = [np.full(len(g), cost) for g, cost in zip(groups, costs, strict=True)]
        return cls(
            names=tuple(n for n, lead in zip(names, leads, strict=True) if lead),
            indices=np.concatenate([g.indices for g in groups])[leads].astype(np.int64),
            lower=read_only(np.concatenate([g.lower for g in groups])[leads]),
            upper=read_only(np.concatenate([g.upper for g in groups])[leads]),
            wraps=np.concatenate([g.wraps for g in groups])[leads],
            costs=read_only(np.concatenate(every)[leads]),
            followers=tuple(f for g in groups for f in g.followers),
        )

    def with_followers(self, q: Array) -> Array:
        """Configurations (..., nq) with the followers where their leaders take them."""
        if not self.followers:
            return q
        q = q.copy()
        for follower, leader, multiplier, offset in self.followers:
            q[..., follower] = multiplier * q[..., leader] + offset
        return q

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
    """How fast and how far the joints may move, in the order of q.

    `more` are limits that are not those of single joints.
    """

    velocity: Array  # (nq,), m/s or rad/s
    acceleration: Array  # (nq,), m/s^2 or rad/s^2
    lower: Array | float = -np.inf  # (nq,), m or rad
    upper: Array | float = np.inf
    more: tuple[PathLimit, ...] = ()


def transit_joints(problem: Problem) -> MovingJoints:
    """All joints: the robot moves alone."""
    return _moving_joints(problem, base=True, hand=True)


def transfer_joints(problem: Problem) -> MovingJoints:
    """Base and arm: the fingers hold an object and stay still."""
    return _moving_joints(problem, base=True, hand=False)


def standing_joints(problem: Problem, *, hand: bool) -> MovingJoints:
    """The arm, with the hand if wanted: the base stands still."""
    return _moving_joints(problem, base=False, hand=hand)


def motion_limits(robot: Robot, more: tuple[PathLimit, ...] = ()) -> MotionLimits:
    """The robot's own limits, and more."""
    limits = np.full((4, robot.model.nq), np.inf)
    limits[2] = -np.inf
    for group in (robot.base, robot.arm, robot.hand):
        limits[:, group.indices] = (
            group.velocity,
            group.acceleration,
            group.lower,
            group.upper,
        )
    velocity, acceleration, lower, upper = (read_only(row) for row in limits)
    return MotionLimits(velocity, acceleration, lower, upper, more)


def _moving_joints(problem: Problem, *, base: bool, hand: bool) -> MovingJoints:
    """The joints of the groups that move; the base keeps to the problem's bounds."""
    robot = problem.robot
    groups, costs = [robot.arm], [1.0]
    if base and not problem.base_stands:
        low, high = problem.base_bounds.T
        lower = np.maximum(robot.base.lower, low)
        upper = np.minimum(robot.base.upper, high)
        groups.insert(0, replace(robot.base, lower=lower, upper=upper))
        costs.insert(0, problem.planner.base_weight)
    if hand:
        groups.append(robot.hand)
        costs.append(1.0)
    return MovingJoints.of_groups(groups, costs)
