"""Kitchens: counter, wall cabinet, island and dish rack in a room."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.generation.clutter import clutter
from mmplan.generation.difficulty import Difficulty
from mmplan.generation.draft import Draft, Entry, Rect, metres, standing_box
from mmplan.generation.rack import DEEP, WIDE, Rack
from mmplan.generation.surfaces import Disc, Occupied, Surface
from mmplan.generation.things import Rest, Thing, draw_thing

_FLOOR = Rect((-2.4, 2.0), (-1.8, 2.2))
_START = (0.2, 1.3)
_WALL = 0.1
_FRONT, _BACK = 1.38, 2.0  # x of the counter's edge and of the wall, m
_COUNTER = Rect((_FRONT, _BACK), (-1.8, 1.4))
_COUNTER_TOP, _COUNTER_THICK = 0.9, 0.04
_CABINET_DEEP, _CABINET_BOTTOM, _BOARD = 0.32, 1.33, 0.02


def kitchen(rng: np.random.Generator, difficulty: Difficulty) -> Draft | None:
    """A thing moved between two of counter, wall cabinet, island and dish rack.

    Only what belongs there goes into the rack: plates on edge, glasses upside down.
    """
    thing = draw_thing(rng, "wineglass", "tumbler", "mug", "plate", "bottle")
    names = ["counter", "cabinet", "island"]
    names += ["rack"] if _goes_into_rack(thing) else []
    first, second = rng.choice(names, 2, replace=False)
    with_rack = "rack" in (first, second)
    room = _Room.draw(rng, difficulty, thing, with_rack=with_rack)
    gap = difficulty.between(0.09, 0.03)
    at = room.place(rng, first, thing, gap)
    to = room.place(rng, second, thing, gap)
    if at is None or to is None:
        return None
    about = clutter(rng, list(room.places.values()), difficulty.count(3, 22), gap)
    return Draft(
        description=f"A {thing.name} from the {first} to the {second} of a kitchen",
        floor=_FLOOR,
        start=_START,
        obstacles={**room.obstacles(with_rack=with_rack), **about},
        object=thing.name,
        item=thing.item,
        at=at,
        to=to,
        clutter=len(about),
    )


def _goes_into_rack(thing: Thing) -> bool:
    return thing.is_flat or Rest.INVERTED in thing.stances


@dataclass(frozen=True)
class _Room:
    """The furniture of one kitchen."""

    cabinet: Surface
    island: Surface
    rack: Rack
    places: dict[str, Occupied]

    @classmethod
    def draw(
        cls,
        rng: np.random.Generator,
        difficulty: Difficulty,
        thing: Thing,
        *,
        with_rack: bool,
    ) -> _Room:
        """Furniture where it may stand; the rack is fit for the thing."""
        cabinet, island = _cabinet(rng, difficulty, thing), _island(rng, difficulty)
        x = _FRONT + 0.03 + DEEP / 2
        y = round(float(rng.uniform(-1.7 + WIDE / 2, 1.3 - WIDE / 2)), 3)
        rack = Rack.for_thing(
            thing, difficulty.between(0.05, 0.015), metres(x), y, _COUNTER_TOP
        )
        counter = Occupied(
            Surface("counter", _COUNTER, _COUNTER_TOP, _CABINET_BOTTOM - _COUNTER_TOP)
        )
        for part in (-1, 1) if with_rack else ():  # what the rack covers, roughly
            disc = Disc(rack.x, rack.y + part * WIDE / 4, DEEP / 2 + 0.03)
            counter.discs.append(disc)
        places = {
            "counter": counter,
            "cabinet": Occupied(cabinet),
            "island": Occupied(island),
        }
        return cls(cabinet, island, rack, places)

    def place(
        self, rng: np.random.Generator, name: str, thing: Thing, gap: float
    ) -> Entry | None:
        """The pose of the thing at a free spot of one of the places."""
        if name == "rack":
            return self.rack.place(rng, thing)
        upright = thing.stances[Rest.UPRIGHT]
        return self.places[name].place(rng, upright, gap, flat=thing.is_flat)

    def obstacles(self, *, with_rack: bool) -> dict[str, Entry]:
        """Walls and furniture."""
        return {
            **_walls(),
            **_counter(),
            **_cabinet_boards(self.cabinet),
            **_island_parts(self.island),
            **(self.rack.parts() if with_rack else {}),
        }


def _cabinet(rng: np.random.Generator, difficulty: Difficulty, thing: Thing) -> Surface:
    """The shelf of the wall cabinet, tall enough for the thing."""
    wide = difficulty.between(1.1, 0.6)
    low = round(float(rng.uniform(-1.7, 1.3 - wide)), 3)
    area = Rect((metres(_BACK - _CABINET_DEEP), _BACK), (low, metres(low + wide)))
    opening = thing.stances[Rest.UPRIGHT].top + difficulty.between(0.16, 0.07)
    headroom = metres(round(max(opening, 0.25), 3))
    return Surface("cabinet", area, metres(_CABINET_BOTTOM + _BOARD), headroom)


def _island(rng: np.random.Generator, difficulty: Difficulty) -> Surface:
    """The island's top, beyond an aisle, reached from there."""
    edge = metres(_FRONT - difficulty.between(1.5, 1.0))
    low = round(float(rng.uniform(-1.5, -1.1)), 3)
    area = Rect((metres(edge - 0.7), edge), (low, round(low + 1.3, 3)))
    return Surface("island", area, round(float(rng.uniform(0.74, 0.9)), 3), front=1)


def _walls() -> dict[str, Entry]:
    (x0, x1), (y0, y1) = _FLOOR.x, _FLOOR.y
    return {
        "back_wall": standing_box(Rect((x1, x1 + _WALL), (y0, y1)), 0.0, 2.5),
        "side_wall": standing_box(Rect((x0, x1), (y0 - _WALL, y0)), 0.0, 2.5),
    }


def _counter() -> dict[str, Entry]:
    body = Rect((_FRONT + 0.04, _BACK), _COUNTER.y)
    under = _COUNTER_TOP - _COUNTER_THICK
    return {
        "fridge": standing_box(Rect((_FRONT, _BACK), (1.4, 2.0)), 0.0, 1.8),
        "counter": standing_box(_COUNTER, under, _COUNTER_TOP),
        "counter_body": standing_box(body, 0.0, under),
    }


def _cabinet_boards(shelf: Surface) -> dict[str, Entry]:
    x, (y0, y1) = shelf.area.x, shelf.area.y
    lid = shelf.z + shelf.headroom
    bottom, top = shelf.z - _BOARD, lid + _BOARD
    return {
        "cabinet_bottom": standing_box(shelf.area, bottom, shelf.z),
        "cabinet_lid": standing_box(shelf.area, lid, top),
        "cabinet_right": standing_box(Rect(x, (y0 - _BOARD, y0)), bottom, top),
        "cabinet_left": standing_box(Rect(x, (y1, y1 + _BOARD)), bottom, top),
    }


def _island_parts(top: Surface) -> dict[str, Entry]:
    under = metres(top.z - _COUNTER_THICK)
    return {
        "island": standing_box(top.area, under, top.z),
        "island_body": standing_box(top.area.inset(0.05), 0.0, under),
    }
