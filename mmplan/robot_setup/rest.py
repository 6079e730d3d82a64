"""Configurations at which an arm may rest: `home`, ready to work, and `tucked`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from mmplan.collision import local_bounds, moved_bounds
from mmplan.collision.bounds import Bounds
from mmplan.exceptions import NoPlanError
from mmplan.kinematics import ForwardKinematics
from mmplan.robot import Robot
from mmplan.robot_setup.configurations import bounds, with_arm
from mmplan.robot_setup.self_collisions import LinkPair, SelfCollisions
from mmplan.scoring.manipulability import manipulability
from mmplan.shapes import Array

_SAMPLES = 3000
_PARENTS, _CHILDREN = 30, 10  # of the search that follows
_ROUNDS, _SHRINK = 8, 0.6
# The least distance from the limits of joints at rest, as a share of their range.
_MARGIN = 0.05


def resting_places(
    robot: Robot, links: SelfCollisions, checked: Sequence[LinkPair]
) -> dict[str, Array]:
    """`home` and `tucked` (arm joints,), both free of collision of `checked` pairs.

    Home has much room to the limits of the joints and a good manipulability, tucked
    keeps near the base's axis; both keep above the lowest point of the base. Found by
    search from random configurations, the same on every call.

    Raises:
        NoPlanError: Every configuration tried is in collision with itself.
    """
    search = _Search(robot, links, checked)
    return {"home": search.best(search.readiness), "tucked": search.best(search.size)}


class _Search:
    """Looks for the configuration of the arm with the least of some cost."""

    def __init__(
        self, robot: Robot, links: SelfCollisions, checked: Sequence[LinkPair]
    ) -> None:
        self._robot, self._links, self._checked = robot, links, checked
        self._floor = _floor(robot)
        self._lower, self._upper = bounds(robot.arm)
        draw = np.random.default_rng(0).uniform(
            self._lower, self._upper, (_SAMPLES, len(robot.arm))
        )
        self._start = self._kept(draw)
        if not len(self._start):
            raise NoPlanError(
                f"{robot.name}: the robot is in collision with itself in all of "
                f"{_SAMPLES} random configurations, most often {self._worst(draw)}; do "
                "the collision bodies of these links fit?"
            )

    def _worst(self, q_arm: Array) -> str:
        """The checked pair of links that overlaps most often."""
        overlaps = self._links.overlaps(with_arm(self._robot, q_arm[:200])).sum(axis=0)
        counts = dict(zip(self._links.pairs, overlaps.tolist(), strict=True))
        worst = max(self._checked, key=lambda pair: counts[pair])
        return f"{worst[0]} / {worst[1]}"

    def readiness(self, q_arm: Array) -> Array:
        """A cost that falls with the room to the limits and the manipulability."""
        M = manipulability(self._robot, with_arm(self._robot, q_arm))
        return np.asarray(-np.minimum(_room(self._robot, q_arm), 0.25) * np.sqrt(M))

    def size(self, q_arm: Array) -> Array:
        """How far the robot reaches out, and half of how far up, in m."""
        ends = _ends(self._robot, with_arm(self._robot, q_arm))
        return ends.extent + 0.5 * ends.high

    def best(self, cost: Callable[[Array], Array]) -> Array:
        """The best of the start after some rounds of changes, in round numbers."""
        rng = np.random.default_rng(0)
        q, reach = self._start, 0.2 * (self._upper - self._lower)
        for _ in range(_ROUNDS):
            q = q[np.argsort(cost(q), kind="stable")[:_PARENTS]]
            children = np.repeat(q, _CHILDREN, axis=0)
            children = children + rng.normal(size=children.shape) * reach
            q = np.concatenate([q, self._kept(children)])
            reach = _SHRINK * reach
        return np.asarray(q[np.argmin(cost(q))])

    def _kept(self, q_arm: Array) -> Array:
        """The configurations that the robot may rest in, rounded to 1e-3.

        Where none is far enough from limits and floor, those free of collision.
        """
        q_arm = np.asarray(np.round(np.clip(q_arm, self._lower, self._upper), 3), float)
        inside = (self._lower <= q_arm) & (q_arm <= self._upper)
        q_arm = q_arm[inside.all(axis=1)]
        q = with_arm(self._robot, q_arm)
        q_arm = q_arm[~self._links.any_of(q, self._checked)]
        above = _ends(self._robot, with_arm(self._robot, q_arm)).low >= self._floor
        good = above & (_room(self._robot, q_arm) >= _MARGIN)
        return q_arm[good] if good.any() else q_arm


def _room(robot: Robot, q_arm: Array) -> Array:
    """The smallest distance of a joint from its limits, as a share of its range."""
    lower, upper = bounds(robot.arm)
    share = np.minimum(q_arm - lower, upper - q_arm) / (upper - lower)
    share[:, robot.arm.wraps] = 0.5
    room: Array = share.min(axis=1)
    return room


class _Ends(NamedTuple):
    """Of what moves: lowest point, highest, farthest from the base's axis, (n,), m."""

    low: Array
    high: Array
    extent: Array


def _ends(robot: Robot, q: Array) -> _Ends:
    joints, local = _bodies(robot, base=False)
    moved = moved_bounds(local, ForwardKinematics(robot.model)(q)[:, joints])
    reach = np.abs(moved.centre[..., :2]) + moved.half[..., :2]
    return _Ends(
        low=(moved.centre - moved.half)[..., 2].min(axis=1),
        high=(moved.centre + moved.half)[..., 2].max(axis=1),
        extent=np.hypot(reach[..., 0], reach[..., 1]).max(axis=1),
    )


def _floor(robot: Robot) -> float:
    """The lowest point of the base's bodies, in m; none is no bound."""
    joints, local = _bodies(robot, base=True)
    if not joints:
        return -np.inf
    q = robot.q_neutral[None]
    moved = moved_bounds(local, ForwardKinematics(robot.model)(q)[:, joints])
    return float((moved.centre - moved.half)[..., 2].min()) - 1e-6


def _bodies(robot: Robot, base: bool) -> tuple[list[int], Bounds]:
    """Joints and bounds (m, 3) in their frames of bodies of the base, or of others."""
    chosen = [
        body
        for body in robot.geometry.geometryObjects
        if (robot.kind_of(body) == "base") == base
    ]
    found = [
        moved_bounds(local_bounds(body.geometry), body.placement.homogeneous)
        for body in chosen
    ]
    centre, half = (np.array([b[k] for b in found]).reshape(-1, 3) for k in range(2))
    return [int(body.parentJoint) for body in chosen], Bounds(centre, half)
