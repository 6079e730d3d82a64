"""The scene of a plan as MoveIt's text format, `.scene`."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mmplan.atomic_file import write_whole
from mmplan.collision.mesh_files import TriangleMesh
from mmplan.exports.solids import Thing, objects, obstacles
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.shapes import Array, Box, Capsule, Cone, Cylinder, Shape, Sphere
from mmplan.visualization.rotations import pose_numbers


def write_moveit_scene(problem: Problem, plan: Plan, path: Path) -> None:
    """Obstacles, and objects where they stand before the plan.

    The text is what MoveIt's `PlanningScene::saveGeometryToStream` writes, in the form
    with a pose for each object. Bodies that are no primitives of MoveIt are meshes.

    Raises:
        InputError: The file cannot be written.
    """
    lines = [plan.scene]
    for thing in (*obstacles(problem), *objects(problem)):
        lines += _thing(thing)
    write_whole(path, "\n".join([*lines, ".", ""]))


def _thing(thing: Thing) -> Iterator[str]:
    T = np.eye(4) if thing.T_world_thing is None else thing.T_world_thing
    shapes = [
        (lines, body.T_owner_body @ T_body_shape)
        for body in thing.bodies
        for lines, T_body_shape in _shapes(body.shape)
    ]
    yield f"* {thing.name}"
    yield from _pose(T)
    yield str(len(shapes))
    for lines, T_thing_shape in shapes:
        yield from lines
        yield from _pose(T_thing_shape)
        yield "0 0 0 0"  # no colour
    yield "0"  # no subframes


def _shapes(shape: Shape | TriangleMesh) -> Iterator[tuple[list[str], Array]]:
    """The shapes of MoveIt that fill a body, and their poses in its frame."""
    here = np.eye(4)
    match shape:
        case TriangleMesh():
            yield _mesh(shape), here
        case Box(size):
            yield ["box", _numbers(size)], here
        case Sphere(radius):
            yield ["sphere", _numbers([radius])], here
        case Cylinder(radius, length) | Cone(radius, length):
            yield [type(shape).__name__.lower(), _numbers([radius, length])], here
        case Capsule(radius, length):
            yield ["cylinder", _numbers([radius, length])], here
            for z in (-length / 2, length / 2):
                end = np.eye(4)
                end[2, 3] = z
                yield ["sphere", _numbers([radius])], end
        case _:
            raise TypeError(f"no solid is a {type(shape).__name__}")


def _mesh(mesh: TriangleMesh) -> list[str]:
    return [
        "mesh",
        f"{len(mesh.vertices)} {len(mesh.triangles)}",
        *(_numbers(v) for v in mesh.vertices.tolist()),
        *(" ".join(map(str, t)) for t in mesh.triangles.tolist()),
    ]


def _pose(T: Array) -> list[str]:
    (numbers,) = pose_numbers(T[None]).tolist()
    return [_numbers(numbers[:3]), _numbers(numbers[3:])]


def _numbers(values: list[float] | tuple[float, ...]) -> str:
    return " ".join(repr(float(value)) for value in values)
