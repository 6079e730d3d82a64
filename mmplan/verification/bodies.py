"""The bodies of a world, as arrays: where they are and how far joints carry them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision import CollisionWorld
from mmplan.collision.bounds import local_bounds
from mmplan.collision.separation import Separation
from mmplan.kinematics import ForwardKinematics, motion_axis
from mmplan.shapes import Array

Indices: TypeAlias = npt.NDArray[np.int64]
Mask: TypeAlias = npt.NDArray[np.bool_]


class Bodies:
    """All bodies of a world.

    `levers` (bodies, nq) bounds the way (m) of any point of a body for a small motion
    of each joint, per rad or m, in every configuration: 1 for a prismatic joint, for a
    revolute joint the largest distance of any point of the body from its axis, 0 for
    a joint that does not move the body.
    """

    def __init__(self, world: CollisionWorld, travel: Array) -> None:
        """Read a world; `travel` (nq,) is the largest |q| that is going to occur."""
        self.world = world
        self._model = world.model
        self._kinematics = ForwardKinematics(world.model)
        objects = world.geometry.geometryObjects
        self.separation = Separation(world.geometry)
        self.owners = [body.owner for body in world.bodies]
        self.kinds = [body.kind for body in world.bodies]
        self.joints = np.array([body.joint for body in world.bodies])
        self.placements = np.array([body.placement.homogeneous for body in objects])
        bounds = [local_bounds(body.geometry) for body in objects]
        self.halves = np.array([b.half for b in bounds])  # of boxes about the bodies
        self.centres = np.array([b.centre for b in bounds])  # in the bodies' frames
        self.radii = np.linalg.norm(self.halves, axis=1)  # of spheres about the boxes
        self.supports = _supports(self._model)  # (joints, nq)
        self.levers = np.zeros((len(self), self._model.nq))
        for joint in np.unique(self.joints).tolist():
            moved = np.flatnonzero(self.joints == joint)
            corners = self._corners(moved)
            self.levers[moved] = point_levers(self._model, joint, corners, travel)

    def __len__(self) -> int:
        """The number of bodies."""
        return len(self.owners)

    def joint_poses(self, q: Array) -> Array:
        """Poses T_world_joint (n, joints, 4, 4) at configurations (n, nq)."""
        return self._kinematics(q)

    def centres_at(self, T_world_joint: Array) -> Array:
        """Centres (n, bodies, 3) of the bodies' boxes in the world."""
        centres = np.empty((len(T_world_joint), len(self), 3))
        local = np.einsum("bij,bj->bi", self.placements[:, :3, :3], self.centres)
        local += self.placements[:, :3, 3]
        for joint in np.unique(self.joints):
            moved = np.flatnonzero(self.joints == joint)
            R, p = T_world_joint[:, joint, :3, :3], T_world_joint[:, joint, :3, 3]
            centres[:, moved] = local[moved] @ R.transpose(0, 2, 1) + p[:, None]
        return centres

    def rotations_at(
        self, T_world_joint: Array, moment: Indices, body: Indices
    ) -> Array:
        """Rotations (k, 3, 3) of bodies (k,), each at one of the moments."""
        R = T_world_joint[moment, self.joints[body], :3, :3]
        rotations: Array = R @ self.placements[body, :3, :3]
        return rotations

    def belong_to(self, owners: Iterable[str]) -> Mask:
        """Which bodies belong to one of the owners, (bodies,)."""
        names = set(owners)
        return np.array([owner in names for owner in self.owners])

    def corners(self, owner: str) -> Array:
        """Corners (k, 3) of the boxes about an owner's bodies, in its joint's frame."""
        own = np.flatnonzero(self.belong_to([owner]))
        return self._corners(own).reshape(-1, 3)

    def relative_levers(self, first: Indices, second: Indices) -> Array:
        """How far joints can carry the bodies of pairs (k,) to each other, (k, nq).

        Joints that move both bodies do not change their distance.
        """
        moves = self.supports[self.joints]
        only_one = moves[first] != moves[second]
        levers = self.levers[first] + self.levers[second]
        return np.where(only_one, levers, 0.0)

    def _corners(self, body: Indices) -> Array:
        """Corners (k, 8, 3) of the boxes about bodies (k,), in their joints' frames."""
        signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
        points = self.centres[body, None] + signs * self.halves[body, None]
        T = self.placements[body]
        corners: Array = points @ T[:, :3, :3].transpose(0, 2, 1) + T[:, None, :3, 3]
        return corners


def point_levers(model: pin.Model, joint: int, points: Array, travel: Array) -> Array:
    """Levers (k, nq), as those of `Bodies`, of k sets of points (k, p, 3) of a joint.

    Goes from there towards the world. Of the points, a joint further up knows only that
    they lie in balls of `radius` (k,) around its child joint.
    """
    levers = np.zeros((len(points), model.nq))
    radius = np.zeros(len(points))
    while joint > 0:
        index = model.joints[joint].idx_q
        linear, angular = np.split(motion_axis(model, joint), 2)
        prismatic = bool(np.any(linear))
        away = np.linalg.norm(np.cross(points, angular), axis=2).max(axis=1)
        levers[:, index] = 1.0 if prismatic else away + radius
        radius = radius + np.linalg.norm(points, axis=2).max(axis=1)
        radius += travel[index] if prismatic else 0.0
        points = model.jointPlacements[joint].translation[None, None]
        joint = int(model.parents[joint])
    return levers


def _supports(model: pin.Model) -> Mask:
    """Which coordinates move which joint, (joints, nq)."""
    supports = np.zeros((model.njoints, model.nq), dtype=np.bool_)
    for joint in range(1, model.njoints):
        supports[joint] = supports[model.parents[joint]]
        supports[joint, model.joints[joint].idx_q] = True
    return supports
