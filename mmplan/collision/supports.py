"""What an object touches where it stands."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from mmplan.collision.bounds import Bounds, local_bounds, touching_depth
from mmplan.collision.scenery import Scenery, world_bounds
from mmplan.collision.separation import signed_distance, transform
from mmplan.collision.solids import Solid
from mmplan.shapes import Array

_NOTHING: Mapping[str, Array] = MappingProxyType({})


class Overlap(NamedTuple):
    """How deep (m) two things overlap that rest in contact, and how deep they may."""

    depth: float
    allowed: float


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
    near: dict[str, float] = {}
    for _, other, distance in _near(scenery, name, T_world_object, within, standing):
        near[other.owner] = min(distance, near.get(other.owner, np.inf))
    return near


def overlaps(
    scenery: Scenery,
    name: str,
    T_world_object: Array,
    tolerance: float,
    standing: Mapping[str, Array] = _NOTHING,
) -> dict[str, Overlap]:
    """What an object at rest overlaps deeper than touching allows, by name.

    That is deeper than `tolerance` (m), or than thin bodies may, see `touching_depth`.
    """
    found: dict[str, Overlap] = {}
    for own, other, distance in _near(scenery, name, T_world_object, 0.0, standing):
        local = local_bounds(own.geometry), local_bounds(other.geometry)
        overlap = Overlap(-distance, touching_depth(*local, tolerance))
        if overlap.depth > overlap.allowed:
            found[other.owner] = max(overlap, found.get(other.owner, overlap))
    return found


def supports(
    scenery: Scenery,
    name: str,
    T_world_object: Array,
    tolerance: float,
    standing: Mapping[str, Array] = _NOTHING,
) -> dict[str, float]:
    """What an object at rest touches: name -> `tolerance`.

    Touching is a distance of at most `tolerance` (m) or an overlap that is none of
    `overlaps`; the returned mapping is what `CollisionWorld.permit_touch` takes.
    """
    near = clearances(scenery, name, T_world_object, tolerance, standing)
    deep = overlaps(scenery, name, T_world_object, tolerance, standing)
    return {owner: tolerance for owner in near if owner not in deep}


def _near(
    scenery: Scenery,
    name: str,
    T_world_object: Array,
    within: float,
    standing: Mapping[str, Array],
) -> Iterator[tuple[Solid, Solid, float]]:
    """Solids of an object and of others that are that near, with their distances."""
    solids = scenery.objects[name]
    bounds = world_bounds(solids, T_world_object)
    for others, T_world_owner, around in _others(scenery, name, standing):
        each = Bounds(bounds.centre[:, None], bounds.half[:, None])
        near = each.gap(around) <= max(within, 0.0)
        for j, i in np.argwhere(near.T).tolist():
            distance = signed_distance(
                solids[i].geometry,
                transform(T_world_object @ solids[i].placement),
                others[j].geometry,
                transform(T_world_owner @ others[j].placement),
            )
            if distance <= within:
                yield solids[i], others[j], distance


def _others(
    scenery: Scenery, name: str, standing: Mapping[str, Array]
) -> Iterator[tuple[tuple[Solid, ...], Array, Bounds]]:
    """All solids but an object's own, the pose of what they belong to, and bounds."""
    yield scenery.obstacles, np.eye(4), scenery.obstacle_bounds
    for other, T_world_other in standing.items():
        if other != name:
            solids = scenery.objects[other]
            yield solids, T_world_other, world_bounds(solids, T_world_other)
