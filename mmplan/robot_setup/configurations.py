"""Random configurations of a robot that stands at the origin."""

from __future__ import annotations

import numpy as np

from mmplan.robot import JointGroup, Robot
from mmplan.shapes import Array


def draw(robot: Robot, n: int, rng: np.random.Generator) -> Array:
    """Configurations (n, nq): arm and hand anywhere within their limits."""
    q = np.tile(robot.q_neutral, (n, 1))
    for group in (robot.arm, robot.hand):
        q[:, group.indices] = rng.uniform(*bounds(group), (n, len(group)))
    return robot.with_followers(q)


def bounds(group: JointGroup) -> tuple[Array, Array]:
    """Limits (k,) of joints; one turn for those that turn without end."""
    return (
        np.where(group.wraps, -np.pi, group.lower),
        np.where(group.wraps, np.pi, group.upper),
    )


def with_arm(robot: Robot, q_arm: Array) -> Array:
    """Configurations (n, nq) for those of the arm (n, arm joints), the hand open."""
    q = np.tile(robot.q_neutral, (len(q_arm), 1))
    q[:, robot.arm.indices] = q_arm
    return q
