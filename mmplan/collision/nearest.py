"""The nearest points of the robot's links and what stands around them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mmplan.collision.requests import make_exact
from mmplan.collision.world import CollisionWorld
from mmplan.shapes import Array

_ROBOT = ("base", "arm", "finger")
_AROUND = ("ground", "obstacle", "standing")


class Nearest(NamedTuple):
    """A link, the obstacle nearest to it, and the two points where they are nearest."""

    link: str
    obstacle: str
    distance: float  # m, negative where they overlap
    on_link: Array  # (3,), m, in the world
    on_obstacle: Array  # (3,), m, in the world


def nearest_obstacles(world: CollisionWorld, q: Array) -> tuple[Nearest, ...]:
    """For each link at q (nq,) its nearest obstacle, as `LinkDistances` has them.

    Links that have no obstacle are left out.
    """
    bodies = world.bodies
    pairs = [
        (i, j)
        for i, mover in enumerate(bodies)
        for j, around in enumerate(bodies)
        if mover.kind in _ROBOT and around.kind in _AROUND
        if (mover.kind, around.kind) != ("base", "ground")
    ]
    found: dict[str, Nearest] = {}
    for nearest in _measured(world, q, pairs):
        link = nearest.link
        if link not in found or nearest.distance < found[link].distance:
            found[link] = nearest
    return tuple(found.values())


def nearest_points(world: CollisionWorld, q: Array, first: str, second: str) -> Array:
    """Where two things, by name, are nearest at q (nq,), or overlap the deepest.

    The points on either, (2, 3), m, in the world.
    """
    owners = [body.owner for body in world.bodies]
    pairs = [
        (i, j)
        for i, one in enumerate(owners)
        for j, other in enumerate(owners)
        if (one, other) == (first, second)
    ]
    nearest = min(_measured(world, q, pairs), key=lambda n: n.distance)
    return np.stack([nearest.on_link, nearest.on_obstacle])


def _measured(
    world: CollisionWorld, q: Array, pairs: Sequence[tuple[int, int]]
) -> Iterator[Nearest]:
    """The distances of pairs of bodies at q (nq,)."""
    geometry = world.geometry.clone()
    geometry.removeAllCollisionPairs()
    for i, j in pairs:
        geometry.addCollisionPair(pin.CollisionPair(i, j))
    data, geometry_data = world.model.createData(), geometry.createData()
    make_exact(geometry_data)
    pin.updateGeometryPlacements(world.model, data, geometry, geometry_data, q)
    for pair, (i, j) in enumerate(pairs):
        result = pin.computeDistance(geometry, geometry_data, pair)
        points = (result.getNearestPoint1(), result.getNearestPoint2())
        on_link, on_obstacle = (np.array(p).reshape(3) for p in points)
        yield Nearest(
            world.owner_of(i),
            world.owner_of(j),
            float(result.min_distance),
            on_link,
            on_obstacle,
        )
