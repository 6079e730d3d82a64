"""A robot with a narrower hand, to see whether that would help."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import coal
import numpy as np
import pinocchio as pin

from mmplan.collision.bounds import local_bounds
from mmplan.collision.meshes import hull
from mmplan.kinematics import joint_placements
from mmplan.robot import Robot
from mmplan.shapes import Array

_THINNEST = 0.001  # m


def narrowed(robot: Robot, by: float) -> Robot:
    """The robot whose hand is narrower by a length (m), kinematics unchanged.

    Seen along the approach direction, what moves with the tool loses half of it on each
    side, and fingers lose their thickness from outside, so that they close as before.
    No body becomes thinner than 1 mm.
    """
    T_world_joint = joint_placements(robot.model, robot.q_neutral[None])[0]
    T_world_tool = T_world_joint[robot.tool_joint] @ robot.T_joint_tool
    T_tool_world = np.linalg.inv(T_world_tool)
    geometry = robot.geometry.clone()
    for body in geometry.geometryObjects:
        finger = robot.kind_of(body) == "finger"
        if finger or body.parentJoint == robot.tool_joint:
            T_tool_joint = T_tool_world @ T_world_joint[body.parentJoint]
            _narrow(body, T_tool_joint, by, finger=finger)
    return replace(robot, geometry=geometry)


def _narrow(
    body: pin.GeometryObject, T_tool_joint: Array, by: float, *, finger: bool
) -> None:
    """Put a narrower shape in the place of a body's own."""
    shape = body.geometry
    if isinstance(shape, coal.Sphere | coal.Cylinder | coal.Capsule | coal.Cone):
        shape.radius = max(_THINNEST / 2, shape.radius - by / 2)
        return
    T = T_tool_joint @ body.placement.homogeneous
    points = _corners(shape) @ T[:3, :3].T + T[:3, 3]
    for axis in (0, 1):
        points[:, axis] = _squeezed(points[:, axis], by, inward=finger and axis == 1)
    back = np.linalg.inv(T)
    body.geometry = hull(points @ back[:3, :3].T + back[:3, 3])


def _squeezed(values: Array, by: float, *, inward: bool) -> Array:
    """Coordinates (n,) over a width that is smaller by a length (m).

    About their middle, or, `inward`, from the side that is away from 0 by half of it.
    """
    low, high = float(values.min()), float(values.max())
    fixed, loss = (low + high) / 2, by
    if inward and low * high >= 0.0:
        fixed, loss = (low if low >= 0.0 else high), by / 2
    width = high - low
    factor = max(_THINNEST, width - loss) / width if width > _THINNEST else 1.0
    squeezed: Array = fixed + (values - fixed) * factor
    return squeezed


def _corners(shape: coal.CollisionGeometry) -> Array:
    """Points (n, 3) whose hull is the shape; its bounds where it is no polyhedron."""
    if isinstance(shape, coal.ConvexBase):
        return np.array([shape.point(i) for i in range(shape.num_points)])
    box = local_bounds(shape)
    signs = np.array(list(product((-1.0, 1.0), repeat=3)))
    corners: Array = box.centre + signs * box.half
    return corners
