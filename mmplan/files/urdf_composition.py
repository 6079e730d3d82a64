"""One URDF of the whole robot, put together from those of its parts.

Only joints of the base, the arm and the hand move in it; the mobile base that a URDF
lacks, a hand that it lacks, and the tool frame are added.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree as ET

from mmplan.files import urdf_edit as edit
from mmplan.files.body_inertia import inertial
from mmplan.files.rigid_pose import RigidPose
from mmplan.files.urdf import UrdfError, UrdfJoint, urdf_facts

BASE_LINK = "mobile_base"
TOOL_LINK = "tool_frame"

# Joints of a base that is added, in their order: kind, axis.
_BASE_JOINTS = {
    "base_x": ("prismatic", "1 0 0"),
    "base_y": ("prismatic", "0 1 0"),
    "base_yaw": ("continuous", "0 0 1"),
}
_FLOOR = 100.0  # m, how far an added base goes along x and y where nothing is said
BASE_JOINTS: Mapping[str, tuple[str, ...]] = {
    "xy": ("base_x", "base_y"),
    "planar": ("base_x", "base_y", "base_yaw"),
    "diff_drive": ("base_x", "base_y", "base_yaw"),
    "reeds_shepp": ("base_x", "base_y", "base_yaw"),
    "fixed": (),
}


@dataclass(frozen=True)
class Body:
    """A primitive of a link: a URDF geometry (box, sphere, cylinder) at a pose."""

    name: str
    shape: ET.Element
    pose: RigidPose


@dataclass(frozen=True)
class Attachment:
    """A URDF that is fixed to a link of another, at a pose in that link's frame."""

    urdf: ET.Element
    link: str
    pose: RigidPose


@dataclass(frozen=True)
class Composition:
    """What becomes of a URDF.

    The base's joints named in `base_joints` are added above the URDF's root, which
    stands at `mount` in the base's frame, beside `base_bodies`. `moving` are all
    joints that stay; others are held at `parked`, or at the value nearest to 0.
    `bodies` replace the collision bodies of links, `pieces` the meshes among them.
    `position` and `velocity` replace limits of joints.
    """

    base_joints: Sequence[str]
    mount: RigidPose
    base_bodies: Sequence[Body]
    hand: Attachment | None
    tool: tuple[str, RigidPose] | None
    moving: Sequence[str]
    parked: Mapping[str, float] = field(default_factory=dict)
    bodies: Mapping[str, Sequence[Body]] = field(default_factory=dict)
    position: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    velocity: Mapping[str, float] = field(default_factory=dict)
    pieces: Mapping[str, Sequence[Path]] = field(default_factory=dict)


def compose(urdf: ET.Element, parts: Composition) -> ET.Element:
    """The URDF of the whole robot. Meshes keep the names that they have.

    Raises:
        UrdfError: The parts do not fit together.
    """
    root = deepcopy(urdf)
    edit.keep_to_kinematics(root)
    if parts.hand is not None:
        edit.graft(root, deepcopy(parts.hand.urdf), parts.hand.link, parts.hand.pose)
    if parts.tool is not None:
        link, pose = parts.tool
        edit.add_link(root, TOOL_LINK)
        edit.add_joint(root, f"{TOOL_LINK}_mount", "fixed", link, TOOL_LINK, pose)
    links = edit.links_by_name(root)
    for name, bodies in parts.bodies.items():
        edit.remove_all(links[name], "collision")
        _add_bodies(links[name], "collision", bodies)
    for name, files in parts.pieces.items():
        _replace_meshes(links[name], files)
    if parts.base_joints or parts.base_bodies or parts.mount != RigidPose():
        _add_base(root, parts)
    _limit(root, parts)
    return held(root, _resting(root, parts))


def held(urdf: ET.Element, values: Mapping[str, float]) -> ET.Element:
    """The URDF with joints fixed at values (rad or m), and their followers with them.

    Raises:
        UrdfError: It has no joint of that name.
    """
    root = deepcopy(urdf)
    joints = edit.joints_by_name(root)
    facts = urdf_facts(root, {}).joints
    for name, value in {**values, **_followers(facts, values)}.items():
        if name not in facts:
            raise UrdfError(f"no joint '{name}' to hold still")
        edit.hold(joints[name], value)
    return root


