"""An arena as files and plain numbers, for planners that know nothing of mmplan.

The robot becomes a URDF whose collision bodies are those that mmplan checks, convex
hulls as OBJ meshes among them, and an SRDF with the pairs of links that it does not
check. Joints that stand still are fixed.
"""

from __future__ import annotations

from itertools import combinations
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

from mmplan.benchmarking.paths.arena import Arena
from mmplan.collision.mesh_files import TriangleMesh
from mmplan.collision.surfaces import appearance
from mmplan.files import urdf_edit as edit
from mmplan.files.rigid_pose import RigidPose
from mmplan.files.urdf_composition import held
from mmplan.robot import Robot
from mmplan.robot_file import load_robot_description
from mmplan.shapes import Array, Box, Cylinder, Sphere

GROUP = "moving"


def describe(arena: Arena, folder: Path) -> dict[str, Any]:
    """The arena for `serve.py`; its files are written to a folder."""
    robot, joints = arena.world.robot, arena.joints
    urdf, srdf = folder / "robot.urdf", folder / "robot.srdf"
    urdf.write_bytes(ET.tostring(_urdf(arena, folder)))
    srdf.write_bytes(ET.tostring(_srdf(robot, joints.names)))
    return {
        "urdf": str(urdf),
        "srdf": str(srdf),
        "group": GROUP,
        "tip": robot.model.frames[robot.tool_frame].name,
        "joints": list(joints.names),
        "lower": joints.lower.tolist(),
        "upper": joints.upper.tolist(),
        "start": arena.q_start[joints.indices].tolist(),
        "goal": arena.q_goal[joints.indices].tolist(),
        "still": _still_links(robot),
        "obstacles": [
            {
                "name": f"obstacle_{i}",
                **_shape(o.shape),
                "pose": o.T_world_obstacle.tolist(),
            }
            for i, o in enumerate(arena.problem.obstacles)
        ],
    }


def _urdf(arena: Arena, folder: Path) -> ET.Element:
    robot, joints = arena.world.robot, arena.joints
    description = load_robot_description(robot.path)
    still = {
        name: float(arena.q_start[int(index)])
        for group in (robot.base, robot.arm, robot.hand)
        for name, index in zip(group.names, group.indices, strict=True)
        if name not in joints.names
    }
    root = held(ET.fromstring(description.urdf), still)
    by_name = edit.joints_by_name(root)
    for name, lower, upper in zip(
        joints.names, joints.lower, joints.upper, strict=True
    ):
        edit.limit(by_name[name], lower=float(lower), upper=float(upper))
    links = edit.links_by_name(root)
    for link in links.values():
        edit.remove_all(link, "visual")
        edit.remove_all(link, "collision")
    for number, body in enumerate(robot.geometry.geometryObjects):
        frame = robot.model.frames[body.parentFrame]
        T_link_body = frame.placement.inverse() * body.placement
        look = appearance(body.geometry)
        name = f"body_{number}"
        if isinstance(look, TriangleMesh):
            mesh = folder / f"{name}.obj"
            _write_mesh(mesh, look)
            shape = ET.Element("mesh", filename=str(mesh))
            _mark_convex(links[frame.name], name)
        else:
            shape = _element(look)
        pose = _rigid(T_link_body.homogeneous)
        edit.add_body(links[frame.name], "collision", name, shape, pose)
    return root


def _still_links(robot: Robot) -> list[str]:
    """The links with bodies that no joint moves."""
    bodies = robot.geometry.geometryObjects
    frames = [robot.model.frames[b.parentFrame] for b in bodies if not b.parentJoint]
    return list(dict.fromkeys(frame.name for frame in frames))


def _mark_convex(link: ET.Element, body: str) -> None:
    """Tell Pinocchio that a mesh is convex."""
    checking = link.find("collision_checking")
    if checking is None:
        checking = ET.SubElement(link, "collision_checking")
    ET.SubElement(checking, "convex", name=body)


def _write_mesh(path: Path, mesh: TriangleMesh) -> None:
    """A mesh as OBJ, and as the STL that mplib takes for its hull."""
    lines = ["v " + " ".join(map(repr, v)) for v in mesh.vertices.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (mesh.triangles + 1).tolist()]
    path.write_text("\n".join(lines) + "\n")
    facets = np.zeros(len(mesh.triangles), [("numbers", "<f4", 12), ("note", "<u2")])
    corners = mesh.vertices[mesh.triangles].reshape(-1, 9)
    facets["numbers"][:, 3:] = corners  # readers compute the normals
    count = np.uint32(len(facets)).tobytes()
    stl = path.with_name(f"{path.name}.convex.stl")
    stl.write_bytes(bytes(80) + count + facets.tobytes())


def _element(shape: object) -> ET.Element:
    match shape:
        case Box(size):
            return ET.Element("box", size=" ".join(map(repr, size)))
        case Cylinder(radius, length):
            return ET.Element("cylinder", radius=repr(radius), length=repr(length))
        case Sphere(radius):
            return ET.Element("sphere", radius=repr(radius))
    raise TypeError(f"no URDF element for {shape}")


def _shape(shape: object) -> dict[str, Any]:
    match shape:
        case Box(size):
            return {"type": "box", "size": list(size)}
        case Cylinder(radius, length):
            return {"type": "cylinder", "radius": radius, "length": length}
        case Sphere(radius):
            return {"type": "sphere", "radius": radius}
    raise TypeError(f"no peer knows {shape}")


def _rigid(T: Array) -> RigidPose:
    x, y, z = T[:3, 3].tolist()
    rows = tuple(tuple(row) for row in T[:3, :3].tolist())
    return RigidPose((x, y, z), rows)


def _srdf(robot: Robot, joints: tuple[str, ...]) -> ET.Element:
    root = ET.Element("robot", name=robot.name)
    group = ET.SubElement(root, "group", name=GROUP)
    for name in joints:
        ET.SubElement(group, "joint", name=name)
    objects = robot.geometry.geometryObjects
    owners = [robot.model.frames[body.parentFrame].name for body in objects]
    checked = {
        frozenset((owners[pair.first], owners[pair.second]))
        for pair in robot.geometry.collisionPairs
    }
    for first, second in combinations(dict.fromkeys(owners), 2):
        if frozenset((first, second)) not in checked:
            ET.SubElement(
                root, "disable_collisions", link1=first, link2=second, reason="Never"
            )
    return root


def path_of(arena: Arena, waypoints: list[list[float]] | None) -> Array | None:
    """Configurations (n, nq) of the joints' values that a peer has answered with."""
    if waypoints is None:
        return None
    path = np.tile(arena.q_start, (len(waypoints), 1))
    path[:, arena.joints.indices] = waypoints
    return arena.joints.with_followers(path)
