"""Shapes of obstacles and objects: plain values, in their own frame, in metres."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Array: TypeAlias = npt.NDArray[np.float64]


def read_only(array: npt.ArrayLike) -> Array:
    """A read-only copy of `array` as float64."""
    copy = np.array(array, dtype=np.float64)
    copy.setflags(write=False)
    return copy


@dataclass(frozen=True)
class Box:
    """A box of full edge lengths `size` = (x, y, z), centred at the origin."""

    size: tuple[float, float, float]


@dataclass(frozen=True)
class Sphere:
    """A sphere centred at the origin."""

    radius: float


@dataclass(frozen=True)
class Cylinder:
    """A cylinder along z, centred at the origin."""

    radius: float
    length: float


@dataclass(frozen=True)
class Capsule:
    """A cylinder of `length` along z with half-spheres beyond both of its ends."""

    radius: float
    length: float


@dataclass(frozen=True)
class Cone:
    """A cone along z, its base at -length / 2 and its tip at +length / 2."""

    radius: float
    length: float


@dataclass(frozen=True)
class Mesh:
    """A closed triangle mesh in a file, scaled by `scale` along its own axes."""

    path: Path
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Revolve:
    """A solid of revolution about z.

    `profile` (n, 2) is the outline (r, z) of the material in the half-plane r >= 0,
    closed from its last point to its first.
    """

    profile: Array


@dataclass(frozen=True)
class Fixture:
    """An articulated fixture: a URDF file, held at a configuration.

    `configuration` maps joint names to values (rad or m); other joints are at 0.
    """

    path: Path
    configuration: tuple[tuple[str, float], ...] = ()


Shape: TypeAlias = Box | Sphere | Cylinder | Capsule | Cone | Mesh | Revolve
