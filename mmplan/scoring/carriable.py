"""Which grasps can hold an object upright where its task wants it to become so.

An object that lies or stands on its head at one end of its task may be turned in some
regions alone. Where it comes out of these it is upright, its origin is at their edge,
and the arm holds it by the grasp. Where no arm of a large table can do so or nearly so,
wherever the base stands, there is no motion for this grasp, and none is sought.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from mmplan.carry import Region, Upright
from mmplan.kinematics import joint_placements
from mmplan.problem import Problem, Task
from mmplan.shapes import Array

# Configurations of the arm in the table.
_TABLE = 4096
# How near they must come, rad and m, as they are few for that many joints.
_NEARLY_UPRIGHT = 0.5
_NEARLY_AT_HEIGHT = 0.15


class Carriable:
    """Whether grasps can carry the object of a task; all do where nothing is asked."""

    def __init__(
        self, problem: Problem, task: Task, T_world_start: Array, seed: int = 0
    ) -> None:
        """Prepare for a task whose object stands at a pose (4, 4) before it."""
        self._upright = task.carry.upright
        ends = np.array([T_world_start, task.T_world_goal])
        self._asked = self._upright is not None and _must_turn(self._upright, ends)
        if not self._asked or self._upright is None:
            return
        robot, rng = problem.robot, np.random.default_rng(seed)
        lower = np.where(robot.arm.wraps, -np.pi, robot.arm.lower)
        upper = np.where(robot.arm.wraps, np.pi, robot.arm.upper)
        q = np.tile(problem.q_start, (_TABLE, 1))
        q[:, robot.arm.indices] = rng.uniform(lower, upper, (_TABLE, len(robot.arm)))
        tool = joint_placements(robot.model, q)[:, robot.tool_joint]
        self._T_world_tool = tool @ robot.T_joint_tool
        regions = self._upright.exempt
        self._heights = np.array([_heights(region) for region in regions])

    def __call__(self, T_object_tool: Array) -> npt.NDArray[np.bool_]:
        """Whether grasps (n,), tool poses (n, 4, 4) in the object's frame, can."""
        if not self._asked or self._upright is None:
            return np.ones(len(T_object_tool), dtype=np.bool_)
        T_tool_object = np.linalg.inv(T_object_tool)
        return np.array([self._can(T, self._upright) for T in T_tool_object], np.bool_)

    def _can(self, T_tool_object: Array, upright: Upright) -> bool:
        held = self._T_world_tool @ T_tool_object
        near = upright.tilts(held[:, :3, :3]) <= upright.angle + _NEARLY_UPRIGHT
        z = held[near, None, 2, 3]
        low, high = self._heights.T
        return bool(
            np.any((z >= low - _NEARLY_AT_HEIGHT) & (z <= high + _NEARLY_AT_HEIGHT))
        )


def _must_turn(upright: Upright, ends: Array) -> bool:
    """Whether an object that goes between ends (2, 4, 4) must become upright.

    It need not where it is so at an end, or where one region has both ends.
    """
    tilted = upright.tilts(ends[:, :3, :3]) > upright.angle
    together = any(
        bool(np.all(region.depths(ends[:, :3, 3]) >= 0.0)) for region in upright.exempt
    )
    return bool(tilted.any()) and not together


def _heights(region: Region) -> tuple[float, float]:
    """The lowest and the highest z of a region, m."""
    R, p = region.T_world_region[:3, :3], region.T_world_region[:3, 3]
    half = float(np.abs(R[2]) @ np.array(region.size)) / 2.0
    return float(p[2]) - half, float(p[2]) + half
