"""What a picture is made of: coloured surfaces, each carried by something."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from mmplan.shapes import Array
from mmplan.visualization.surface import Surface, joined, tube

# What carries the parts that never move.
WORLD = "world"
# Layers that a viewer can hide.
SCENE, ROBOT, TOOL, PATHS, GHOSTS, GRASPS, REACH = (
    "scene",
    "robot",
    "tool frame",
    "paths",
    "ghosts",
    "grasps",
    "reach",
)


class Colour(NamedTuple):
    """Red, green, blue and opacity, each from 0 to 1."""

    red: float
    green: float
    blue: float
    opacity: float = 1.0


@dataclass(frozen=True, eq=False)
class Part:
    """One surface of one colour, in the frame of what carries it."""

    name: str
    surface: Surface
    colour: Colour
    carrier: str = WORLD
    layer: str = SCENE

    def ghost(self, colour: Colour, carrier: str, name: str) -> Part:
        """The part once more in another colour, carried by something else."""
        return replace(self, name=name, colour=colour, carrier=carrier, layer=GHOSTS)


def joint_carrier(name: str) -> str:
    """What carries the bodies of a joint of the robot."""
    return f"joint {name}"


def object_carrier(name: str) -> str:
    """What carries the bodies of an object."""
    return f"object {name}"


def merged(parts: Iterable[Part], name: str) -> list[Part]:
    """The parts with those alike in all but the surface made one, called `name`."""
    groups: dict[tuple[Colour, str, str], list[Surface]] = {}
    for part in parts:
        key = (part.colour, part.carrier, part.layer)
        groups.setdefault(key, []).append(part.surface)
    return [
        Part(f"{name}/{number}", joined(surfaces), *key)
        for number, (key, surfaces) in enumerate(groups.items())
    ]


def axes(name: str, T: Array, length: float, carrier: str, layer: str) -> list[Part]:
    """The axes of a frame at T (4, 4): x red, y green, z blue."""
    radius = length / 25.0
    return [
        Part(
            f"{name}/{'xyz'[axis]}",
            tube(np.stack([T[:3, 3], T[:3, 3] + length * T[:3, axis]]), radius),
            _AXES[axis],
            carrier,
            layer,
        )
        for axis in range(3)
    ]


_AXES = (Colour(0.86, 0.2, 0.18), Colour(0.2, 0.65, 0.25), Colour(0.15, 0.35, 0.9))
