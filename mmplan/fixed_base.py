"""Robots whose base stands still: where they are told to, or where a base is held."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from xml.etree import ElementTree as ET

from mmplan.files.rigid_pose import RigidPose
from mmplan.files.urdf import urdf_facts
from mmplan.files.urdf_composition import held, placed
from mmplan.robot_file import RobotDescription


def hold_base(robot: RobotDescription, q_base: Sequence[float]) -> RobotDescription:
    """The robot with its base's joints fixed at positions, one a joint (m or rad)."""
    values = dict(zip(robot.base_joints, q_base, strict=True))
    fixed = _with_urdf(robot, held(ET.fromstring(robot.urdf), values))
    limits = {n: a for n, a in robot.acceleration.items() if n not in values}
    return replace(
        fixed,
        base_type="fixed",
        base_joints=(),
        turning_radius=0.0,
        acceleration=limits,
    )


def stand_at(robot: RobotDescription, T_world_base: RigidPose) -> RobotDescription:
    """The robot with the root of its URDF at a pose in the world."""
    return _with_urdf(robot, placed(ET.fromstring(robot.urdf), T_world_base))


def _with_urdf(robot: RobotDescription, urdf: ET.Element) -> RobotDescription:
    text = ET.tostring(urdf, encoding="unicode")
    return replace(robot, urdf=text, facts=urdf_facts(urdf, {}))
