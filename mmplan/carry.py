"""How an object must be carried: upright, slowly, and out of some regions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class Region:
    """A box in the world."""

    name: str
    size: tuple[float, float, float]  # m, full lengths along its own axes
    T_world_region: Array  # (4, 4)

    def depths(self, points: Array) -> Array:
        """How deep points (n, 3) of the world are inside, (n,), m, negative outside.

        It changes by no more than a point moves.
        """
        R, p = self.T_world_region[:3, :3], self.T_world_region[:3, 3]
        inside = np.array(self.size) / 2.0 - np.abs((points - p) @ R)
        depths: Array = inside.min(axis=1)
        return depths


@dataclass(frozen=True, eq=False)
class Upright:
    """An axis of the object that must stay near the vertical.

    But not while the origin of the object's frame is inside one of the regions
    `exempt`.
    """

    angle: float  # rad, the largest tilt
    axis: Array  # (3,), of unit length, in the object's frame
    exempt: tuple[Region, ...] = ()

    def tilts(self, R_world_object: Array) -> Array:
        """The angles (n,) between the axis and the vertical at rotations (n, 3, 3)."""
        x, y, z = (R_world_object @ self.axis).T
        tilts: Array = np.arctan2(np.hypot(x, y), z)
        return tilts

    def depths(self, points: Array) -> Array:
        """How deep points (n, 3) are in an exempt region, (n,); -inf if none is."""
        deepest = np.full(len(points), -np.inf)
        for region in self.exempt:
            deepest = np.maximum(deepest, region.depths(points))
        return deepest


@dataclass(frozen=True, eq=False)
class Carry:
    """What holds while an object is in the hand; nothing by default.

    `max_speed` (m/s) is that of the tool frame's origin, and no point of the object
    may be in a region that is `forbidden`.
    """

    upright: Upright | None = None
    max_speed: float | None = None
    forbidden: tuple[Region, ...] = ()
