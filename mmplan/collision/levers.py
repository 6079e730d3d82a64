"""How far joints carry bodies, at most.

After F. Schwarzer, M. Saha and J.-C. Latombe, "Adaptive dynamic collision checking for
single and multiple articulated robots in complex environments", IEEE Transactions on
Robotics 21(3), 2005.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
import pinocchio as pin

from mmplan.collision.bounds import local_bounds
from mmplan.collision.pairs import Indices
from mmplan.kinematics import motion_axes
from mmplan.shapes import Array

_CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))


def pair_levers(model: pin.Model, geometry: pin.GeometryModel, pairs: Indices) -> Array:
    """Bounds (p, nq) on how far each joint moves two bodies to each other.

    Units as in `body_levers`; `pairs` (p, 2) are indices into the geometry model.
    Joints that carry both bodies do not change their distance.
    """
    bodies = geometry.geometryObjects
    used = np.unique(pairs).tolist()
    levers = np.zeros((len(bodies), model.nq))
    levers[used] = body_levers(model, geometry, used)
    carried = np.zeros((len(bodies), model.nq), dtype=np.bool_)
    for i in used:
        joint = int(bodies[i].parentJoint)
        while joint:
            carried[i, model.joints[joint].idx_q] = True
            joint = int(model.parents[joint])
    first, second = pairs.reshape(-1, 2).T
    either = carried[first] != carried[second]
    return np.where(either, levers[first] + levers[second], 0.0)


def body_levers(
    model: pin.Model, geometry: pin.GeometryModel, bodies: Sequence[int]
) -> Array:
    """Bounds (b, nq) on how far each joint moves bodies of a geometry model.

    In m/rad for revolute joints and m/m for prismatic ones, over all configurations
    within the joint limits.
    """
    axes = motion_axes(model)
    levers = np.zeros((len(bodies), model.nq))
    for row, i in zip(levers, bodies, strict=True):
        body = geometry.geometryObjects[i]
        row[:] = joint_levers(model, axes, int(body.parentJoint), body_corners(body))
    return levers


def body_corners(body: pin.GeometryObject) -> Array:
    """Corners (8, 3) of a box around a body, in the frame of its joint."""
    centre, half = local_bounds(body.geometry)
    T_joint_body = body.placement
    turned = (centre + half * _CORNERS) @ T_joint_body.rotation.T
    corners: Array = turned + T_joint_body.translation
    return corners


def joint_levers(model: pin.Model, axes: Array, joint: int, points: Array) -> Array:
    """Bounds (nq,) on how far each joint moves `points` (n, 3) of one joint's frame.

    `axes` are the model's `motion_axes`.
    Goes from the body towards the root. Above its own joint the body is known only as
    a ball: somewhere within `radius` of `points`.
    """
    arms = np.zeros(model.nq)
    radius = 0.0
    while joint:
        index = model.joints[joint].idx_q
        squares = (points**2).sum(axis=1)
        linear, angular = axes[joint, :3], axes[joint, 3:]
        arms[index] = float(linear.any())
        if angular.any():
            beside = np.maximum(squares - (points @ angular) ** 2, 0.0)
            arms[index] += float(np.sqrt(beside).max())
            arms[index] += radius
        radius += float(np.sqrt(squares.max()))
        if linear.any():
            limits = model.lowerPositionLimit[index], model.upperPositionLimit[index]
            radius += max(abs(float(limit)) for limit in limits)
        points = model.jointPlacements[joint].translation[None]
        joint = int(model.parents[joint])
    return arms
