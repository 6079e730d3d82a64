"""Lengths of a robot that follow from its model: its reach and its base's radius."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from mmplan.kinematics import ForwardKinematics
from mmplan.robot import JointGroup
from mmplan.shapes import Array

_SAMPLES = 4000  # configurations of the arm
_ROUNDS = 40  # of steps that halve
_BEST = 8  # samples that are improved
_RIM = 73  # points of a cylinder's rim


def reach(model: pin.Model, arm: JointGroup, base_joint: int, tool_frame: int) -> float:
    """The largest horizontal distance of the tool from the base's axis, m.

    Found by search within the arm's limits: the best of many samples, improved joint
    by joint. The same on every call.
    """
    rng = np.random.default_rng(0)
    lower = np.where(arm.wraps, -np.pi, arm.lower)
    upper = np.where(arm.wraps, np.pi, arm.upper)
    tool = _Tool(model, arm, base_joint, tool_frame)
    q = rng.uniform(lower, upper, (_SAMPLES, len(arm)))
    q = q[np.argsort(tool.distances(q))[-_BEST:]]
    step = 0.25 * (upper - lower)
    for _ in range(_ROUNDS):
        for joint in range(len(arm)):
            tries = np.repeat(q[:, None], 3, axis=1)
            tries[:, :, joint] += step[joint] * np.array([-1.0, 0.0, 1.0])
            tries = np.clip(tries, lower, upper)
            found = tool.distances(tries.reshape(-1, len(arm))).reshape(-1, 3)
            q = tries[np.arange(len(q)), found.argmax(axis=1)]
        step = 0.7 * step
    return float(tool.distances(q).max())


class _Tool:
    """How far the tool is from the base's axis at configurations of the arm."""

    def __init__(
        self, model: pin.Model, arm: JointGroup, base_joint: int, tool_frame: int
    ) -> None:
        self._model, self._arm, self._base = model, arm, base_joint
        self._joint = int(model.frames[tool_frame].parentJoint)
        self._p_joint_tool = model.frames[tool_frame].placement.translation
        self._kinematics = ForwardKinematics(model)

    def distances(self, q_arm: Array) -> Array:
        """Horizontal distances (n,) at configurations (n, arm joints)."""
        q = np.zeros((len(q_arm), self._model.nq))
        q[:, self._arm.indices] = q_arm
        T_world_joint = self._kinematics(q)
        T_world_base, T_world_last = (
            T_world_joint[:, self._base],
            T_world_joint[:, self._joint],
        )
        p_tool = T_world_last[:, :3, :3] @ self._p_joint_tool + T_world_last[:, :3, 3]
        offset = p_tool - T_world_base[:, :3, 3]
        distances: Array = np.hypot(offset[:, 0], offset[:, 1])
        return distances


def base_radius(geometry: pin.GeometryModel, base_joint: int) -> float:
    """The radius of the circle about the base's axis around the base's bodies, m.

    It is 0 where there are none.
    """
    radii = [0.0]
    for body in geometry.geometryObjects:
        if body.parentJoint == base_joint:
            points = _outline(body.geometry) @ body.placement.rotation.T
            x, y, _ = (points + body.placement.translation).T
            radii.append(float(np.hypot(x, y).max()))
    return max(radii)


def _outline(geometry: pin.CollisionGeometry) -> Array:
    """Points (n, 3) around a body: of its hull, its rims, or its bounding box."""
    if hasattr(geometry, "points"):
        return np.asarray(geometry.points(), dtype=float)
    geometry.computeLocalAABB()
    box = geometry.aabb_local
    if hasattr(geometry, "radius") and hasattr(geometry, "halfLength"):
        angles = np.linspace(0.0, 2.0 * np.pi, _RIM)
        rim = geometry.radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        ends = (box.min_[2], box.max_[2])
        return np.concatenate([np.insert(rim, 2, z, axis=1) for z in ends])
    sides = np.array([box.min_, box.max_]).T
    return np.array(np.meshgrid(*sides)).reshape(3, -1).T
