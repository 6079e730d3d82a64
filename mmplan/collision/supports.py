"""What an object stands on."""

from __future__ import annotations

import coal
import numpy as np

from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.collision.scenery import Scenery
from mmplan.collision.solids import Solid
from mmplan.shapes import Array


def clearances(
    scenery: Scenery, name: str, T_world_object: Array, within: float
) -> dict[str, float]:
    """Distances (m) to the obstacles nearer than `within`, negative where overlapping.

    Keys are the obstacles' names; `T_world_object` (4, 4) is where the object is.
    """
    own = scenery.objects[name]
    own_bounds = _world_bounds(own, T_world_object)
    near: dict[str, float] = {}
    for obstacle in scenery.obstacles:
        bounds = _world_bounds((obstacle,), np.eye(4))
        for i in np.flatnonzero(own_bounds.gap(bounds) <= within):
            distance = _distance(own[i], T_world_object, obstacle)
            if distance <= within:
                near[obstacle.owner] = min(distance, near.get(obstacle.owner, np.inf))
    return near


def supports(
    scenery: Scenery, name: str, T_world_object: Array, tolerance: float
) -> dict[str, float]:
    """The obstacles that an object at rest touches: name -> `tolerance`.

    Touching is a distance or a depth of at most `tolerance` (m); the returned mapping
    is what `CollisionWorld.permit_touch` takes.
    """
    near = clearances(scenery, name, T_world_object, tolerance)
    return {owner: tolerance for owner, d in near.items() if d >= -tolerance}


def _world_bounds(solids: tuple[Solid, ...], T_world_owner: Array) -> Bounds:
    local = [local_bounds(s.geometry) for s in solids]
    stacked = Bounds(
        np.array([b.centre for b in local]), np.array([b.half for b in local])
    )
    placements = np.array([s.placement for s in solids])
    return moved_bounds(stacked, T_world_owner @ placements)


def _distance(solid: Solid, T_world_owner: Array, obstacle: Solid) -> float:
    return float(
        coal.distance(
            solid.geometry,
            _transform(T_world_owner @ solid.placement),
            obstacle.geometry,
            _transform(obstacle.placement),
            coal.DistanceRequest(),
            coal.DistanceResult(),
        )
    )


def _transform(T: Array) -> coal.Transform3s:
    return coal.Transform3s(T[:3, :3], T[:3, 3])
