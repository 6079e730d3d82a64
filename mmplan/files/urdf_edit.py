"""Changes to a URDF, as XML: joints and links are added, held still, limited."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from copy import deepcopy
from pathlib import Path
from xml.etree import ElementTree as ET

from mmplan.files.rigid_pose import RigidPose, Vector, about, along, from_rpy
from mmplan.files.urdf import UrdfError


def add_link(root: ET.Element, name: str) -> ET.Element:
    """A new link without any bodies.

    Raises:
        UrdfError: There is a link of that name.
    """
    if any(link.get("name") == name for link in root.findall("link")):
        raise UrdfError(f"two links would have the name '{name}'")
    return ET.SubElement(root, "link", name=name)


def add_joint(
    root: ET.Element,
    name: str,
    kind: str,
    parent: str,
    child: str,
    pose: RigidPose | None = None,
) -> ET.Element:
    """A new joint at a pose in its parent's frame.

    Raises:
        UrdfError: There is a joint of that name.
    """
    if any(joint.get("name") == name for joint in root.findall("joint")):
        raise UrdfError(f"two joints would have the name '{name}'")
    joint = ET.SubElement(root, "joint", name=name, type=kind)
    if pose is not None:
        set_pose(joint, pose)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    return joint


def add_body(
    link: ET.Element, kind: str, name: str, shape: ET.Element, pose: RigidPose
) -> None:
    """A body of a link: one of `kind` visual or collision."""
    body = ET.SubElement(link, kind, name=name)
    set_pose(body, pose)
    ET.SubElement(body, "geometry").append(shape)


def graft(root: ET.Element, other: ET.Element, link: str, pose: RigidPose) -> None:
    """Fix the whole of another URDF to a link, its root at a pose in the link's frame.

    Raises:
        UrdfError: A name of a link or joint is in both.
    """
    top = root_link(other)
    for tag in ("link", "joint"):
        taken = {element.get("name") for element in root.findall(tag)}
        for element in other.findall(tag):
            if element.get("name") in taken:
                message = f"two {tag}s would have the name '{element.get('name')}'"
                raise UrdfError(message)
            root.append(element)
    colours = {element.get("name") for element in root.findall("material")}
    root.extend(m for m in other.findall("material") if m.get("name") not in colours)
    add_joint(root, f"{top}_mount", "fixed", link, top, pose)


def root_link(root: ET.Element) -> str:
    """The one link that no joint moves.

    Raises:
        UrdfError: There is none, or more than one.
    """
    children = {joint_link(joint, "child") for joint in root.findall("joint")}
    links = [link.get("name", "") for link in root.findall("link")]
    tops = [name for name in links if name not in children]
    if len(tops) != 1:
        found = ", ".join(tops) or "none"
        raise UrdfError(f"a URDF has exactly one root link; found {found}")
    return tops[0]


def joint_link(joint: ET.Element, role: str) -> str:
    """The link that is the joint's `parent` or `child`."""
    element = joint.find(role)
    return "" if element is None else element.get("link", "")


def hold(joint: ET.Element, value: float) -> None:
    """Make a joint of one degree of freedom fixed, at a value (rad or m)."""
    move = along if joint.get("type") == "prismatic" else about
    set_pose(joint, pose_of(joint) @ move(_axis(joint), value))
    joint.set("type", "fixed")
    for tag in ("axis", "limit", "mimic", "dynamics", "safety_controller"):
        remove_all(joint, tag)


def limit(joint: ET.Element, **values: float) -> None:
    """Set limits of a joint: `lower`, `upper` (rad or m), `velocity`, `effort`.

    A continuous joint with position limits is a revolute one.
    """
    element = joint.find("limit")
    if element is None:
        element = ET.SubElement(joint, "limit", effort="0", velocity="0")
    for name, value in values.items():
        element.set(name, repr(value))
    if "lower" in values and joint.get("type") == "continuous":
        joint.set("type", "revolute")


def remove_all(element: ET.Element, tag: str) -> None:
    """Remove the children of that tag."""
    for child in element.findall(tag):
        element.remove(child)


def keep_to_kinematics(root: ET.Element) -> None:
    """Leave out what is about simulators, controllers and safety margins."""
    kept = ("link", "joint", "material")
    for element in [e for e in root if e.tag not in kept]:
        root.remove(element)


def named_meshes(urdf: ET.Element, files: Mapping[str, Path]) -> ET.Element:
    """The URDF with each mesh named by the path of its file."""
    root = deepcopy(urdf)
    for mesh in root.iter("mesh"):
        mesh.set("filename", str(files[mesh.get("filename", "")].resolve()))
    return root


def rename_link(root: ET.Element, name: str, other: str) -> None:
    """Give a link another name, wherever it is named; nothing if there is none."""
    for element in root.iter():
        key = "name" if element.tag == "link" else "link"
        if element.tag in ("link", "parent", "child") and element.get(key) == name:
            element.set(key, other)


def joints_by_name(root: ET.Element) -> dict[str, ET.Element]:
    """The joints in the order of the URDF."""
    return dict(_named(root, "joint"))


def links_by_name(root: ET.Element) -> dict[str, ET.Element]:
    """The links in the order of the URDF."""
    return dict(_named(root, "link"))


def _named(root: ET.Element, tag: str) -> Iterator[tuple[str, ET.Element]]:
    for element in root.findall(tag):
        yield element.get("name", ""), element


def pose_of(element: ET.Element) -> RigidPose:
    """The pose in the element's origin."""
    origin = element.find("origin")
    if origin is None:
        return RigidPose()
    return from_rpy(_vector(origin, "xyz"), _vector(origin, "rpy"))


def set_pose(element: ET.Element, pose: RigidPose) -> None:
    """Replace the element's origin."""
    remove_all(element, "origin")
    xyz, rpy = (" ".join(map(repr, v)) for v in (pose.xyz, pose.rpy))
    element.insert(0, ET.Element("origin", xyz=xyz, rpy=rpy))


def _axis(joint: ET.Element) -> Vector:
    axis = joint.find("axis")
    direction = (1.0, 0.0, 0.0) if axis is None else _vector(axis, "xyz")
    if math.hypot(*direction) == 0.0:
        raise UrdfError(f"the axis of joint '{joint.get('name')}' has no direction")
    return direction


def _vector(element: ET.Element, name: str) -> Vector:
    words = element.get(name, "0 0 0").split()
    try:
        x, y, z = (float(word) for word in words)
    except ValueError:
        message = f"expected 3 numbers for '{name}' of <{element.tag}>"
        raise UrdfError(f"{message}, got '{element.get(name)}'") from None
    return (x, y, z)
