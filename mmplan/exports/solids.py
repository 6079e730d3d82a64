"""The bodies of a scene as convex shapes that other programs know."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from mmplan.collision import Scenery
from mmplan.collision.mesh_files import TriangleMesh
from mmplan.collision.solids import Solid
from mmplan.collision.surfaces import appearance
from mmplan.problem import Problem
from mmplan.shapes import Array, Shape


class Body(NamedTuple):
    """One convex body in the frame of what it belongs to."""

    shape: Shape | TriangleMesh
    T_owner_body: Array  # (4, 4)


class Thing(NamedTuple):
    """An obstacle, a link of a fixture or an object: where it is, what it is made of.

    Obstacles have their bodies in the world.
    """

    name: str
    bodies: tuple[Body, ...]
    T_world_thing: Array | None = None  # (4, 4) of an object


def obstacles(problem: Problem) -> Iterator[Thing]:
    """All obstacles and links of fixtures, by name."""
    by_owner: dict[str, list[Solid]] = {}
    for solid in Scenery.of_problem(problem).obstacles:
        by_owner.setdefault(solid.owner, []).append(solid)
    for name, solids in by_owner.items():
        yield Thing(name, _bodies(solids))


def objects(problem: Problem) -> Iterator[Thing]:
    """All objects where they stand at the start."""
    for item in problem.objects:
        solids = list(Scenery.solids_of_object(item))
        yield Thing(item.name, _bodies(solids), item.T_world_object)


def _bodies(solids: list[Solid]) -> tuple[Body, ...]:
    return tuple(Body(appearance(s.geometry), s.placement) for s in solids)
