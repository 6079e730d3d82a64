"""Grasps of other programs: from their hand frame to the robot's tool frame and back.

A file speaks of the pose of some frame of the hand, mmplan of its tool frame: z is the
approach direction, y the closing direction, between the pads. `T_hand_tool` is the
pose of the one in the other.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mmplan.exceptions import InputError
from mmplan.files.grasp_files import ListedGrasps, Region, read_grasp_file
from mmplan.grasps import GraspFamily, Mixture, Poses, TaskSpaceRegion, regions
from mmplan.robot import Robot
from mmplan.shapes import Array


def family_of_file(
    path: Path, robot: Robot, T_hand_tool: Array | None = None
) -> GraspFamily:
    """The grasps of a file as a family, for the robot's tool frame.

    Where `T_hand_tool` (4, 4) is not given: the hand frame of an isaac_grasp file is
    the robot's link of that name (what follows the last `/`), which must not move
    against the tool; that of task space regions is the tool frame.

    Raises:
        InputError: The file is faulty, or its hand frame is not known.
    """
    content = read_grasp_file(path)
    if isinstance(content, ListedGrasps):
        if T_hand_tool is None:
            T_hand_tool = hand_frame(path, robot, content.hand_frame)
        poses = content.T_object_hand @ T_hand_tool
        return Poses(poses, content.qualities, content.names)
    shift = np.eye(4) if T_hand_tool is None else T_hand_tool
    regions = tuple(
        TaskSpaceRegion(r.T_object_w, r.T_w_hand @ shift, r.bounds) for r in content
    )
    return regions[0] if len(regions) == 1 else Mixture(regions)


def listed(
    T_object_tool: Array, qualities: Array, T_hand_tool: Array, hand_frame: str = ""
) -> ListedGrasps:
    """Grasps (n, 4, 4) of the tool frame as they go into a file."""
    poses = T_object_tool @ np.linalg.inv(T_hand_tool)
    names = tuple(f"grasp_{number}" for number in range(len(poses)))
    return ListedGrasps(poses, qualities, names, hand_frame)


def regions_of(grasps: Mapping[str, GraspFamily], T_hand_tool: Array) -> list[Region]:
    """Families of the tool frame as the task space regions that say the same.

    Raises:
        InputError: There are none for one of them.
    """
    found = []
    for name, family in grasps.items():
        parts = regions(family)
        if parts is None:
            raise InputError(
                f"'{name}' is a {type(family).__name__} family, which is no task space "
                "region; its samples can be saved as isaac_grasp"
            )
        for number, part in enumerate(parts):
            called = name if len(parts) == 1 else f"{name}_{number}"
            found.append(region(called, part, T_hand_tool))
    return found


def region(name: str, family: TaskSpaceRegion, T_hand_tool: Array) -> Region:
    """A task space region of the tool frame as it goes into a file."""
    T_w_hand = family.T_w_tool @ np.linalg.inv(T_hand_tool)
    return Region(name, family.T_object_w, T_w_hand, family.bounds)


def hand_frame(path: Path, robot: Robot, name: str) -> Array:
    """The pose T_hand_tool (4, 4) in the link that a file calls its hand frame.

    Raises:
        InputError: The robot has no such link, or it moves against the tool.
    """
    link = name.rpartition("/")[2]
    model = robot.model
    if not link or not model.existBodyName(link):
        what = f"its hand frame '{name}' is no link" if name else "no hand frame named"
        raise InputError(
            f"{path}: {what} of {robot.name}; give the pose of the robot's tool frame "
            "in the hand frame of the file: {family: file, file: ..., tool: {xyz: ..., "
            "rpy: ...}}"
        )
    frame = model.frames[model.getBodyId(link)]
    if frame.parentJoint != robot.tool_joint:
        raise InputError(
            f"{path}: its hand frame '{name}' moves against the tool frame of "
            f"{robot.name}; give 'tool', the pose of the tool frame in it"
        )
    T: Array = np.linalg.inv(frame.placement.homogeneous) @ robot.T_joint_tool
    return T
