"""Finely tessellated closed surfaces, as detailed models have them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import numpy.typing as npt

from mmplan.collision.mesh_files import TriangleMesh
from mmplan.shapes import Array, Box, Capsule, Cylinder, Shape, Sphere

# Slices of a turn, before triangles are split.
_SLICES, _FINE_SLICES = 32, 240
# How long the pieces of an outline are at most that is to be fine, m.
_STEP = 0.002


def surface_of(shape: Shape | TriangleMesh) -> Array:
    """The triangles (t, 3, 3) of a primitive, counter-clockwise from outside."""
    match shape:
        case Box(size):
            return _box(np.array(size))
        case Cylinder(radius, length):
            half = length / 2
            return turned([(0, -half), (radius, -half), (radius, half), (0, half)])
        case Sphere(radius):
            return turned(_arc(radius, 0.0, -np.pi / 2, np.pi / 2))
        case Capsule(radius, length):
            low = _arc(radius, -length / 2, -np.pi / 2, 0.0)
            return turned([*low, *_arc(radius, length / 2, 0.0, np.pi / 2)])
    raise TypeError(f"no surface for {shape}")


def turned(profile: npt.ArrayLike, ripple: float | None = None) -> Array:
    """The triangles of an outline (n, 2) of (r, z) turned about z.

    It goes counter-clockwise about the material, from the axis to the axis or, where
    it stays off that, back to where it began. With a `ripple` the surface is fine from
    the beginning, and has ripples pressed into it, so many m deep at most.
    """
    outline = np.array(profile, dtype=np.float64)
    closed = bool(outline[0, 0] > 0.0)
    slices = _SLICES if ripple is None else _FINE_SLICES
    if ripple is not None:
        outline = _stepped(outline, closed)
    turn = 2 * np.pi * np.arange(slices) / slices
    waves = 1 + np.cos(24 * turn)[:, None] * np.cos(300 * outline[:, 1])
    r = outline[:, 0] - np.minimum(ripple or 0.0, 0.2 * outline[:, 0]) * waves / 2
    x, y = r * np.cos(turn)[:, None], r * np.sin(turn)[:, None]
    points = np.stack([x, y, np.broadcast_to(outline[:, 1], x.shape)], axis=-1)
    east = np.roll(points, -1, axis=0)
    if closed:
        above, east_above = np.roll(points, -1, axis=1), np.roll(east, -1, axis=1)
    else:
        points, above = points[:, :-1], points[:, 1:]
        east, east_above = east[:, :-1], east[:, 1:]
    one = np.stack([points, east, east_above], axis=2).reshape(-1, 3, 3)
    two = np.stack([points, east_above, above], axis=2).reshape(-1, 3, 3)
    triangles = np.concatenate([one, two])
    a, b, c = (triangles[:, i] for i in range(3))
    proper = (a != b).any(axis=1) & (b != c).any(axis=1) & (c != a).any(axis=1)
    found: Array = triangles[proper]
    return found


def refined(surfaces: list[Array], count: int) -> list[Array]:
    """The surfaces with about so many triangles together, all about as large.

    Triangles are split into four, those of the surface with the largest ones first.
    """
    surfaces = list(surfaces)
    areas = [float(np.mean(_areas(s))) for s in surfaces]
    total = sum(map(len, surfaces))
    while total < count:
        i = int(np.argmax(areas))
        total += 3 * len(surfaces[i])
        surfaces[i], areas[i] = _split(surfaces[i]), areas[i] / 4
    return surfaces


def write_stl(path: Path, triangles: Array) -> None:
    """Write a binary STL file."""
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    records = np.zeros(len(triangles), kind)
    records["corners"] = triangles
    head = bytes(80) + len(triangles).to_bytes(4, "little")
    path.write_bytes(head + records.tobytes())


def _areas(triangles: Array) -> Array:
    a, b, c = (triangles[:, i] for i in range(3))
    doubled: Array = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return doubled / 2


def _split(triangles: Array) -> Array:
    a, b, c = (triangles[:, i] for i in range(3))
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(part, axis=1) for part in parts])


def _box(size: Array) -> Array:
    corners: Array = size * (np.indices((2, 2, 2)).reshape(3, -1).T - 0.5)
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4)]
    sides.append((1, 5, 7, 3))
    faces = [t for a, b, c, d in sides for t in ((a, b, c), (a, c, d))]
    return corners[np.array(faces, np.int64)]


def _stepped(outline: Array, closed: bool) -> Array:
    """An outline with more points between its own."""
    following = np.roll(outline, -1, axis=0)
    pairs = list(zip(outline, following, strict=True))
    points = []
    for a, b in pairs if closed else pairs[:-1]:
        count = int(np.ceil(np.linalg.norm(b - a) / _STEP))
        points += [a + (b - a) * k / count for k in range(count)]
    return np.array(points if closed else [*points, outline[-1]])


def _arc(
    radius: float, z: float, start: float, end: float
) -> list[tuple[float, float]]:
    angles = np.linspace(start, end, _SLICES // 4)
    r = np.where(np.abs(angles) == np.pi / 2, 0.0, radius * np.cos(angles))
    return list(zip(r, z + radius * np.sin(angles), strict=True))
