"""Bookcases: from one compartment into another."""

from __future__ import annotations

import numpy as np

from mmplan.generation.clutter import clutter
from mmplan.generation.difficulty import Difficulty
from mmplan.generation.draft import Draft, Entry, Rect, metres, standing_box
from mmplan.generation.surfaces import Occupied, Surface
from mmplan.generation.things import Rest, draw_thing

_FLOOR = Rect((-2.0, 1.3), (-2.2, 2.2))
_START = (-1.2, 0.0)
_FRONT = 0.8  # x of the front edges of the boards, m
_BOARD = 0.02  # thickness of all boards, m
_LOWEST, _HIGHEST = 0.45, 1.35  # that boards in use may be, m
_BAYS = 2


def shelf(rng: np.random.Generator, difficulty: Difficulty) -> Draft | None:
    """A thing moved between two compartments of a bookcase with two bays."""
    thing = draw_thing(rng, "wineglass", "tumbler", "mug", "bottle", "can", "plate")
    stance = thing.stances[Rest.UPRIGHT]
    opening = max(stance.top + difficulty.between(0.16, 0.07), 0.2)
    case = _Bookcase(
        depth=round(float(rng.uniform(0.3, 0.36)), 3),
        bay=difficulty.between(0.8, 0.42),
        opening=round(float(opening), 3),
    )
    places = [Occupied(s) for s in case.compartments()]
    first, second = rng.choice(len(places), 2, replace=False)
    gap = difficulty.between(0.08, 0.03)
    at = places[first].place(rng, stance, gap, flat=thing.is_flat)
    to = places[second].place(rng, stance, gap, flat=thing.is_flat)
    if at is None or to is None:
        return None
    used = [places[first], places[second]]
    about = clutter(rng, used * 2 + places, difficulty.count(2, 16), gap)
    return Draft(
        description=f"A {thing.name} from one compartment of a bookcase into another",
        floor=_FLOOR,
        start=_START,
        obstacles={**case.boards(), **about},
        object=thing.name,
        item=thing.item,
        at=at,
        to=to,
        clutter=len(about),
    )


class _Bookcase:
    """Boards between a back, two sides and a divider; metres."""

    def __init__(self, depth: float, bay: float, opening: float) -> None:
        self._x = (_FRONT, metres(_FRONT + depth))
        self._bay = bay
        self._opening = opening

    def _heights(self) -> list[float]:
        """The upper faces of the boards, the uppermost of which is the lid."""
        pitch = self._opening + _BOARD
        count = int((_HIGHEST - _LOWEST) / pitch) + 1
        return [metres(_LOWEST + pitch * i) for i in range(count + 1)]

    def _bay_sides(self) -> list[tuple[float, float]]:
        """The free width of each bay, lowest to highest y."""
        lowest = -(_BAYS * self._bay + (_BAYS - 1) * _BOARD) / 2
        lows = [lowest + i * (self._bay + _BOARD) for i in range(_BAYS)]
        return [(metres(low), metres(low + self._bay)) for low in lows]

    def compartments(self) -> list[Surface]:
        """The surface of each compartment."""
        return [
            Surface(f"board {level}", Rect(self._x, y), z, self._opening)
            for level, z in enumerate(self._heights()[:-1])
            for y in self._bay_sides()
        ]

    def boards(self) -> dict[str, Entry]:
        """All of the bookcase."""
        top = self._heights()[-1]
        bays = self._bay_sides()
        behind = self._x[1]
        uprights = [bays[0][0] - _BOARD, *(high for _, high in bays)]
        entries = {
            f"upright_{i}": standing_box(Rect(self._x, (y, y + _BOARD)), 0.0, top)
            for i, y in enumerate(uprights, start=1)
        }
        whole = (uprights[0], uprights[-1] + _BOARD)
        entries["back"] = standing_box(Rect((behind, behind + _BOARD), whole), 0.0, top)
        for level, z in enumerate(self._heights(), start=1):
            for bay, y in enumerate(bays, start=1):
                entries[f"board_{level}_{bay}"] = standing_box(
                    Rect(self._x, y), z - _BOARD, z
                )
        return entries
