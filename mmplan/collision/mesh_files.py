"""Triangle meshes in files: what is in them, and a key for what is made of them."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple, TypeAlias

import coal
import numpy as np
import numpy.typing as npt

from mmplan.exceptions import InputError
from mmplan.files.fingerprint import fingerprint
from mmplan.shapes import Array, Mesh

Triangles: TypeAlias = npt.NDArray[np.int64]  # (t, 3), indices into the vertices

# More triangles take more memory than many a machine has to spare.
_MOST_TRIANGLES = 5_000_000
# The size in bytes of the head of a binary STL file, which ends with the number of
# triangles.
_STL_HEAD = 84
_STL_TRIANGLE = np.dtype(
    [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")]
)
# Odd and large, so that the bits of coordinates spread over all of 64.
_MIXER = np.int64(0x1E3779B97F4A7C15)


class TriangleMesh(NamedTuple):
    """Triangles, their corners counter-clockwise as seen from outside."""

    vertices: Array  # (n, 3), m
    triangles: Triangles  # (t, 3)


def content_key(mesh: Mesh, *settings: object) -> str:
    """A key for what is made of a mesh with some settings, by the file's content.

    Raises:
        InputError: The file cannot be read.
    """
    content = fingerprint({"mesh": mesh.path})
    what = (content, mesh.path.suffix.lower(), mesh.scale, *settings)
    return hashlib.sha256(repr(what).encode()).hexdigest()


def read_surface(mesh: Mesh) -> TriangleMesh:
    """The surface in a file, every vertex once.

    Raises:
        InputError: The file cannot be read, or has too many triangles.
    """
    declared = _binary_stl_count(mesh.path)
    _check_count(mesh, declared)
    if declared:
        records = np.fromfile(mesh.path, _STL_TRIANGLE, offset=_STL_HEAD)
        corners = records["corners"].astype(np.float64).reshape(-1, 3)
        found = corners * mesh.scale, np.arange(len(corners)).reshape(-1, 3)
        return _welded(*found)
    surface = read_mesh(mesh)
    _check_count(mesh, surface.num_tris)
    return _welded(*read_triangles(surface))


def read_mesh(mesh: Mesh) -> coal.BVHModelBase:
    """The surface in a file as coal reads it, which takes 8 s a million triangles.

    Raises:
        InputError: The file cannot be read.
    """
    try:
        return coal.MeshLoader().load(str(mesh.path), np.array(mesh.scale))
    except (RuntimeError, ValueError) as error:
        raise InputError(
            f"{mesh.path}: this mesh cannot be read: {_reason(error)}"
        ) from error


def read_triangles(surface: coal.BVHModelBase) -> TriangleMesh:
    """The vertices and the triangles of a surface that coal has read."""
    # coal's triangles raise no IndexError past their end, so that list() fails
    corners = [surface.tri_indices(i) for i in range(surface.num_tris)]
    triangles = np.array([(c[0], c[1], c[2]) for c in corners], dtype=np.int64)
    return TriangleMesh(np.array(surface.vertices()), triangles.reshape(-1, 3))


def surface_tree(surface: TriangleMesh) -> coal.BVHModelBase:
    """Triangles for coal's queries of surfaces."""
    vertices, triangles = surface
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(triangles), len(vertices))
    tree.addVertices(vertices)
    tree.addTriangles(triangles)
    tree.endModel()
    return tree


def _check_count(mesh: Mesh, triangles: int) -> None:
    if triangles > _MOST_TRIANGLES:
        raise InputError(
            f"{mesh.path}: this mesh has {triangles:,} triangles, and at most "
            f"{_MOST_TRIANGLES:,} are taken; simplify it first"
        )


def _binary_stl_count(path: Path) -> int:
    """How many triangles a binary STL file has; 0 where it is no such file."""
    if path.suffix.lower() != ".stl" or not path.is_file():
        return 0
    with path.open("rb") as file:
        head = file.read(_STL_HEAD)
    count = int.from_bytes(head[-4:], "little")
    size = _STL_HEAD + _STL_TRIANGLE.itemsize * count
    return count if path.stat().st_size == size else 0


def _welded(vertices: Array, triangles: Triangles) -> TriangleMesh:
    """The same with vertices at the same place made one, in the order that they had."""
    bits = (vertices + 0.0).view(np.int64)  # with one zero, not two
    # Sorting numbers is ten times quicker than sorting rows.
    mixed = np.zeros(len(bits), np.int64)
    for axis in range(3):
        mixed = (mixed + bits[:, axis]) * _MIXER
        mixed ^= mixed >> 32
    first, place = _distinct(mixed)
    if not np.array_equal(bits[first][place], bits):
        first, place = _distinct(bits)
    order = np.argsort(first)
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    return TriangleMesh(vertices[first[order]], rank[place][triangles])


def _distinct(
    rows: npt.NDArray[np.int64],
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Where each value comes first, and for each row which of these it is."""
    axis = None if rows.ndim == 1 else 0
    _, first, which = np.unique(rows, axis=axis, return_index=True, return_inverse=True)
    return first, which.reshape(-1)


def _reason(error: Exception) -> str:
    """Why a file cannot be read, without where in coal's source that was found."""
    _, _, message = str(error).partition("message: ")
    name, _, cause = message.partition("\n")
    if "No meshes remaining" in cause:
        return "it has no triangles"
    return cause.partition("\n")[0] or name or str(error)
