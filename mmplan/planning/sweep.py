"""How far the points of the robot can move when its joints do."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from mmplan.collision import body_corners, joint_levers
from mmplan.kinematics import motion_axes
from mmplan.planning.upright import UprightWorld
from mmplan.planning.world import PlanningWorld
from mmplan.shapes import Array, read_only

# A joint that moves no body still counts as if it had a lever arm of this length, m.
MIN_WEIGHT = 0.01


@dataclass(frozen=True, eq=False)
class Sweep:
    """Lever arms: `reach[b, j]` bounds how far joint j moves any point of body b.

    In m/rad for revolute joints and m/m for prismatic ones, over all configurations
    within the joint limits (Schwarzer, Saha, Latombe, "Adaptive dynamic collision
    checking for single and multiple articulated robots in complex environments", 2005).
    """

    reach: Array  # (bodies, nq)
    rules: Array  # (rules, nq), the same for what rules beside collisions look at

    @cached_property
    def weights(self) -> Array:
        """The longest lever arm of each joint (nq,), which makes distances lengths."""
        return read_only(np.maximum(self.reach.max(axis=0, initial=0.0), MIN_WEIGHT))

    def farthest(self, dq: Array) -> float:
        """The same as `distance` for one move (nq,)."""
        ways: list[float] = (self.levers @ np.abs(dq)).tolist()
        return max(ways)

    def distance(self, dq: Array) -> Array:
        """A bound on the way (m) of any point, (...,), for joint moves (..., nq)."""
        ways: Array = (np.abs(dq) @ self.levers.T).max(axis=-1)
        return ways

    @cached_property
    def levers(self) -> Array:
        """Both together, (bodies + rules, nq)."""
        return np.vstack([self.reach, self.rules])


@lru_cache(maxsize=16)
def sweep_of(world: PlanningWorld) -> Sweep:
    """The lever arms of a robot and of what it carries.

    Raises:
        ValueError: if a joint has more than one degree of freedom.
    """
    model = world.model
    if model.nq != model.nv or model.njoints != model.nq + 1:
        raise ValueError(f"{model.name}: every joint must have one degree of freedom")
    corners: dict[int, Array] = {}
    for body in world.geometry.geometryObjects:
        joint = int(body.parentJoint)
        if joint:
            known = corners.get(joint, np.empty((0, 3)))
            corners[joint] = np.vstack([known, body_corners(body)])
    axes = motion_axes(model)
    rows = [joint_levers(model, axes, joint, c) for joint, c in corners.items()]
    return Sweep(
        read_only(_undominated(np.array(rows).reshape(-1, model.nq))),
        read_only(_rule_rows(world, axes)),
    )


def _rule_rows(world: PlanningWorld, axes: Array) -> Array:
    """How far joints move a carried object's origin and turn it, (0 or 2, nq)."""
    if not isinstance(world, UprightWorld):
        return np.zeros((0, world.model.nq))
    model, rule = world.model, world.rule
    joint = rule.robot.tool_joint
    turns = np.zeros(model.nq)
    for moved in list(model.supports[joint])[1:]:
        turns[model.joints[moved].idx_q] = axes[moved, 3:].any() / rule.turn_per_metre
    return np.array([joint_levers(model, axes, joint, rule.origin[None]), turns])


def _undominated(rows: Array) -> Array:
    """The rows that are not below another one in every column."""
    rows = np.unique(rows, axis=0)
    keep = [
        i
        for i, row in enumerate(rows)
        if not np.any(np.all(np.delete(rows, i, axis=0) >= row, axis=1))
    ]
    return rows[keep]
