"""The scene of a plan as a model of MuJoCo, to replay the plan in."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np

from mmplan.atomic_file import write_whole
from mmplan.collision.mesh_files import TriangleMesh
from mmplan.exports.solids import Body, Thing, objects, obstacles
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.shapes import Array, Box, Capsule, Cylinder, Sphere
from mmplan.visualization.rotations import pose_numbers
from mmplan.visualization.surface import surface_of


def write_mjcf(problem: Problem, plan: Plan, path: Path) -> None:
    """Obstacles fixed in the world, objects free to be moved.

    Every body has the name of its obstacle, link (`fixture/link`) or object. The robot
    is not in it: MuJoCo reads its URDF, which `mmplan robot urdf` prints.

    Raises:
        InputError: The file cannot be written.
    """
    root = ET.Element("mujoco", model=plan.scene)
    assets = ET.SubElement(root, "asset")
    world = ET.SubElement(root, "worldbody")
    ET.SubElement(world, "light", pos="0 0 4", dir="0 0 -1", directional="true")
    for thing in obstacles(problem):
        _add(assets, ET.SubElement(world, "body", name=thing.name), thing, _STILL)
    for thing in objects(problem):
        T = np.eye(4) if thing.T_world_thing is None else thing.T_world_thing
        body = ET.SubElement(world, "body", _pose(T), name=thing.name)
        ET.SubElement(body, "freejoint", name=thing.name)
        _add(assets, body, thing, _MOVED)
    ET.indent(root)
    write_whole(path, ET.tostring(root, encoding="unicode") + "\n")


_STILL, _MOVED = "0.7 0.68 0.64 1", "0.11 0.56 0.6 1"


def _add(assets: ET.Element, parent: ET.Element, thing: Thing, rgba: str) -> None:
    for number, body in enumerate(thing.bodies):
        name = f"{thing.name}#{number}"
        attributes = {**_shape(assets, name, body), **_pose(body.T_owner_body)}
        ET.SubElement(parent, "geom", attributes, name=name, rgba=rgba)


def _shape(assets: ET.Element, name: str, body: Body) -> dict[str, str]:
    """The attributes of a geom; meshes are written into the assets."""
    match body.shape:
        case Box(size):
            return {"type": "box", "size": _text(np.array(size) / 2)}
        case Sphere(radius):
            return {"type": "sphere", "size": _text(np.array([radius]))}
        case Cylinder(radius, length):
            return {"type": "cylinder", "size": _text(np.array([radius, length / 2]))}
        case Capsule(radius, length):
            return {"type": "capsule", "size": _text(np.array([radius, length / 2]))}
        case TriangleMesh(vertices, triangles):
            pass
        case shape:
            surface = surface_of(shape)
            vertices, triangles = surface.vertices, surface.triangles
    faces = " ".join(map(str, triangles.ravel().tolist()))
    ET.SubElement(assets, "mesh", name=name, vertex=_text(vertices), face=faces)
    return {"type": "mesh", "mesh": name}


def _pose(T: Array) -> dict[str, str]:
    """Position and quaternion, which MuJoCo wants with w first."""
    (numbers,) = pose_numbers(T[None])
    return {"pos": _text(numbers[:3]), "quat": _text(numbers[[6, 3, 4, 5]])}


def _text(values: Array) -> str:
    return " ".join(repr(value) for value in np.ravel(values).tolist())
