"""Short motions by the letter: the tool along a straight line, the fingers alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from mmplan.ik import Solutions
from mmplan.ik.chain import arm_chain
from mmplan.ik.following import follow
from mmplan.kinematics import joint_placements
from mmplan.planning.checking import PathChecker
from mmplan.planning.world import PlanningWorld, contact_names
from mmplan.robot import Robot
from mmplan.shapes import Array, read_only

# How far apart the tool's poses are along a line, m.
POSE_SPACING = 0.004
# How far from the line the tool may pass between two of these poses, m.
STRAIGHTNESS = 0.001
# The size of what the tool carries, m: what makes turns of the tool comparable.
TOOL_SIZE = 0.1


class RobotWorld(PlanningWorld, Protocol):
    """A planning world that knows its robot."""

    @property
    def robot(self) -> Robot:
        """The robot."""


@dataclass(frozen=True, eq=False)
class ShortMotion:
    """A short motion as far as it goes; nothing is searched for."""

    path: Array  # (n, nq) waypoints from the start on, n >= 1
    reached: float  # the share of the whole motion that `path` is, in [0, 1]
    message: str  # what ended it, one line for people

    @property
    def complete(self) -> bool:
        """Whether nothing stood in the way."""
        return self.reached == 1.0


def straight_motion(
    world: RobotWorld,
    q: Array,
    direction: Array,
    length: float,
    resolution: float,
) -> ShortMotion:
    """Move the tool from q (nq,) along a straight line, the base standing still.

    The line goes `length` (m) along the unit vector `direction` (3,) of the world; the
    tool does not turn. The arm stays on one branch of its inverse kinematics. A motion
    that is to *end* at q, such as an approach, is one that begins there, reversed.
    """
    steps = max(1, int(np.ceil(length / POSE_SPACING)))
    T_world_tool = np.tile(world.robot.tool_pose(q), (steps + 1, 1, 1))
    T_world_tool[:, :3, 3] += np.linspace(0.0, length, steps + 1)[:, None] * direction
    path, ended = _along(world, q, T_world_tool)
    return _checked(world, path, steps, resolution, ended)


def hand_motion(
    world: RobotWorld, q: Array, hand: Array, resolution: float
) -> ShortMotion:
    """Move the fingers from where they are at q (nq,) to `hand` (hand joints,)."""
    q_end = q.copy()
    q_end[world.robot.hand.indices] = hand
    path = np.vstack([q, q_end])
    return _checked(world, path, 1, resolution, "")


def _along(world: RobotWorld, q: Array, T_world_tool: Array) -> tuple[Array, str]:
    """Configurations (m, nq) for the first m tool poses, and why there are no more."""
    robot = world.robot
    T_base_world = np.linalg.inv(_base_pose(robot, q))
    q_arm, ended = _arm_along(robot, q[robot.arm.indices], T_base_world @ T_world_tool)
    path = np.tile(q, (len(q_arm), 1))
    path[:, robot.arm.indices] = q_arm
    crooked = _crooked_edges(robot, path, T_world_tool[: len(path)])
    if crooked.any():
        return path[: np.argmax(crooked) + 1], "the arm passes too near a singularity"
    return path, ended


def _arm_along(robot: Robot, q_arm: Array, T_base_tool: Array) -> tuple[Array, str]:
    """The arm (m', k) at the first of tool poses (m, 4, 4), and why not at the rest."""
    if robot.ik.complete:
        return _on_one_branch(robot, q_arm, robot.ik.solve(T_base_tool))
    chain = arm_chain(robot.model, robot.arm.names, robot.tool_frame)
    return follow(chain, q_arm, T_base_tool)


def _on_one_branch(
    robot: Robot, q_arm: Array, solutions: Solutions
) -> tuple[Array, str]:
    """The solutions (m, k) next to each other from q_arm (k,) on, and why they end."""
    path = [q_arm]
    for q, exists in zip(solutions.q[1:], solutions.exists[1:], strict=True):
        if not exists.any():
            return np.array(path), "out of reach"
        branches = _nearest_turn(q[exists], path[-1])
        nearest = branches[np.argmin(np.abs(branches - path[-1]).sum(axis=1))]
        outside = (nearest < robot.arm.lower) | (nearest > robot.arm.upper)
        if outside.any():
            joint = robot.arm.names[int(np.argmax(outside))]
            return np.array(path), f"{joint} is at its limit"
        path.append(nearest)
    return np.array(path), ""


def _nearest_turn(q: Array, q_near: Array) -> Array:
    """Revolute joints (n, k), each less the whole turns that part it from q_near."""
    turns: Array = 2.0 * np.pi * np.rint((q - q_near) / (2.0 * np.pi))
    return q - turns


def _base_pose(robot: Robot, q: Array) -> Array:
    """T_world_base (4, 4) at one configuration (nq,)."""
    model = robot.model
    base = model.parents[model.getJointId(robot.arm.names[0])]
    pose: Array = joint_placements(model, q[None])[0, base]
    return pose


def _crooked_edges(
    robot: Robot, path: Array, T_world_tool: Array
) -> npt.NDArray[np.bool_]:
    """On which edges of a path (n, nq) the tool leaves its line, (n - 1,)."""
    amid = (path[:-1] + path[1:]) / 2.0
    poses = joint_placements(robot.model, amid)[:, robot.tool_joint]
    off = poses @ robot.T_joint_tool - (T_world_tool[:-1] + T_world_tool[1:]) / 2.0
    off[:, :3, :3] *= TOOL_SIZE
    crooked: npt.NDArray[np.bool_] = np.abs(off).max(axis=(1, 2)) > STRAIGHTNESS
    return crooked


def _checked(
    world: PlanningWorld, path: Array, steps: int, resolution: float, ended: str
) -> ShortMotion:
    """The part of a path (n, nq) before it collides, out of `steps` edges wanted."""
    checker = PathChecker(world, resolution)
    blocked = checker.first_blocked_edge(path)
    if blocked:
        edge, q_hit = blocked
        path, ended = path[: edge + 1], contact_names(world, q_hit)
    reached = (len(path) - 1) / steps
    message = f"ended after {reached:.0%}: {ended}" if ended else "complete"
    return ShortMotion(read_only(path), reached, message)
