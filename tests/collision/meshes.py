"""Meshes that the tests write to files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mmplan.shapes import Array

Triangles = list[tuple[int, ...]]


def write_obj(path: Path, vertices: Array, faces: Triangles) -> Path:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_stl(path: Path, vertices: Array, faces: Triangles) -> Path:
    """Text STL, in which every triangle has corners of its own."""
    lines = ["solid thing"]
    for face in faces:
        corners = [
            f"vertex {x!r} {y!r} {z!r}" for x, y, z in vertices[list(face)].tolist()
        ]
        lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    path.write_text("\n".join([*lines, "endsolid thing"]) + "\n")
    return path


TETRAHEDRON = 0.1 * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
TETRAHEDRON_FACES: Triangles = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)]


def ball(n: int) -> tuple[Array, Triangles]:
    """A closed ball of radius 0.1 m, n facets from pole to pole and 2n around."""
    polar, turn = np.pi * np.arange(1, n) / n, np.pi * np.arange(2 * n) / n
    theta, phi = np.meshgrid(polar, turn, indexing="ij")
    xy = np.sin(theta) * [np.cos(phi), np.sin(phi)]
    rings = 0.1 * np.stack([*xy, np.cos(theta)], axis=-1).reshape(-1, 3)
    top, bottom, m = len(rings), len(rings) + 1, 2 * n
    faces: Triangles = []
    for k in range(m):
        east = (k + 1) % m
        faces += [(top, k, east), (bottom, (n - 2) * m + east, (n - 2) * m + k)]
        for ring in range(n - 2):
            a, b = ring * m + k, ring * m + east
            faces += [(a, a + m, b + m), (a, b + m, b)]
    return np.concatenate([rings, [[0, 0, 0.1], [0, 0, -0.1]]]), faces


# The outline of a U, 0.3 m wide and high, walls and floor 0.1 m thick.
_U = 0.1 * np.array([[0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3.0]])
_U_CAP = [(0, 1, 4), (0, 4, 5), (1, 2, 3), (1, 3, 4), (0, 5, 6), (0, 6, 7)]


def u_shape() -> tuple[Array, Triangles]:
    """A U, 0.1 m thick: closed, and far from convex."""
    n = len(_U)
    below, above = (np.column_stack([_U, np.full(n, z)]) for z in (0.0, 0.1))
    faces: Triangles = []
    for i in range(n):
        j = (i + 1) % n
        faces += [(i, j, n + j), (i, n + j, n + i)]
    faces += [(n + a, n + b, n + c) for a, b, c in _U_CAP]
    faces += [(a, c, b) for a, b, c in _U_CAP]
    return np.concatenate([below, above]), faces


def in_u_shape(points: Array) -> Array:
    """How deep points (n, 3) lie in the U, roughly, negative outside."""
    x, y, z = points.T
    outside = np.max([-x, x - 0.3, -y, y - 0.3, -z, z - 0.1], axis=0)
    hollow = np.min([x - 0.1, 0.2 - x, y - 0.1], axis=0)
    return -np.maximum(outside, hollow)
