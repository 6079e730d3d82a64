"""Tables with clutter on top and stools around them."""

from __future__ import annotations

import numpy as np

from mmplan.generation.clutter import clutter
from mmplan.generation.difficulty import Difficulty
from mmplan.generation.draft import (
    Draft,
    Entry,
    Rect,
    metres,
    standing_box,
    standing_cylinder,
)
from mmplan.generation.surfaces import Disc, Occupied, Surface, is_free
from mmplan.generation.things import Rest, Thing, draw_thing

_FLOOR = Rect((-2.0, 3.4), (-2.6, 2.6))
_START = (-1.2, 0.0)
_THICK, _LEG = 0.03, 0.05
_STOOL_RADIUS, _STOOL_HEIGHT = 0.17, 0.46
_STOOL_GAP = 0.02  # between a stool and the table's edge, m


def table(rng: np.random.Generator, difficulty: Difficulty) -> Draft | None:
    """A thing moved from one place on a table to another, at times upside down."""
    thing = draw_thing(rng, "wineglass", "tumbler", "mug", "bottle", "can", "plate")
    top = Occupied(_top(rng))
    gap = difficulty.between(0.1, 0.025)
    end = _rest_at_goal(rng, thing)
    at = top.place(rng, thing.stances[Rest.UPRIGHT], gap, flat=thing.is_flat)
    to = top.place(rng, thing.stances[end], gap, flat=thing.is_flat)
    if at is None or to is None:
        return None
    about = clutter(rng, [top], difficulty.count(2, 18), gap)
    stools = _stools(rng, top.surface.area, difficulty.count(0, 6))
    return Draft(
        description=f"A {thing.name} on a table, to be put down {end.value} elsewhere",
        floor=_FLOOR,
        start=_START,
        obstacles={**_legs_and_top(top.surface), **stools, **about},
        object=thing.name,
        item=thing.item,
        at=at,
        to=to,
        clutter=len(about) + len(stools),
    )


def _top(rng: np.random.Generator) -> Surface:
    deep, wide = rng.uniform(0.65, 0.9), rng.uniform(1.1, 1.6)
    x, y = 0.7, metres(round(wide / 2, 3))
    area = Rect((x, metres(round(x + deep, 3))), (-y, y))
    return Surface("table", area, z=round(float(rng.uniform(0.68, 0.8)), 3))


def _rest_at_goal(rng: np.random.Generator, thing: Thing) -> Rest:
    turn = rng.random() < 0.4
    return Rest.INVERTED if turn and Rest.INVERTED in thing.stances else Rest.UPRIGHT


def _legs_and_top(surface: Surface) -> dict[str, Entry]:
    under = surface.z - _THICK
    (x0, x1), (y0, y1) = surface.area.x, surface.area.y
    entries = {"table": standing_box(surface.area, under, surface.z)}
    for name, x, y in (
        ("leg_1", x0, y0),
        ("leg_2", x0, y1 - _LEG),
        ("leg_3", x1 - _LEG, y0),
        ("leg_4", x1 - _LEG, y1 - _LEG),
    ):
        entries[name] = standing_box(Rect((x, x + _LEG), (y, y + _LEG)), 0.0, under)
    return entries


def _stools(rng: np.random.Generator, area: Rect, count: int) -> dict[str, Entry]:
    """At most `count` stools close to the sides of a table."""
    discs: list[Disc] = []
    for _ in range(count):
        disc = _beside(rng, area)
        if is_free(disc, discs, 0.05):
            discs.append(disc)
    return {
        f"stool_{number}": standing_cylinder(
            disc.x, disc.y, _STOOL_RADIUS, 0.0, _STOOL_HEIGHT
        )
        for number, disc in enumerate(discs, start=1)
    }


def _beside(rng: np.random.Generator, area: Rect) -> Disc:
    """A place for a stool at a random side of a table."""
    off = _STOOL_RADIUS + _STOOL_GAP + float(rng.uniform(0.0, 0.15))
    along = float(rng.uniform(0.1, 0.9))
    (x0, x1), (y0, y1) = area.x, area.y
    x, y = x0 + along * (x1 - x0), y0 + along * (y1 - y0)
    side = int(rng.integers(4))
    x, y = ((x0 - off, y), (x1 + off, y), (x, y0 - off), (x, y1 + off))[side]
    return Disc(round(x, 3), round(y, 3), _STOOL_RADIUS)
