"""What is read of another program's scene, before it becomes one of mmplan."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from mmplan.exceptions import InputError
from mmplan.shapes import Array

# What is called so is what the base drives on.
_GROUNDS = ("floor", "ground", "ground_plane")


class Triangles(NamedTuple):
    """A mesh that is to be written into a file of its own."""

    vertices: Array  # (n, 3), m
    triangles: Sequence[Sequence[int]]  # indices into vertices


@dataclass(frozen=True, eq=False)
class ForeignThing:
    """One shape at a pose: `shape` is its entry in a scene file, or a mesh."""

    name: str
    shape: Mapping[str, Any] | Triangles
    T_world_thing: Array  # (4, 4)
    ground: bool = False


@dataclass
class ForeignScene:
    """Things, joint positions at the start, and what mmplan has no place for.

    Readers add to it; every `unsupported` is a line for people.
    """

    name: str
    things: list[ForeignThing] = field(default_factory=list)
    start: dict[str, float] = field(default_factory=dict)
    unsupported: list[str] = field(default_factory=list)

    def add(self, name: str, parts: Sequence[tuple[Any, Array]]) -> None:
        """Add a thing; where it has several shapes they become several things."""
        for number, (shape, T) in enumerate(parts, start=1):
            part = name if len(parts) == 1 else f"{name}_{number}"
            ground = name.lower() in _GROUNDS
            self.things.append(ForeignThing(part, shape, T, ground))


def primitive(kind: str, sizes: Sequence[float], where: str) -> dict[str, Any]:
    """The entry of a primitive, its sizes as shape_msgs/SolidPrimitive orders them.

    Raises:
        InputError: It is none that is known, or has other sizes.
    """
    known = {"box": 3, "sphere": 1, "cylinder": 2, "cone": 2}
    if kind not in known:
        raise InputError(f"{where}: unknown shape '{kind}'; known: {', '.join(known)}")
    if len(sizes) != known[kind] or min(sizes, default=0.0) <= 0.0:
        message = f"a {kind} has {known[kind]} sizes above 0, this one {list(sizes)}"
        raise InputError(f"{where}: {message}")
    if kind == "box":
        return {"box": [float(s) for s in sizes]}
    if kind == "sphere":
        return {"sphere": {"radius": float(sizes[0])}}
    length, radius = float(sizes[0]), float(sizes[1])
    return {kind: {"radius": radius, "length": length}}


def pose_of(xyz: Sequence[float], quat: Sequence[float], where: str) -> Array:
    """A pose (4, 4) of a position and a quaternion [x, y, z, w], of any length.

    Raises:
        InputError: A number is missing or not finite, or the quaternion is 0.
    """
    values = np.array([*xyz, *quat], dtype=np.float64)
    norm = float(np.linalg.norm(values[3:]))
    if len(values) != 7 or not np.isfinite(values).all() or norm == 0.0:
        raise InputError(f"{where}: no pose: position {list(xyz)}, turn {list(quat)}")
    x, y, z, w = values[3:] / norm
    T = np.eye(4)
    T[:3, :3] = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    T[:3, 3] = values[:3]
    return T


def only_file(files: Sequence[Path], what: str) -> Path:
    """The one file of a format that takes one.

    Raises:
        InputError: There are more.
    """
    if len(files) != 1:
        raise InputError(f"expected one file, {what}, got {len(files)}")
    return files[0]