def placed(urdf: ET.Element, pose: RigidPose) -> ET.Element:
    """The URDF with its root at a pose in a new root link, `world_origin`.

    Raises:
        UrdfError: A name is taken.
    """
    root = deepcopy(urdf)
    top = edit.root_link(root)
    edit.add_link(root, "world_origin")
    edit.add_joint(root, "world_origin_mount", "fixed", "world_origin", top, pose)
    return root


def _add_base(root: ET.Element, parts: Composition) -> None:
    """The chain of the base's joints down to `mobile_base`, and the URDF upon it."""
    top = edit.root_link(root)
    names = parts.base_joints
    chain = ["odom", *(f"{n}_link" for n in names[:-1])] if names else []
    for link in (*chain, BASE_LINK):
        edit.add_link(root, link)
    for name, parent, child in zip(names, chain, [*chain[1:], BASE_LINK], strict=True):
        kind, axis = _BASE_JOINTS[name]
        joint = edit.add_joint(root, name, kind, parent, child)
        ET.SubElement(joint, "axis", xyz=axis)
        if kind == "prismatic":
            edit.limit(joint, lower=-_FLOOR, upper=_FLOOR)
    edit.add_joint(root, f"{BASE_LINK}_mount", "fixed", BASE_LINK, top, parts.mount)
    base = edit.links_by_name(root)[BASE_LINK]
    if parts.base_bodies:
        base.append(inertial([(b.shape, b.pose) for b in parts.base_bodies]))
    for kind in ("visual", "collision"):
        _add_bodies(base, kind, parts.base_bodies)


def _add_bodies(link: ET.Element, kind: str, bodies: Sequence[Body]) -> None:
    for body in bodies:
        edit.add_body(link, kind, body.name, deepcopy(body.shape), body.pose)


def _replace_meshes(link: ET.Element, files: Sequence[Path]) -> None:
    """Let a link collide with meshes in its own frame instead of those that it has."""
    for body in link.findall("collision"):
        if body.find("geometry/mesh") is not None:
            link.remove(body)
    shapes = [ET.Element("mesh", filename=str(file)) for file in files]
    bodies = [Body(f"piece_{i}", s, RigidPose()) for i, s in enumerate(shapes)]
    _add_bodies(link, "collision", bodies)


def _limit(root: ET.Element, parts: Composition) -> None:
    """Set limits; those of a follower are what its leader's mean for it."""
    joints = edit.joints_by_name(root)
    for name, (lower, upper) in parts.position.items():
        edit.limit(joints[name], lower=lower, upper=upper)
    for name, velocity in parts.velocity.items():
        edit.limit(joints[name], velocity=velocity)
    facts = urdf_facts(root, {}).joints
    for name, joint in facts.items():
        if joint.mimic is not None and joint.mimic.leader in facts:
            leader = facts[joint.mimic.leader]
            ends = [joint.mimic.position(v) for v in (leader.lower, leader.upper)]
            if math.isfinite(sum(ends)):
                edit.limit(joints[name], lower=min(ends), upper=max(ends))


def _resting(root: ET.Element, parts: Composition) -> dict[str, float]:
    """Where the joints are held that do not move; followers only where that is said."""
    facts = urdf_facts(root, {}).joints
    return {
        name: parts.parked.get(name, min(max(0.0, joint.lower), joint.upper))
        for name, joint in facts.items()
        if name not in parts.moving and (joint.mimic is None or name in parts.parked)
    }


def _followers(
    joints: Mapping[str, UrdfJoint], values: Mapping[str, float]
) -> dict[str, float]:
    """Where the followers of joints that are held are held."""
    return {
        name: joint.mimic.position(values[joint.mimic.leader])
        for name, joint in joints.items()
        if joint.mimic is not None
        and joint.mimic.leader in values
        and name not in values
    }
