"""Open bins: from one into another, among what else lies in them."""

from __future__ import annotations

import numpy as np

from mmplan.generation.clutter import clutter
from mmplan.generation.difficulty import Difficulty
from mmplan.generation.draft import Draft, Entry, Rect, metres, standing_box
from mmplan.generation.surfaces import Occupied, Surface
from mmplan.generation.things import Rest, Thing, draw_thing

_FLOOR = Rect((-2.0, 3.0), (-2.4, 2.4))
_START = (-1.2, 0.0)
_WALL = 0.012  # thickness of walls and bottoms, m
_MIDDLE = 0.95  # x of the middle of both bins, m


def bin_to_bin(rng: np.random.Generator, difficulty: Difficulty) -> Draft | None:
    """A thing moved from one bin on a pedestal into another.

    Cans and tubes lie and are lifted out from above; bottles and wineglasses stand
    and rise above the walls.
    """
    thing = draw_thing(rng, "can", "tube", "can", "tube", "bottle", "wineglass")
    stance = thing.stances[_rest(thing)]
    deep = difficulty.between(0.08, 0.17)
    bins = [_Bin.draw(rng, side, difficulty, deep) for side in (-1, 1)]
    rng.shuffle(bins)
    places = [Occupied(b.surface) for b in bins]
    gap = difficulty.between(0.06, 0.02)
    at, to = (place.place(rng, stance, gap) for place in places)
    if at is None or to is None:
        return None
    count = difficulty.count(1, 12)
    about = clutter(rng, places, count, gap, tallest=deep, widest=0.07)
    walls = {name: box for b in bins for name, box in b.walls().items()}
    return Draft(
        description=f"A {thing.name}, {_rest(thing).value}, from one bin into another",
        floor=_FLOOR,
        start=_START,
        obstacles={**dict(sorted(walls.items())), **about},
        object=thing.name,
        item=thing.item,
        at=at,
        to=to,
        clutter=len(about),
    )


def _rest(thing: Thing) -> Rest:
    return Rest.LYING if Rest.LYING in thing.stances else Rest.UPRIGHT


class _Bin:
    """Four walls and a bottom on a pedestal; metres."""

    def __init__(self, name: str, inside: Rect, floor: float, deep: float) -> None:
        self._name = name
        self._deep = deep
        self.surface = Surface(name, inside, floor)

    @classmethod
    def draw(
        cls, rng: np.random.Generator, side: int, difficulty: Difficulty, deep: float
    ) -> _Bin:
        """A bin on the right (-1) or left (+1)."""
        size = difficulty.between(0.46, 0.27) + float(rng.uniform(0.0, 0.1))
        half = round(size / 2, 3)
        y = side * (half + round(float(rng.uniform(0.05, 0.35)), 3))
        inside = Rect((_MIDDLE - half, _MIDDLE + half), (y - half, y + half))
        floor = round(float(rng.uniform(0.45, 0.75)), 3)
        return cls("left" if side > 0 else "right", inside, floor, deep)

    def walls(self) -> dict[str, Entry]:
        """The bin and its pedestal."""
        outside = self.surface.area.inset(-_WALL)
        (x0, x1), (y0, y1) = outside.x, outside.y
        low = metres(self.surface.z - _WALL)
        parts = {
            "front": Rect((x0, x0 + _WALL), (y0, y1)),
            "rear": Rect((x1 - _WALL, x1), (y0, y1)),
            "right": Rect((x0, x1), (y0, y0 + _WALL)),
            "left": Rect((x0, x1), (y1 - _WALL, y1)),
        }
        entries = {
            f"{self._name}_bin_{name}": standing_box(
                area, low, self.surface.z + self._deep
            )
            for name, area in parts.items()
        }
        entries[f"{self._name}_bin_bottom"] = standing_box(outside, low, self.surface.z)
        entries[f"{self._name}_pedestal"] = standing_box(outside.inset(0.05), 0.0, low)
        return entries
