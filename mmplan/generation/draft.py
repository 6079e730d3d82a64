"""A scene that is being made, as the plain data of a scene file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

# What stands behind a name in a section of a scene file.
Entry: TypeAlias = dict[str, Any]

ROBOT = "puma_mobile"
BASE_RADIUS = 0.28  # of that robot, m
_MARGIN = 0.02  # between the base and the edge of the floor, m


@dataclass(frozen=True)
class Rect:
    """A rectangle along the world's axes, m."""

    x: tuple[float, float]
    y: tuple[float, float]

    @property
    def centre(self) -> tuple[float, float]:
        """Its middle."""
        return (sum(self.x) / 2, sum(self.y) / 2)

    def inset(self, margin: float) -> Rect:
        """The rectangle that lies inside by `margin` (m) on all sides."""
        (x0, x1), (y0, y1) = self.x, self.y
        return Rect((x0 + margin, x1 - margin), (y0 + margin, y1 - margin))


@dataclass(frozen=True)
class Draft:
    """The parts of a scene in which families differ.

    `item` is the entry of the object without its pose. Poses are entries of scene
    files, too: `{xyz: ..., rpy: ...}`. `clutter` counts the obstacles that stand about.
    """

    description: str
    floor: Rect
    start: tuple[float, float]  # of the base, m
    obstacles: Mapping[str, Entry]
    object: str
    item: Entry
    at: Entry
    to: Entry
    clutter: int

    def data(self, name: str) -> dict[str, Any]:
        """The scene file of that name."""
        bounds = self.floor.inset(BASE_RADIUS + _MARGIN)
        start = [metres(v) for v in self.start]
        return {
            "mmplan": 1,
            "name": name,
            "description": self.description,
            "robot": {
                "model": ROBOT,
                "start": {"base": start, "arm": "tucked", "hand": "open"},
                "bounds": {
                    "x": [metres(v) for v in bounds.x],
                    "y": [metres(v) for v in bounds.y],
                },
            },
            "obstacles": {"floor": _floor(self.floor), **self.obstacles},
            "objects": {self.object: {**self.item, "at": self.at}},
            "tasks": [{"move": self.object, "to": self.to}],
        }


def metres(value: float) -> float:
    """A length as it is written: to the micrometre, and no negative zero."""
    return round(float(value), 6) + 0.0


def pose(x: float, y: float, z: float, roll: float = 0.0, yaw: float = 0.0) -> Entry:
    """A pose in the world: turned by `roll` about x, then by `yaw` about z, rad."""
    entry: Entry = {"xyz": [metres(v) for v in (x, y, z)]}
    if roll or yaw:
        entry["rpy"] = [roll, 0.0, yaw]
    return entry


def standing_box(area: Rect, bottom: float, top: float) -> Entry:
    """A box over an area, from one height to another."""
    size = [area.x[1] - area.x[0], area.y[1] - area.y[0], top - bottom]
    at = pose(*area.centre, (bottom + top) / 2)
    return {"box": [metres(v) for v in size], "at": at}


def standing_cylinder(
    x: float, y: float, radius: float, bottom: float, top: float
) -> Entry:
    """An upright cylinder from one height to another."""
    shape = {"radius": metres(radius), "length": metres(top - bottom)}
    return {"cylinder": shape, "at": pose(x, y, (bottom + top) / 2)}


def _floor(area: Rect) -> Entry:
    return {**standing_box(area, -0.1, 0.0), "ground": True}
