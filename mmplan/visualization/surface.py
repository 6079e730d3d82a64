"""Surfaces as triangles: of the shapes of scenes and robots, of lines and frames."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import singledispatch
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from mmplan.shapes import (
    Array,
    Box,
    Capsule,
    Cone,
    Cylinder,
    Revolve,
    Shape,
    Sphere,
)

Triangles = npt.NDArray[np.int64]  # (m, 3), indices into vertices

# Slices of a turn about an axis, and of the quarter circle of a sphere's outline.
_SLICES, _ARC = 36, 9


@dataclass(frozen=True, eq=False)
class Surface:
    """Triangles, their corners counter-clockwise as seen from outside.

    Triangles that share a vertex are smooth there; an edge has vertices of its own on
    either side.
    """

    vertices: Array  # (n, 3), m
    triangles: Triangles

    @property
    def normals(self) -> Array:
        """Unit normals of the vertices (n, 3), weighted by the triangles' areas."""
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        face = np.cross(b - a, c - a)
        normals = np.zeros_like(self.vertices)
        for corner in range(3):
            np.add.at(normals, self.triangles[:, corner], face)
        length = np.linalg.norm(normals, axis=1, keepdims=True)
        unit: Array = normals / np.where(length > 0.0, length, 1.0)
        return unit

    def moved(self, T: Array) -> Surface:
        """The surface at a pose (4, 4)."""
        return Surface(self.vertices @ T[:3, :3].T + T[:3, 3], self.triangles)


def joined(surfaces: Sequence[Surface]) -> Surface:
    """All surfaces as one."""
    sizes = [len(s.vertices) for s in surfaces]
    starts = np.cumsum([0, *sizes])[:-1]
    triangles = [s.triangles + i for s, i in zip(surfaces, starts, strict=True)]
    return Surface(
        np.concatenate([np.empty((0, 3)), *(s.vertices for s in surfaces)]),
        np.concatenate([np.empty((0, 3), np.int64), *triangles]),
    )


@singledispatch
def surface_of(shape: Shape) -> Surface:
    """The surface of a shape in the shape's frame, but not of a mesh in a file."""
    raise TypeError(f"no surface for a shape of type {type(shape).__name__}")


@surface_of.register
def _(shape: Box) -> Surface:
    signs = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)])
    return Surface(signs * np.array(shape.size) / 2.0, _BOX)


@surface_of.register
def _(shape: Sphere) -> Surface:
    return turned(shape.radius * _arc(-np.pi / 2, np.pi / 2, 2 * _ARC))


@surface_of.register
def _(shape: Cylinder) -> Surface:
    r, z = shape.radius, shape.length / 2.0
    return turned(np.array([[0.0, -z], [r, -z], [r, z], [0.0, z]]))


@surface_of.register
def _(shape: Capsule) -> Surface:
    ends = [shape.radius * _arc(a, a + np.pi / 2, _ARC) for a in (-np.pi / 2, 0.0)]
    ends[0][:, 1] -= shape.length / 2.0
    ends[1][:, 1] += shape.length / 2.0
    return turned(np.concatenate(ends))


@surface_of.register
def _(shape: Cone) -> Surface:
    r, z = shape.radius, shape.length / 2.0
    return turned(np.array([[0.0, -z], [r, -z], [0.0, z]]))


@surface_of.register
def _(shape: Revolve) -> Surface:
    return turned(shape.profile)


def turned(profile: Array, slices: int = _SLICES) -> Surface:
    """The surface of a closed outline (n, 2) of (r, z) that turns about z."""
    n = len(profile)
    angle = 2.0 * np.pi * np.arange(slices) / slices
    r, z = profile[:, 0], profile[:, 1]
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=1)  # (slices, 2)
    vertices = np.empty((slices, n, 3))
    vertices[..., :2] = ring[:, None] * r[:, None]
    vertices[..., 2] = z
    i, j = np.meshgrid(np.arange(slices), np.arange(n), indexing="ij")
    here, up = i * n + j, i * n + (j + 1) % n
    beside = (i + 1) % slices * n + j
    across = (i + 1) % slices * n + (j + 1) % n
    quads = np.stack([[here, beside, across], [here, across, up]]).reshape(2, 3, -1)
    surface = Surface(vertices.reshape(-1, 3), np.concatenate(quads, axis=1).T)
    return _outside_out(_without_slivers(surface))


def tube(points: Array, radius: float) -> Surface:
    """A pipe of eight sides along straight lines through points (n, 3)."""
    outline = np.array([[0.0, 0.0], [radius, 0.0], [radius, 1.0], [0.0, 1.0]])
    pipe = turned(outline, 8)
    pieces = []
    for start, end in pairwise(points):
        length = float(np.linalg.norm(end - start))
        if length > 0.0:
            T = _along(start, (end - start) / length)
            pieces.append(pipe.moved(T @ np.diag([1.0, 1.0, length, 1.0])))
    return joined(pieces)


def ring(inner: float, outer: float) -> Surface:
    """A flat ring about z, seen from both sides."""
    rim = np.array([[inner, -5e-4], [outer, -5e-4], [outer, 5e-4], [inner, 5e-4]])
    return turned(rim, 2 * _SLICES)


def _along(start: Array, z: Array) -> Array:
    """A frame (4, 4) at `start` with that z axis."""
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    T = np.eye(4)
    T[:3] = np.stack([x, np.cross(z, x), z, start], axis=1)
    return T


def _arc(start: float, end: float, steps: int) -> Array:
    """Points (steps + 1, 2) of the unit circle, between two angles (rad)."""
    angle = np.linspace(start, end, steps + 1)
    arc = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    arc[np.abs(arc) < 1e-12] = 0.0
    return arc


def _without_slivers(surface: Surface) -> Surface:
    """The surface without triangles that have no area."""
    a, b, c = (surface.vertices[surface.triangles[:, i]] for i in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return Surface(surface.vertices, surface.triangles[area > 1e-14])


def _outside_out(surface: Surface) -> Surface:
    """The surface, its triangles turned round where they all face inside."""
    a, b, c = (surface.vertices[surface.triangles[:, i]] for i in range(3))
    if np.einsum("ij,ij->", a, np.cross(b, c)) >= 0.0:
        return surface
    return Surface(surface.vertices, surface.triangles[:, ::-1])


_BOX = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ]
)
