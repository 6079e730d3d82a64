"""Regions of space as solids that a carried object must keep out of."""

from __future__ import annotations

from mmplan.carry import Region
from mmplan.collision.scenery import Scenery
from mmplan.collision.separation import signed_distance, transform
from mmplan.collision.solids import Solid, geometries
from mmplan.shapes import Array, Box


def solid_of_region(region: Region) -> Solid:
    """The box of a region, placed in the world."""
    (box,) = geometries(Box(region.size))
    return Solid(region.name, box, region.T_world_region)


def depth_in_region(
    scenery: Scenery, name: str, T_world_object: Array, region: Region
) -> float:
    """How deep (m) an object is in a region where it stands; negative if it is not."""
    box = solid_of_region(region)
    T_world_box = transform(box.placement)
    return -min(
        signed_distance(
            solid.geometry,
            transform(T_world_object @ solid.placement),
            box.geometry,
            T_world_box,
        )
        for solid in scenery.objects[name]
    )
