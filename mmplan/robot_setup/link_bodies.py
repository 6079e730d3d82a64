"""The bodies that links collide with, and how far they stand off the links' meshes."""

from __future__ import annotations

from collections import Counter
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mmplan.collision.solids import Solid
from mmplan.collision.standoff import Standoff, standoff
from mmplan.robot import Robot
from mmplan.robot_file import RobotDescription
from mmplan.robot_setup.link_meshes import link_meshes


class LinkBodies(NamedTuple):
    """The bodies of a link: what they are, and their standoff if it has meshes.

    `kind` counts them: `2 hulls`, `hull, box`.
    """

    link: str
    kind: str
    standoff: Standoff | None


def link_bodies(robot: Robot, description: RobotDescription) -> list[LinkBodies]:
    """The bodies of every link that has any, in the order of the model."""
    meshes = link_meshes(description)
    bodies = solids_by_link(robot.model, robot.geometry)
    return [
        LinkBodies(
            link,
            _kind(solids, description.collision.get(link, "hull")),
            standoff(solids, meshes[link]) if link in meshes else None,
        )
        for link, solids in bodies.items()
    ]


def solids_by_link(
    model: pin.Model, geometry: pin.GeometryModel
) -> dict[str, list[Solid]]:
    """The bodies of each link, placed in the link's frame."""
    found: dict[str, list[Solid]] = {}
    for body in geometry.geometryObjects:
        frame = model.frames[body.parentFrame]
        T_link_body = np.array((frame.placement.inverse() * body.placement).homogeneous)
        solid = Solid(str(frame.name), body.geometry, T_link_body)
        found.setdefault(solid.owner, []).append(solid)
    return found


def _kind(solids: list[Solid], kind: str) -> str:
    """What the bodies are, counted."""
    mesh = {"decomposed": "piece", "mesh": "mesh"}.get(kind, "hull")
    names = (type(s.geometry).__name__.lower() for s in solids)
    known = ("box", "sphere", "cylinder", "capsule", "cone")
    counted = Counter(name if name in known else mesh for name in names)
    return ", ".join(_number(n, name) for name, n in counted.items())


def _number(n: int, name: str) -> str:
    plural = f"{name}es" if name.endswith(("x", "h")) else f"{name}s"
    return name if n == 1 else f"{n} {plural}"
