"""A robot in one line."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, ClassVar

import numpy as np

from mmplan.robot import JointGroup, Robot
from mmplan.robot_setup.measurements import measure_collision, measure_ik

_POSES, _CONFIGURATIONS = 100, 500


@dataclass(frozen=True)
class Summary:
    """What a table of robots shows; lengths in m, times in s, measured now."""

    HEADERS: ClassVar[tuple[str, ...]] = (
        "robot",
        "base",
        "joints",
        "reach",
        "inverse kinematics",
        "a pose",
        "a collision check",
    )

    name: str
    description: str
    base_type: str
    base_joints: int
    arm_joints: int
    hand_joints: int
    reach: float
    ik_solver: str
    ik_seconds: float
    collision_seconds: float

    def texts(self) -> tuple[str, ...]:
        """The row of the table."""
        return (
            self.name,
            self.base_type,
            f"{self.base_joints} + {self.arm_joints} + {self.hand_joints}",
            f"{self.reach:.2f} m",
            self.ik_solver,
            f"{1e6 * self.ik_seconds:.0f} µs",
            f"{1e6 * self.collision_seconds:.0f} µs",
        )

    def to_json(self) -> dict[str, Any]:
        """Plain data."""
        return asdict(self)


def summary(robot: Robot) -> Summary:
    """Sum a robot up, in a fraction of a second."""
    return Summary(
        name=robot.name,
        description=robot.description,
        base_type=robot.base_type,
        base_joints=_leaders(robot.base),
        arm_joints=_leaders(robot.arm),
        hand_joints=_leaders(robot.hand),
        reach=robot.reach,
        ik_solver=robot.ik_solver,
        ik_seconds=measure_ik(robot, _POSES).seconds,
        collision_seconds=measure_collision(robot, _CONFIGURATIONS),
    )


def _leaders(group: JointGroup) -> int:
    """The joints that move by themselves."""
    return int(np.count_nonzero(group.leads))
