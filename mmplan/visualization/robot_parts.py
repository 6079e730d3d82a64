"""The parts of a robot, each carried by the joint that moves it."""

from __future__ import annotations

import pinocchio as pin

from mmplan.robot import Robot
from mmplan.robot_file import load_robot_description
from mmplan.shapes import Array
from mmplan.visualization.part import (
    ROBOT,
    TOOL,
    WORLD,
    Part,
    axes,
    joint_carrier,
    merged,
)
from mmplan.visualization.urdf_parts import urdf_parts

_TOOL_AXES = 0.12  # m


def robot_parts(robot: Robot) -> list[Part]:
    """The robot's links and the axes of its tool frame.

    Raises:
        InputError: Its robot.yaml cannot be read any more.
    """
    parts = urdf_parts(
        robot.model,
        _visual_bodies(robot),
        robot.geometry,
        "robot",
        lambda joint: (joint_name(robot, joint), pin.SE3.Identity()),
    )
    links = [
        Part(p.name, p.surface, p.colour, p.carrier, ROBOT)
        for p in merged(parts, "robot")
    ]
    carrier = joint_name(robot, robot.tool_joint)
    return [*links, *axes("tool", robot.T_joint_tool, _TOOL_AXES, carrier, TOOL)]


def joint_name(robot: Robot, joint: int) -> str:
    """What carries the bodies of a joint, given by its id."""
    return joint_carrier(robot.model.names[joint]) if joint else WORLD


def joint_poses(robot: Robot, T_world_joint: Array) -> dict[str, Array]:
    """Poses of all joints (..., njoints, 4, 4) by the names of carriers."""
    return {
        joint_name(robot, joint): T_world_joint[..., joint, :, :]
        for joint in range(1, robot.model.njoints)
    }


def _visual_bodies(robot: Robot) -> pin.GeometryModel:
    """The visual bodies of the robot's URDF, none where they cannot be read."""
    description = load_robot_description(robot.path)
    try:
        return pin.buildGeomFromUrdfString(
            robot.model, description.urdf, pin.GeometryType.VISUAL, package_dirs=[]
        )
    except (RuntimeError, ValueError):  # a mesh of a type that is not known
        return pin.GeometryModel()
