"""The nearest miss to look at: the robot there, what touches, what is missing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pinocchio as pin

from mmplan.collision import CollisionWorld
from mmplan.explanation.near_miss import NearMiss
from mmplan.problem import Problem
from mmplan.scoring import End
from mmplan.shapes import Array, Sphere
from mmplan.visualization.exhibit import Exhibit, exhibit_of_moment
from mmplan.visualization.part import ROBOT, SCENE, WORLD, Colour, Part, joint_carrier
from mmplan.visualization.surface import Surface, joined, surface_of, tube
from mmplan.visualization.urdf_parts import body_surface

MISS = "miss"  # the layer
_FIRST, _SECOND = Colour(0.85, 0.1, 0.1, 0.5), Colour(0.95, 0.6, 0.05, 0.5)
_LINE = Colour(0.05, 0.05, 0.05)
_FADED = 0.3  # opacity of what would hide the place
_SWELL = 0.0005  # m, by which what is highlighted stands out
_RADIUS, _BALL = 0.004, 0.007  # m, of the line and of its ends


def exhibit_of_miss(problem: Problem, miss: NearMiss) -> Exhibit:
    """The nearest miss of a problem's only task.

    What touches is red and orange: the bodies that collision is judged by, seen
    through, and between them the line that joins the points where they overlap the
    deepest. Where the tool falls short the line leads from there to the grasp; where a
    joint is beyond its limit, what it moves is red.
    """
    (task,) = problem.tasks
    world = CollisionWorld.of_problem(problem)
    if miss.end == End.GOAL:
        world = world.place(task.object, task.T_world_goal)
    q = np.array(miss.q)
    bodies = _bodies(world, q)
    focus = miss.line or problem.robot.tool_pose(q)[None, :3, 3]
    more = [*_highlighted(world, bodies, miss), *_line(miss)]
    exhibit = exhibit_of_moment(problem, q, world.standing, more)
    hiding = {joint_carrier(world.model.names[j]) for j in _joints(world, miss)}
    return replace(
        exhibit,
        subtitle=str(miss),
        parts=tuple(_seen_through(part, hiding, miss) for part in exhibit.parts),
        focus=np.array(focus),
    )


def _bodies(world: CollisionWorld, q: Array) -> list[Surface]:
    """All bodies of a world at q (nq,), a little swollen."""
    geometry = world.geometry
    data, placed = world.model.createData(), geometry.createData()
    pin.updateGeometryPlacements(world.model, data, geometry, placed, q)
    return [
        _swollen(body_surface(body)).moved(T.homogeneous)
        for body, T in zip(geometry.geometryObjects, placed.oMg, strict=True)
    ]


def _swollen(surface: Surface) -> Surface:
    vertices = surface.vertices + _SWELL * surface.normals
    return Surface(vertices, surface.triangles)


def _highlighted(
    world: CollisionWorld, surfaces: Sequence[Surface], miss: NearMiss
) -> Iterator[Part]:
    """The two things that touch, or what the joint moves that is beyond its limit."""
    moved = _joints(world, miss)
    for name, colour in ((miss.first, _FIRST), (miss.second, _SECOND)):
        some = [
            surface
            for surface, body in zip(surfaces, world.bodies, strict=True)
            if (body.owner == name if miss.kind == "overlap" else body.joint in moved)
        ]
        if some and name is not None:
            yield Part(f"{name}, highlighted", joined(some), colour, WORLD, MISS)


def _joints(world: CollisionWorld, miss: NearMiss) -> set[int]:
    """The joints that move what is highlighted."""
    if miss.kind == "overlap":
        named = {miss.first, miss.second}
        return {b.joint for b in world.bodies if b.owner in named} - {0}
    if miss.kind == "reach":
        return set()
    return {int(world.model.getJointId(miss.first))}


def _seen_through(part: Part, carriers: set[str], miss: NearMiss) -> Part:
    """A part, faded if it is of what is highlighted and would hide it."""
    thing = part.name.partition("/")[0]
    if part.layer == ROBOT and part.carrier in carriers:
        return replace(part, colour=part.colour._replace(opacity=_FADED))
    if part.layer == SCENE and thing == str(miss.second).partition("/")[0]:
        colour = part.colour._replace(opacity=_FADED)
        return replace(part, colour=colour, layer=MISS)
    return part


def _line(miss: NearMiss) -> Iterator[Part]:
    """The line and balls at its ends."""
    if miss.line is None:
        return
    points = np.array(miss.line)
    ball = surface_of(Sphere(_BALL))
    balls = [Surface(ball.vertices + p, ball.triangles) for p in points]
    surface = joined([tube(points, _RADIUS), *balls])
    yield Part("what is missing", surface, _LINE, WORLD, MISS)
