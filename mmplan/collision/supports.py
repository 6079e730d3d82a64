"""What an object touches where it stands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType

import numpy as np

from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.collision.scenery import Scenery
from mmplan.collision.separation import signed_distance, transform
from mmplan.collision.solids import Solid
from mmplan.shapes import Array

_NOTHING: Mapping[str, Array] = MappingProxyType({})


def clearances(
    scenery: Scenery,
    name: str,
    T_world_object: Array,
    within: float,
    standing: Mapping[str, Array] = _NOTHING,
) -> dict[str, float]:
    """Signed distances (m) to everything nearer to an object than `within`.

    Keys are the names of obstacles and of the objects `standing` at their poses;
    negative is the depth of overlap. `T_world_object` (4, 4) is where the object is.
    """
    own = scenery.objects[name]
    own_bounds = _world_bounds(own, T_world_object)
    near: dict[str, float] = {}
    for other, T_world_owner in _others(scenery, name, standing):
        bounds = _world_bounds((other,), T_world_owner)
        for i in np.flatnonzero(own_bounds.gap(bounds) <= max(within, 0.0)):
            distance = signed_distance(
                own[i].geometry,
                transform(T_world_object @ own[i].placement),
                other.geometry,
                transform(T_world_owner @ other.placement),
            )
            if distance <= within:
                near[other.owner] = min(distance, near.get(other.owner, np.inf))
    return near


def supports(
    scenery: Scenery,
    name: str,
    T_world_object: Array,
    tolerance: float,
    standing: Mapping[str, Array] = _NOTHING,
) -> dict[str, float]:
    """What an object at rest touches: name -> `tolerance`.

    Touching is a distance or a depth of at most `tolerance` (m); the returned mapping
    is what `CollisionWorld.permit_touch` takes.
    """
    near = clearances(scenery, name, T_world_object, tolerance, standing)
    return {owner: tolerance for owner, d in near.items() if d >= -tolerance}


def _others(
    scenery: Scenery, name: str, standing: Mapping[str, Array]
) -> Iterator[tuple[Solid, Array]]:
    """All solids but an object's own, and the pose of what they belong to."""
    for solid in scenery.obstacles:
        yield solid, np.eye(4)
    for other, T_world_other in standing.items():
        if other != name:
            for solid in scenery.objects[other]:
                yield solid, T_world_other


def _world_bounds(solids: tuple[Solid, ...], T_world_owner: Array) -> Bounds:
    local = [local_bounds(s.geometry) for s in solids]
    stacked = Bounds(
        np.array([b.centre for b in local]), np.array([b.half for b in local])
    )
    placements = np.array([s.placement for s in solids])
    return moved_bounds(stacked, T_world_owner @ placements)
