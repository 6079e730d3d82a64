"""The parts of obstacles, fixtures and objects."""

from __future__ import annotations

import zlib
from collections.abc import Iterator

import numpy as np
import pinocchio as pin

from mmplan.collision.mesh_files import read_surface
from mmplan.collision.solids import fixture_configuration, fixture_model
from mmplan.problem import Object, Obstacle
from mmplan.shapes import Fixture, Mesh, Shape
from mmplan.visualization.part import WORLD, Colour, Part, merged, object_carrier
from mmplan.visualization.smoothing import coarsened, with_edges
from mmplan.visualization.surface import Surface, surface_of
from mmplan.visualization.urdf_parts import urdf_parts

_GROUND = Colour(0.82, 0.82, 0.8)
# An obstacle as thin and as tall as this is a wall, which one sees through, m.
_WALL_THICKNESS, _WALL_HEIGHT, _WALL_OPACITY = 0.2, 1.5, 0.25
_OBSTACLES = (
    Colour(0.72, 0.66, 0.58),
    Colour(0.62, 0.67, 0.72),
    Colour(0.69, 0.71, 0.64),
    Colour(0.75, 0.72, 0.69),
    Colour(0.6, 0.62, 0.66),
)
# A mesh with more triangles than this is drawn with fewer.
_MOST_TRIANGLES = 60_000
_OBJECTS = (
    Colour(0.11, 0.56, 0.6),
    Colour(0.8, 0.42, 0.16),
    Colour(0.5, 0.36, 0.68),
    Colour(0.75, 0.25, 0.4),
)


def obstacle_parts(obstacle: Obstacle) -> list[Part]:
    """The parts of an obstacle, in the world."""
    T = obstacle.T_world_obstacle
    if isinstance(obstacle.shape, Fixture):
        parts = [
            Part(p.name, p.surface.moved(T), p.colour)
            for p in _fixture_parts(obstacle.name, obstacle.shape)
        ]
        return merged(parts, obstacle.name)
    surface = shape_surface(obstacle.shape).moved(T)
    return [Part(obstacle.name, surface, _colour_of_obstacle(obstacle, surface))]


def object_parts(item: Object, number: int) -> list[Part]:
    """The parts of the `number`th object, in its own frame."""
    colour = _OBJECTS[number % len(_OBJECTS)]
    surface = shape_surface(item.shape)
    return [Part(item.name, surface, colour, object_carrier(item.name))]


def shape_surface(shape: Shape) -> Surface:
    """The surface of a shape in its own frame, fit to be drawn.

    Raises:
        InputError: Its mesh cannot be read.
    """
    if isinstance(shape, Mesh):
        surface = Surface(*read_surface(shape))
        return with_edges(coarsened(surface, _MOST_TRIANGLES))
    return with_edges(surface_of(shape))


def _fixture_parts(name: str, fixture: Fixture) -> Iterator[Part]:
    model, visual = fixture_model(fixture, pin.GeometryType.VISUAL)
    _, collision = fixture_model(fixture, pin.GeometryType.COLLISION)
    data = model.createData()
    pin.forwardKinematics(model, data, fixture_configuration(model, fixture))
    yield from urdf_parts(
        model, visual, collision, name, lambda joint: (WORLD, data.oMi[joint])
    )


def _colour_of_obstacle(obstacle: Obstacle, surface: Surface) -> Colour:
    """A colour that depends on the name, so that it is the same in all pictures."""
    if obstacle.ground:
        return _GROUND
    colour = _OBSTACLES[zlib.crc32(obstacle.name.encode()) % len(_OBSTACLES)]
    size = np.ptp(surface.vertices, axis=0)
    wall = size.min() <= _WALL_THICKNESS and size[2] >= _WALL_HEIGHT
    return colour._replace(opacity=_WALL_OPACITY) if wall else colour
