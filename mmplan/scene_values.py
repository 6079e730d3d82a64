"""Poses and shapes of a scene file as the values that mmplan computes with."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from mmplan.files.pose_section import PoseSection
from mmplan.files.shape_sections import ShapeKeys
from mmplan.shapes import (
    Array,
    Box,
    Capsule,
    Cone,
    Cylinder,
    Mesh,
    Revolve,
    Shape,
    Sphere,
    read_only,
)


def pose(section: PoseSection) -> Array:
    """The pose as a read-only homogeneous matrix (4, 4)."""
    T = np.eye(4)
    if section.quat is not None:
        T[:3, :3] = _of_quaternion(*section.quat)
    elif section.rpy is not None:
        T[:3, :3] = _of_angles(*section.rpy)
    T[:3, 3] = section.xyz
    return read_only(T)


def shape(section: ShapeKeys, folder: Path) -> Shape:
    """The one shape of an obstacle or object; file names begin in `folder`."""
    if section.mesh is not None:
        return Mesh(folder / section.mesh, _scale(section))
    if section.revolve is not None:
        return Revolve(read_only(section.revolve))
    if section.box is not None:
        return Box(section.box)
    return _round_shape(section)


def _scale(section: ShapeKeys) -> tuple[float, float, float]:
    if isinstance(section.scale, tuple):
        return section.scale
    factor = 1.0 if section.scale is None else section.scale
    return (factor, factor, factor)


def _round_shape(section: ShapeKeys) -> Shape:
    if section.sphere is not None:
        return Sphere(section.sphere.radius)
    if section.cylinder is not None:
        return Cylinder(section.cylinder.radius, section.cylinder.length)
    if section.capsule is not None:
        return Capsule(section.capsule.radius, section.capsule.length)
    assert section.cone is not None, "validated: one shape is given"
    return Cone(section.cone.radius, section.cone.length)


def _of_angles(roll: float, pitch: float, yaw: float) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll), (3, 3)."""
    cr, sr = math.cos(roll), math.sin(roll)
    cp, sp = math.cos(pitch), math.sin(pitch)
    cy, sy = math.cos(yaw), math.sin(yaw)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def _of_quaternion(x: float, y: float, z: float, w: float) -> Array:
    """The rotation matrix (3, 3) of a unit quaternion."""
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
