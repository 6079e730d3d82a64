"""From the sections of a robot.yaml to the URDF of the whole robot."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree as ET

from mmplan.files.pose_section import PoseSection
from mmplan.files.rigid_pose import RigidPose, from_quaternion, from_rpy
from mmplan.files.robot_parts import BodySection, HandSection, ToolSection
from mmplan.files.robot_sections import RobotSection
from mmplan.files.robot_sources import UrdfFile
from mmplan.files.urdf import Mimic, UrdfJoint, urdf_facts
from mmplan.files.urdf_composition import (
    BASE_JOINTS,
    Attachment,
    Body,
    Composition,
    compose,
)
from mmplan.files.urdf_edit import named_meshes


def composed(
    section: RobotSection,
    urdf: UrdfFile,
    hand: UrdfFile | None,
    pieces: Mapping[str, Sequence[Path]],
) -> ET.Element:
    """The URDF of the whole robot, its meshes named by their paths.

    `pieces` are the files of links whose meshes were cut into convex pieces.

    Raises:
        UrdfError: Its parts do not fit together.
    """
    base = section.base
    added = () if base.joints else BASE_JOINTS[base.type]
    root = named_meshes(urdf.root, urdf.meshes)
    attached = None if hand is None else named_meshes(hand.root, hand.meshes)
    joints = {
        name: joint
        for part in (root, attached)
        if part is not None
        for name, joint in urdf_facts(part, {}).joints.items()
    }
    moving = (*base.joints, *added, *section.arm.joints, *hand_joints(section, joints))
    parts = Composition(
        base_joints=added,
        mount=pose_of(base.mount),
        base_bodies=_bodies(base.bodies),
        hand=_attachment(section.hand, attached),
        tool=_tool(section),
        moving=moving,
        parked=section.parked,
        bodies={
            link: _bodies(bodies)
            for link, bodies in section.collision.items()
            if not isinstance(bodies, str)
        },
        position=section.position,
        velocity=section.velocity,
        pieces=pieces,
    )
    return compose(root, parts)


def hand_joints(
    section: RobotSection, joints: Mapping[str, UrdfJoint]
) -> tuple[str, ...]:
    """The joints of the hand, then those that mimic them."""
    return (*section.hand.joints, *mimics_of(section.hand.joints, joints))


def mimics_of(
    leaders: Sequence[str], joints: Mapping[str, UrdfJoint]
) -> dict[str, Mimic]:
    """The joints that mimic one of `leaders`, in the order of the URDF."""
    return {
        name: joint.mimic
        for name, joint in joints.items()
        if joint.mimic is not None and joint.mimic.leader in leaders
    }


def pose_of(section: PoseSection) -> RigidPose:
    """The pose of a section."""
    if section.quat is not None:
        return from_quaternion(section.xyz, section.quat)
    return from_rpy(section.xyz, section.rpy or (0.0, 0.0, 0.0))


def _attachment(section: HandSection, urdf: ET.Element | None) -> Attachment | None:
    if urdf is None or section.link is None:
        return None
    return Attachment(urdf, section.link, pose_of(section.at))


def _tool(section: RobotSection) -> tuple[str, RigidPose] | None:
    if isinstance(section.tool, ToolSection):
        return section.tool.link, pose_of(section.tool)
    return None


def _bodies(sections: Mapping[str, BodySection]) -> tuple[Body, ...]:
    return tuple(
        Body(name, _shape(section), pose_of(section.at))
        for name, section in sections.items()
    )


def _shape(section: BodySection) -> ET.Element:
    if section.box is not None:
        return ET.Element("box", size=" ".join(map(repr, section.box)))
    if section.sphere is not None:
        return ET.Element("sphere", radius=repr(section.sphere.radius))
    assert section.cylinder is not None, "validated: one shape is given"
    radius, length = section.cylinder.radius, section.cylinder.length
    return ET.Element("cylinder", radius=repr(radius), length=repr(length))
