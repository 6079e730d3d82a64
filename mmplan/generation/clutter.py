"""Things that stand about and are not moved."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mmplan.generation.draft import Entry, Rect, metres, pose, standing_cylinder
from mmplan.generation.surfaces import Disc, Occupied

_NEAR = 0.16  # how far from its neighbour clutter is put on purpose, m
_OVERHEAD = 0.03  # between clutter and what is above it, m


def clutter(
    rng: np.random.Generator,
    places: Sequence[Occupied],
    count: int,
    gap: float,
    tallest: float = 0.26,
    widest: float = 0.11,
) -> dict[str, Entry]:
    """At most `count` obstacles on surfaces that have room, by name.

    They keep `gap` (m) from all that stands there. Every other one is put close to
    something that does.
    """
    found: dict[str, Entry] = {}
    for number in range(count):
        place = places[int(rng.integers(len(places)))]
        height = _height(rng, place, tallest)
        sides = tuple(round(float(v), 3) for v in rng.uniform(0.04, widest, 2))
        entry = _draw(rng, place, (*sides, height), gap, near=number % 2 == 0)
        if entry is not None:
            found[f"clutter_{len(found) + 1}"] = entry
    return found


def _height(rng: np.random.Generator, place: Occupied, tallest: float) -> float:
    most = min(tallest, place.surface.headroom - _OVERHEAD)
    return round(float(rng.uniform(min(0.05, most), most)), 3)


def _draw(
    rng: np.random.Generator,
    place: Occupied,
    size: tuple[float, ...],
    gap: float,
    *,
    near: bool,
) -> Entry | None:
    """A box of that size (x, y, z) or a cylinder as wide as x, at a free spot."""
    *sides, height = size
    yaw = math.radians(int(rng.integers(-90, 90)))
    is_round = bool(rng.random() < 0.5)
    radius = sides[0] / 2 if is_round else math.hypot(*sides) / 2
    area = place.surface.area
    if near and place.discs:
        other = place.discs[int(rng.integers(len(place.discs)))]
        area = _around(other, area, _NEAR + radius)
    disc = place.spot(rng, radius, gap, area)
    if disc is None:
        return None
    bottom = place.surface.z
    if is_round:
        return standing_cylinder(disc.x, disc.y, radius, bottom, bottom + height)
    at = pose(disc.x, disc.y, bottom + height / 2, yaw=round(yaw, 6))
    return {"box": [*(metres(s) for s in sides), height], "at": at}


def _around(disc: Disc, area: Rect, distance: float) -> Rect:
    """The part of an area around a disc."""
    reach = disc.radius + distance
    return Rect(
        (max(area.x[0], disc.x - reach), min(area.x[1], disc.x + reach)),
        (max(area.y[0], disc.y - reach), min(area.y[1], disc.y + reach)),
    )
