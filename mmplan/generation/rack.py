"""A dish rack: a tray with rows of tines."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.generation.draft import Entry, Rect, metres, pose, standing_box
from mmplan.generation.things import Rest, Thing

_TRAY = 0.015  # height of the tray, m
_ROWS = 5
_TINE_RADIUS = 0.003
# The fingers must reach a glass that stands on its rim above the tines.
_TINE_LENGTH, _TINE_LENGTH_FOR_GLASSES = 0.08, 0.045
_STEP = 0.07  # between the tines of a row, m
DEEP, WIDE = 0.32, 0.46  # m, along x and y


@dataclass(frozen=True)
class Rack:
    """A dish rack for one kind of thing, at the place (x, y) of its middle.

    `pitch` is the distance between its rows of tines, which lie along x, and `tine`
    their length (m).
    """

    x: float
    y: float
    z: float  # of what it stands on, m
    pitch: float
    tine: float

    @classmethod
    def for_thing(
        cls, thing: Thing, spare: float, x: float, y: float, z: float
    ) -> Rack:
        """A rack whose rows leave a thing that much room in all (m)."""
        profile = thing.item["revolve"]
        deep = max(p[1] for p in profile) if thing.is_flat else 2 * _widest(thing)
        pitch = metres(round(deep + 2 * _TINE_RADIUS + spare, 3))
        tine = _TINE_LENGTH if thing.is_flat else _TINE_LENGTH_FOR_GLASSES
        return cls(x, y, z, min(pitch, round(WIDE / (_ROWS - 1) - 0.002, 3)), tine)

    def place(self, rng: np.random.Generator, thing: Thing) -> Entry:
        """The pose of a thing between two rows: plates on edge, glasses upside down."""
        row = int(rng.integers(_ROWS - 1))
        y = self.y + (row - (_ROWS - 2) / 2) * self.pitch
        if thing.is_flat:
            stance = thing.stances[Rest.ON_EDGE]
            thick = max(p[1] for p in thing.item["revolve"])
            return pose(self.x, y + thick / 2, self._floor + stance.height, stance.roll)
        stance = thing.stances[Rest.INVERTED]
        free = DEEP / 2 - stance.radius
        x = self.x + round(float(rng.uniform(-free, free)), 3)
        return pose(x, y, self._floor + stance.height, stance.roll)

    @property
    def _floor(self) -> float:
        return metres(self.z + _TRAY)

    @property
    def area(self) -> Rect:
        """What it covers."""
        return Rect(
            (self.x - DEEP / 2, self.x + DEEP / 2),
            (self.y - WIDE / 2, self.y + WIDE / 2),
        )

    def parts(self) -> dict[str, Entry]:
        """The tray and its tines."""
        entries = {"rack_tray": standing_box(self.area, self.z, self._floor)}
        columns = int(DEEP / _STEP)
        for row in range(_ROWS):
            y = self.y + (row - (_ROWS - 1) / 2) * self.pitch
            for column in range(columns):
                x = self.x + (column - (columns - 1) / 2) * _STEP
                middle = self._floor + self.tine / 2
                entries[f"rack_tine_{row + 1}_{column + 1}"] = {
                    "capsule": {"radius": _TINE_RADIUS, "length": self.tine},
                    "at": pose(x, y, middle),
                }
        return entries


def _widest(thing: Thing) -> float:
    return max(stance.radius for stance in thing.stances.values())
