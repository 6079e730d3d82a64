"""Objects that are carried upright: the rule, and how to come to obey it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.carry import Upright
from mmplan.kinematics import ForwardKinematics, FrameJacobians
from mmplan.planning.joints import MovingJoints
from mmplan.planning.world import PlanningWorld, Touch
from mmplan.robot import Robot
from mmplan.shapes import Array

Mask = npt.NDArray[np.bool_]

# Between two checks the object turns by no more than so many rad a metre of the
# planner's resolution, nor by more than this share of the angle allowed.
TURN_PER_METRE = 3.0
SHARE_OF_ANGLE = 0.25
# Newton's method takes no more steps than this, none beyond this many rad.
STEPS = 12
LONGEST_STEP = 0.6
# It aims at this share of the angle allowed, so that it arrives within.
AIM = 0.95
# A turn that all joints together hardly make is not asked of them, squared rad/rad.
_LEAST_GAIN = 1e-6


class UprightRule:
    """The rule that a carried object keeps, as planning must see it.

    Configurations are looked at one by one, so that the rule is kept with a margin:
    half of what the object may turn and its origin may move between two checks.
    Less where an end of the motion has less.
    """

    def __init__(
        self,
        robot: Robot,
        name: str,
        upright: Upright,
        T_tool_object: Array,
        resolution: float,
        ends: Sequence[Array],
    ) -> None:
        """Take the object `name` in the hand; ends (nq,) of the motion obey the rule.

        `resolution` (m) is how far points move between two checks.
        """
        self.robot = robot
        self.name = name
        self.upright = upright
        self.T_joint_object: Array = robot.T_joint_tool @ T_tool_object
        self._T_object_tool = np.linalg.inv(T_tool_object)
        self._kinematics = ForwardKinematics(robot.model)
        turn = min(TURN_PER_METRE * resolution, SHARE_OF_ANGLE * upright.angle)
        self.turn_per_metre = turn / resolution
        T = self._object_poses(self._kinematics(np.array(ends)))
        tilts, depths = upright.tilts(T[:, :3, :3]), upright.depths(T[:, :3, 3])
        worst = float(tilts[depths < 0.0].max(initial=0.0))
        self._limit = float(np.clip(worst, upright.angle - turn / 2.0, upright.angle))
        inside = depths[(depths >= 0.0) & (tilts > self._limit)]
        self._inset = float(min(resolution / 2.0, inside.min(initial=np.inf)))

    @property
    def origin(self) -> Array:
        """The origin (3,) of the object's frame in the frame of the tool's joint."""
        origin: Array = self.T_joint_object[:3, 3]
        return origin

    def excess(self, q: Array) -> Array:
        """How much too large the tilt is at q (n, nq), (n,), rad; -inf if exempt."""
        return self._excess(self._object_poses(self._kinematics(q)))

    def told(self, q: Array) -> str | None:
        """How the rule is broken at one configuration (nq,), None if it is not."""
        excess = float(self.excess(q[None])[0])
        if excess <= 0.0:
            return None
        tilt, angle = excess + self._limit, self.upright.angle
        return f"{self.name} tilts by {tilt:.3g} rad, {angle:g} are allowed"

    def project(
        self, q: Array, joints: MovingJoints, weights: Array
    ) -> tuple[Array, Mask]:
        """Configurations near q (n, nq) that obey the rule, and which do, (n,).

        Those that do already stay as they are. The others turn the object towards the
        vertical by the least motion of the moving joints, weighted by `weights` (nq,).
        """
        q = q.copy()
        jacobians = self._jacobians(joints)
        scale = 1.0 / weights[joints.indices]
        for _ in range(STEPS):
            T = self._kinematics(q)
            broken = np.flatnonzero(self._excess(self._object_poses(T)) > 0.0)
            if not len(broken):
                break
            a = self._object_poses(T[broken])[:, :3, :3] @ self.upright.axis
            turn, about = self._wanted_turn(a)
            J = jacobians(T[broken])[:, 3:] * scale  # (m, 3, k)
            g = np.einsum("mi,mik->mk", about, J)
            gain = np.maximum((g**2).sum(axis=1), _LEAST_GAIN)
            dq = g * (turn / gain)[:, None] * scale
            q[broken] = self._moved(q[broken], dq, joints)
        return q, self.excess(q) <= 0.0

    def brought(
        self, q: Array, points: Array, joints: MovingJoints, weights: Array
    ) -> Array:
        """Configurations near q (n, nq) with the object's origin near points (n, 3)."""
        q = q.copy()
        jacobians = self._jacobians(joints)
        scale = 1.0 / weights[joints.indices]
        for _ in range(STEPS):
            T = self._kinematics(q)
            p = self._object_poses(T)
            J = jacobians(T)
            arm = p[:, :3, 3] - (p @ self._T_object_tool)[:, :3, 3]
            J_p = J[:, :3] + np.cross(J[:, 3:], arm[:, :, None], axis=1)
            J_p = J_p * scale
            A = J_p @ J_p.transpose(0, 2, 1) + 1e-4 * np.eye(3)
            way = np.linalg.solve(A, (points - p[:, :3, 3])[:, :, None])
            dq = (J_p.transpose(0, 2, 1) @ way)[:, :, 0] * scale
            q = self._moved(q, dq, joints)
        return q

    def _jacobians(self, joints: MovingJoints) -> FrameJacobians:
        return FrameJacobians(self.robot.model, self.robot.tool_frame, joints.indices)

    def _moved(self, q: Array, dq: Array, joints: MovingJoints) -> Array:
        """Q (n, nq) after moves (n, k) of the joints, within their limits."""
        longest = np.abs(dq).max(axis=1, keepdims=True)
        dq = dq * (LONGEST_STEP / np.maximum(longest, LONGEST_STEP))
        q = q.copy()
        moved = q[:, joints.indices] + dq
        within = np.clip(moved, joints.lower, joints.upper)
        q[:, joints.indices] = np.where(joints.wraps, moved, within)
        return joints.with_followers(q)

    def _wanted_turn(self, a: Array) -> tuple[Array, Array]:
        """By how much (m,) and about which axes (m, 3) to turn directions a (m, 3)."""
        x, y, z = a.T
        sine = np.hypot(x, y)
        about = np.stack([y, -x, np.zeros(len(a))], axis=1)
        about[sine < 1e-9] = (1.0, 0.0, 0.0)
        about /= np.linalg.norm(about, axis=1, keepdims=True)
        return np.arctan2(sine, z) - AIM * self._limit, about

    def _excess(self, T_world_object: Array) -> Array:
        tilts = self.upright.tilts(T_world_object[:, :3, :3])
        depths = self.upright.depths(T_world_object[:, :3, 3])
        return np.where(depths >= self._inset, -np.inf, tilts - self._limit)

    def _object_poses(self, T_world_joint: Array) -> Array:
        poses: Array = T_world_joint[:, self.robot.tool_joint] @ self.T_joint_object
        return poses


@dataclass(frozen=True, eq=False)
class UprightWorld:
    """A world in which a tilt that is too large counts as a collision."""

    world: PlanningWorld
    rule: UprightRule

    @property
    def robot(self) -> Robot:
        """The robot."""
        return self.rule.robot

    @property
    def model(self) -> pin.Model:
        """The robot's kinematic model."""
        return self.world.model

    @property
    def geometry(self) -> pin.GeometryModel:
        """Every body of the world."""
        return self.world.geometry

    def in_collision(self, q: Array) -> Mask:
        """Which of the configurations (n, nq) are in collision or tilted, (n,)."""
        return (self.rule.excess(q) > 0.0) | self.world.in_collision(q)

    def any_collision(self, q: Array) -> bool:
        """Whether any of the configurations (n, nq) is in collision or tilted."""
        return bool((self.rule.excess(q) > 0.0).any()) or self.world.any_collision(q)

    def contacts(self, q: Array) -> Sequence[Touch]:
        """What overlaps at one configuration (nq,), worst first."""
        return self.world.contacts(q)

    def broken_rules(self, q: Array) -> Sequence[str]:
        """What else is wrong at one configuration (nq,), in words."""
        told = self.rule.told(q)
        return [] if told is None else [told]
