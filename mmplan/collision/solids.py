"""From the shapes of a problem to coal's convex geometries, all of them solids."""

from __future__ import annotations

from dataclasses import dataclass
from functools import singledispatch
from pathlib import Path
from xml.etree import ElementTree as ET

import coal
import numpy as np
import pinocchio as pin

from mmplan.collision import meshes, revolve
from mmplan.exceptions import InputError
from mmplan.files.located_xml import read_xml
from mmplan.files.urdf_meshes import find_mesh
from mmplan.problem import Obstacle
from mmplan.shapes import (
    Array,
    Box,
    Capsule,
    Cone,
    Cylinder,
    Fixture,
    Mesh,
    Revolve,
    Shape,
    Sphere,
)


@dataclass(frozen=True, eq=False)
class Solid:
    """One convex solid. `owner` is the name by which reports speak of it."""

    owner: str
    geometry: coal.CollisionGeometry
    placement: Array  # (4, 4), in the frame of what it belongs to


def solids_of_obstacle(obstacle: Obstacle) -> list[Solid]:
    """The solids of an obstacle, placed in the world."""
    T = obstacle.T_world_obstacle
    if isinstance(obstacle.shape, Fixture):
        return [
            Solid(f"{obstacle.name}/{link}", geometry, T @ placement)
            for link, geometry, placement in _fixture_bodies(obstacle.shape)
        ]
    return [
        Solid(obstacle.name, geometry, T) for geometry in geometries(obstacle.shape)
    ]


@singledispatch
def geometries(shape: Shape) -> list[coal.CollisionGeometry]:
    """The convex geometries that fill a shape, in the shape's frame."""
    raise TypeError(f"no solid for a shape of type {type(shape).__name__}")


@geometries.register
def _(shape: Box) -> list[coal.CollisionGeometry]:
    return [coal.Box(*shape.size)]


@geometries.register
def _(shape: Sphere) -> list[coal.CollisionGeometry]:
    return [coal.Sphere(shape.radius)]


@geometries.register
def _(shape: Cylinder) -> list[coal.CollisionGeometry]:
    return [coal.Cylinder(shape.radius, shape.length)]


@geometries.register
def _(shape: Capsule) -> list[coal.CollisionGeometry]:
    return [coal.Capsule(shape.radius, shape.length)]


@geometries.register
def _(shape: Cone) -> list[coal.CollisionGeometry]:
    return [coal.Cone(shape.radius, shape.length)]


@geometries.register
def _(shape: Revolve) -> list[coal.CollisionGeometry]:
    return [meshes.hull(piece) for piece in revolve.convex_pieces(shape.profile)]


@geometries.register
def _(shape: Mesh) -> list[coal.CollisionGeometry]:
    return meshes.hulls(shape)


def _fixture_bodies(
    fixture: Fixture,
) -> list[tuple[str, coal.CollisionGeometry, Array]]:
    """Link name, geometry and pose in the fixture's frame, at its configuration."""
    model, geometry, meshes_of = _collision_model(fixture)
    q = fixture_configuration(model, fixture)
    data, geometry_data = model.createData(), geometry.createData()
    pin.updateGeometryPlacements(model, data, geometry, geometry_data, q)
    return [
        (model.frames[body.parentFrame].name, solid, T.homogeneous)
        for body, T in zip(geometry.geometryObjects, geometry_data.oMg, strict=True)
        for solid in (
            geometries(meshes_of[body.name])
            if body.name in meshes_of
            else [body.geometry]
        )
    ]


def _collision_model(
    fixture: Fixture,
) -> tuple[pin.Model, pin.GeometryModel, dict[str, Mesh]]:
    """The joints of a fixture and its bodies, and the meshes among these by name.

    Where there is a mesh a ball stands in: Pinocchio would read its triangles.

    Raises:
        InputError: Its URDF cannot be read, or a mesh is missing.
    """
    urdf, meshes_of = read_xml(fixture.path).root, dict[str, Mesh]()
    for link in urdf.iter("link"):
        for number, body in enumerate(link.iterfind("collision/geometry")):
            if (mesh := body.find("mesh")) is not None:
                name = f"{link.get('name')}_{number}"  # as Pinocchio calls it
                meshes_of[name] = _mesh(mesh, fixture.path)
                body.remove(mesh)
                ET.SubElement(body, "sphere", radius="1")
    try:
        model = pin.buildModelFromUrdf(str(fixture.path))
        geometry = pin.buildGeomFromUrdfString(
            model, ET.tostring(urdf, "unicode"), pin.GeometryType.COLLISION
        )
    except (RuntimeError, ValueError) as error:
        raise InputError(
            f"{fixture.path}: this URDF cannot be read: {error}"
        ) from error
    return model, geometry, meshes_of


def _mesh(element: ET.Element, urdf: Path) -> Mesh:
    """The mesh that an element of a URDF names."""
    name = element.get("filename", "")
    path = find_mesh(name, urdf)
    if path is None:
        raise InputError(f"{urdf}: no such mesh: '{name}'")
    x, y, z = (float(word) for word in element.get("scale", "1 1 1").split())
    return Mesh(path, (x, y, z))


def fixture_model(
    fixture: Fixture, kind: pin.GeometryType
) -> tuple[pin.Model, pin.GeometryModel]:
    """The joints of a fixture and its bodies of one kind, visual or collision.

    Raises:
        InputError: Its URDF cannot be read.
    """
    try:
        model = pin.buildModelFromUrdf(str(fixture.path))
        folders = [str(fixture.path.parent)]
        return model, pin.buildGeomFromUrdf(
            model, str(fixture.path), kind, package_dirs=folders
        )
    except (RuntimeError, ValueError) as error:
        raise InputError(
            f"{fixture.path}: this URDF cannot be read: {error}"
        ) from error


def fixture_configuration(model: pin.Model, fixture: Fixture) -> Array:
    """The joints (nq,) of a fixture as Pinocchio keeps them.

    Raises:
        InputError: The fixture has no joint of a name that is given.
    """
    q: Array = np.clip(
        pin.neutral(model), model.lowerPositionLimit, model.upperPositionLimit
    )
    for name, value in fixture.configuration:
        if not model.existJointName(name):
            known = ", ".join(list(model.names)[1:]) or "none"
            raise InputError(
                f"{fixture.path}: no joint '{name}'; joints of this fixture: {known}"
            )
        joint = model.joints[model.getJointId(name)]
        # Pinocchio keeps a continuous joint as its cosine and sine.
        q[joint.idx_q : joint.idx_q + joint.nq] = (
            value if joint.nq == 1 else (np.cos(value), np.sin(value))
        )
    return q
