"""Grasp families as task space regions, where these say the same."""

from __future__ import annotations

from functools import singledispatch

import numpy as np

from mmplan.grasps.axis import Axis
from mmplan.grasps.box_faces import BoxFaces
from mmplan.grasps.cylinder_side import CylinderSide
from mmplan.grasps.cylinder_top import CylinderTop
from mmplan.grasps.family import GraspFamily
from mmplan.grasps.handle import Handle
from mmplan.grasps.mixture import Mixture
from mmplan.grasps.sphere import SphereGrasps
from mmplan.grasps.tsr import TaskSpaceRegion
from mmplan.shapes import Array

Regions = tuple[TaskSpaceRegion, ...]
Bounds = tuple[float, float]

_TURN = (-np.pi, np.pi)


@singledispatch
def regions(family: GraspFamily) -> Regions | None:  # noqa: ARG001
    """The regions that together hold the same grasps as a family; None if none do.

    A list of poses is no region, and on a rim the hand turns about two places.
    """
    return None


@regions.register
def _(family: TaskSpaceRegion) -> Regions:
    return (family,)


@regions.register
def _(family: Mixture) -> Regions | None:
    parts = [regions(member) for member in family.families]
    if any(part is None for part in parts):
        return None
    return tuple(region for part in parts if part is not None for region in part)


@regions.register
def _(family: Axis) -> Regions:
    T_object_tool = family.tool_poses(np.zeros((1, 2)))[0]
    return (_region(T_object_tool, z=family.along, yaw=_TURN),)


@regions.register
def _(family: CylinderSide) -> Regions:
    T_object_tool = family.tool_poses(np.zeros((1, 3)))[0]
    tilt = (-family.tilt, family.tilt)
    return (_region(T_object_tool, z=family.along, pitch=tilt, yaw=_TURN),)


@regions.register
def _(family: CylinderTop) -> Regions:
    T_object_tool = family.tool_poses(np.zeros((1, 2)))[0]
    low, high = family.depth
    depth = (low, high) if family.below else (-high, -low)
    return (_region(T_object_tool, z=depth, yaw=_TURN),)


@regions.register
def _(family: SphereGrasps) -> Regions:
    T_object_w = np.eye(4)
    T_object_w[:3, 3] = family.centre
    half = (-np.pi / 2.0, np.pi / 2.0)
    return (_region(T_object_w, T_object_w, roll=_TURN, pitch=half, yaw=_TURN),)


@regions.register
def _(family: Handle) -> Regions:
    """The frame is at the start of the bar, z along it and x outward."""
    T_object_tool = family.tool_poses(np.zeros((1, 2)))[0]
    along = np.subtract(family.end, family.start)
    T_object_w = np.eye(4)
    T_object_w[:3, 0] = -T_object_tool[:3, 2]
    T_object_w[:3, 2] = along / np.linalg.norm(along)
    T_object_w[:3, 1] = np.cross(T_object_w[:3, 2], T_object_w[:3, 0])
    T_object_w[:3, 3] = family.start
    length = (0.0, float(np.linalg.norm(along)))
    spread = (-family.spread, family.spread)
    return (_region(T_object_tool, T_object_w, z=length, yaw=spread),)


@regions.register
def _(family: BoxFaces) -> Regions:
    """One for each way to come to the box."""
    found = []
    for way in range(len(family.ways)):
        ends = np.array([[way, -1.0, 0.0, 0.0], [way, 1.0, 1.0, 0.0]])
        T_object_tool = family.tool_poses(ends)
        T_object_w = T_object_tool[0]
        across = np.linalg.inv(T_object_w) @ T_object_tool[1]
        x, z = sorted((0.0, float(across[0, 3]))), (0.0, float(across[2, 3]))
        tilt = (-family.tilt, family.tilt)
        found.append(_region(T_object_w, T_object_w, x=(x[0], x[1]), z=z, pitch=tilt))
    return tuple(found)


def _region(
    T_object_tool: Array,
    T_object_w: Array | None = None,
    *,
    x: Bounds = (0.0, 0.0),
    z: Bounds = (0.0, 0.0),
    roll: Bounds = (0.0, 0.0),
    pitch: Bounds = (0.0, 0.0),
    yaw: Bounds = (0.0, 0.0),
) -> TaskSpaceRegion:
    """The region about a tool pose, which is that of no displacement."""
    T_object_w = np.eye(4) if T_object_w is None else T_object_w
    bounds = np.array([x, (0.0, 0.0), z, roll, pitch, yaw])
    return TaskSpaceRegion(
        T_object_w, np.linalg.inv(T_object_w) @ T_object_tool, bounds
    )
