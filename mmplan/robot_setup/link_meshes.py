"""The collision meshes of links, as they stand in the URDFs of a robot."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from mmplan.collision.mesh_files import read_mesh
from mmplan.collision.solids import Solid
from mmplan.files.located_xml import read_xml
from mmplan.files.urdf_edit import pose_of
from mmplan.robot_file import RobotDescription
from mmplan.shapes import Array, Mesh


def link_meshes(description: RobotDescription) -> dict[str, list[Solid]]:
    """The meshes of each link that has any, placed in the link's frame.

    They are those that the URDFs name, whatever the robot.yaml takes for them.

    Raises:
        InputError: A mesh cannot be read.
    """
    found: dict[str, list[Solid]] = {}
    for role in ("robot urdf", "hand urdf"):
        if role in description.files:
            for solid in _meshes(description.files, role):
                found.setdefault(solid.owner, []).append(solid)
    return found


def _meshes(files: Mapping[str, Path], role: str) -> Iterator[Solid]:
    for link in read_xml(files[role]).root.findall("link"):
        for collision in link.findall("collision"):
            for mesh in collision.iterfind("geometry/mesh"):
                path = files[f"{role} {mesh.get('filename', '')}"]
                surface = read_mesh(Mesh(path, _scale(mesh)))
                yield Solid(link.get("name", ""), surface, _pose(collision))


def _scale(mesh: ET.Element) -> tuple[float, float, float]:
    x, y, z = (float(word) for word in mesh.get("scale", "1 1 1").split())
    return x, y, z


def _pose(collision: ET.Element) -> Array:
    pose = pose_of(collision)
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = pose.R, pose.xyz
    return T
