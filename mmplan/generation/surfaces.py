"""Surfaces that things stand on, and free spots on them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from mmplan.generation.draft import Entry, Rect, pose
from mmplan.generation.things import Stance

_DRAWS = 60
_YAWS = 360  # turns are whole degrees
# How far behind the front edge of its support the lip of a flat thing may be, m.
_LIP_BEHIND = 0.025


class Disc(NamedTuple):
    """Room that is taken on a surface."""

    x: float
    y: float
    radius: float


@dataclass(frozen=True)
class Surface:
    """A level area that is reached from its front.

    `front` is the side of lower x (-1) or higher x (+1). `headroom` is the free height
    above, m.
    """

    name: str
    area: Rect
    z: float
    headroom: float = math.inf
    front: int = -1


@dataclass
class Occupied:
    """The surface of one scene that fills up."""

    surface: Surface
    discs: list[Disc] = field(default_factory=list)

    def place(
        self,
        rng: np.random.Generator,
        stance: Stance,
        gap: float,
        *,
        flat: bool = False,
    ) -> Entry | None:
        """The pose of a thing at a free spot; None where there is none.

        `gap` (m) stays free all around. A thing that is `flat` comes to the front.
        """
        if stance.top > self.surface.headroom:
            return None
        spots = self._front(stance.radius) if flat else self.surface.area
        disc = self.spot(rng, stance.radius, gap, spots.inset(0.0 if flat else gap / 2))
        if disc is None:
            return None
        yaw = math.radians(int(rng.integers(-_YAWS // 2, _YAWS // 2)))
        return pose(
            disc.x, disc.y, self.surface.z + stance.height, stance.roll, round(yaw, 6)
        )

    def spot(
        self, rng: np.random.Generator, radius: float, gap: float, area: Rect
    ) -> Disc | None:
        """Take a free disc whose centre is drawn so that it lies within an area.

        An area may leave its discs no choice along an axis; along one where they do
        not fit there is no spot.
        """
        free = area.inset(radius)
        if free.x[0] > free.x[1] + 1e-9 or free.y[0] > free.y[1] + 1e-9:
            return None
        for _ in range(_DRAWS):
            x, y = (round(float(rng.uniform(*side)), 3) for side in (free.x, free.y))
            disc = Disc(x, y, radius)
            if is_free(disc, self.discs, gap):
                self.discs.append(disc)
                return disc
        return None

    def _front(self, radius: float) -> Rect:
        """The area of discs of that radius that come to the front edge."""
        low, high = self.surface.area.x
        deep = min(2 * radius + _LIP_BEHIND, high - low)
        x = (low, low + deep) if self.surface.front < 0 else (high - deep, high)
        return Rect(x, self.surface.area.y)


def is_free(disc: Disc, others: Iterable[Disc], gap: float) -> bool:
    """Whether a disc keeps its distance from all others."""
    return all(
        math.hypot(disc.x - o.x, disc.y - o.y) >= disc.radius + o.radius + gap
        for o in others
    )
