"""The nearest points of the robot's links and what stands around them."""

from __future__ import annotations

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
    geometry = world.geometry.clone()
    bodies = world.bodies
    geometry.removeAllCollisionPairs()
    pairs = [
        (i, j)
        for i, mover in enumerate(bodies)
        for j, around in enumerate(bodies)
        if mover.kind in _ROBOT and around.kind in _AROUND
        if (mover.kind, around.kind) != ("base", "ground")
    ]
    for i, j in pairs:
        geometry.addCollisionPair(pin.CollisionPair(i, j))
    data, geometry_data = world.model.createData(), geometry.createData()
    make_exact(geometry_data)
    pin.updateGeometryPlacements(world.model, data, geometry, geometry_data, q)
    found: dict[str, Nearest] = {}
    for pair, (i, j) in enumerate(pairs):
        result = pin.computeDistance(geometry, geometry_data, pair)
        link, distance = bodies[i].owner, float(result.min_distance)
        if link not in found or distance < found[link].distance:
            points = (result.getNearestPoint1(), result.getNearestPoint2())
            on_link, on_obstacle = (np.array(p).reshape(3) for p in points)
            obstacle = bodies[j].owner
            found[link] = Nearest(link, obstacle, distance, on_link, on_obstacle)
    return tuple(found.values())
