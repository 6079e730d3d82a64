"""Grasp sections of scene files as the families that mmplan computes with."""

from __future__ import annotations

from functools import singledispatch
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mmplan.collision import antipodal_poses, hand_size
from mmplan.exceptions import InputError
from mmplan.files import free_grasp_sections as free
from mmplan.files import shape_grasp_sections as shaped
from mmplan.grasp_exchange import family_of_file
from mmplan.grasps import (
    Axis,
    BoxFaces,
    CylinderSide,
    CylinderTop,
    GraspFamily,
    Handle,
    Poses,
    Rim,
    SphereGrasps,
    TaskSpaceRegion,
)
from mmplan.grasps.defaults import around_body, ends_of
from mmplan.problem import Object
from mmplan.robot import Robot
from mmplan.scene_values import pose
from mmplan.shapes import Box, Mesh, Revolve


class GraspContext(NamedTuple):
    """What completes a grasp section: the object, the robot, where file names begin."""

    item: Object
    robot: Robot
    folder: Path


@singledispatch
def family(section: shaped.FamilySection | str, at: GraspContext) -> GraspFamily:
    """The grasp family that a section stands for.

    Raises:
        InputError: It cannot be made for that object and hand.
    """
    raise TypeError(f"no family for {type(section).__name__} of {at.item.name}")


def sampled(item: Object, robot: Robot, samples: int, seed: int) -> Poses:
    """Antipodal grasps of an object that is a mesh.

    Raises:
        InputError: The mesh cannot be used, or the hand finds no grasp of it.
    """
    assert isinstance(item.shape, Mesh), "validated: antipodal goes with a mesh"
    poses = antipodal_poses(item.shape, robot, item.friction, samples, seed)
    if len(poses) == 0:
        opening = hand_size(robot).opening
        raise InputError(
            f"{item.shape.path}: the hand of {robot.name}, which opens by "
            f"{opening:.3g} m, finds no two opposite places to hold this mesh by; it "
            "may be too wide, or larger than it should be: 'scale' says how large it is"
        )
    return Poses(poses)


@family.register
def _(section: shaped.AxisSection, at: GraspContext) -> GraspFamily:  # noqa: ARG001
    return Axis(section.along)


@family.register
def _(section: shaped.CylinderSideSection, at: GraspContext) -> GraspFamily:
    along = section.along or around_body(at.item.shape, hand_size(at.robot))
    if along is None:
        raise InputError(
            f"the hand of {at.robot.name} goes around no part of this shape; "
            "'along' says where it may"
        )
    return CylinderSide(along, section.tilt)


@family.register
def _(section: shaped.CylinderTopSection, at: GraspContext) -> GraspFamily:
    end = section.end
    if end is None:
        end = ends_of(at.item.shape)[0 if section.below else 1]
    depth = section.depth or hand_size(at.robot).depth
    return CylinderTop(end, depth, section.below)


@family.register
def _(section: shaped.RimSection, at: GraspContext) -> GraspFamily:
    radius, height = section.radius, section.height
    if isinstance(at.item.shape, Revolve):
        widest = max(at.item.shape.profile.tolist())  # of equal radii, the highest
        radius = widest[0] if radius is None else radius
        height = widest[1] if height is None else height
    assert radius is not None, "validated: other shapes have both"
    assert height is not None, "validated: other shapes have both"
    return Rim(radius, height, section.spread, section.tilt)


@family.register
def _(section: shaped.BoxFacesSection, at: GraspContext) -> GraspFamily:
    assert isinstance(at.item.shape, Box), "validated: goes with a box"
    hand = hand_size(at.robot)
    size = at.item.shape.size
    found = BoxFaces(size, hand.widest, hand.depth, section.tilt, faces=section.faces)
    if len(found.ways) == 0:
        raise InputError(
            f"the box is {min(size):.3g} m wide where it is narrowest, and the hand of "
            f"{at.robot.name} opens by {hand.opening:.3g} m, or 'faces' leave it no way"
        )
    return found


@family.register
def _(
    section: shaped.SphereGraspsSection,
    at: GraspContext,  # noqa: ARG001
) -> GraspFamily:
    return SphereGrasps(section.centre)


@family.register
def _(section: free.HandleSection, at: GraspContext) -> GraspFamily:  # noqa: ARG001
    return Handle(section.start, section.end, section.outward, section.spread)


@family.register
def _(section: free.PosesSection, at: GraspContext) -> GraspFamily:  # noqa: ARG001
    return Poses(np.array([pose(p) for p in section.poses]))


@family.register
def _(section: free.TsrSection, at: GraspContext) -> GraspFamily:  # noqa: ARG001
    names = ("x", "y", "z", "roll", "pitch", "yaw")
    bounds = np.array([getattr(section, name) for name in names])
    return TaskSpaceRegion(pose(section.frame), pose(section.tool), bounds)


@family.register
def _(section: free.AntipodalSection, at: GraspContext) -> GraspFamily:
    return sampled(at.item, at.robot, section.samples, section.seed)


@family.register
def _(section: free.FileSection, at: GraspContext) -> GraspFamily:
    tool = None if section.tool is None else pose(section.tool)
    return family_of_file(at.folder / section.file, at.robot, tool)


@family.register
def _(section: str, at: GraspContext) -> GraspFamily:
    return family_of_file(at.folder / section, at.robot)
