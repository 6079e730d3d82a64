"""Triangle meshes as closed solids: their hull, or convex pieces of it."""

from __future__ import annotations

from pathlib import Path

import coal
import numpy as np

from mmplan.collision.decomposition import Effort, Triangles, decomposed
from mmplan.exceptions import InputError
from mmplan.shapes import Array, Mesh

# A mesh whose hull is at most this much larger than itself is taken as convex.
_CONVEX_VOLUME_RATIO = 1.01
# More triangles take minutes and gain nothing on the convex pieces.
_MOST_TRIANGLES = 500_000
# The size in bytes of the head of a binary STL file, which ends with the number of
# triangles, and of a triangle.
_STL_HEAD, _STL_TRIANGLE = 84, 50
# CoACD's own 150 iterations take 10 times as long and gain a few pieces.
_EFFORT = Effort(concavity=0.02, iterations=20)


def convex_pieces(mesh: Mesh) -> list[Array]:
    """The corners (m, 3) of convex pieces that together fill the mesh.

    Surfaces that do not hang together are taken one by one. A convex one is one piece.
    Any other is decomposed by CoACD once and the pieces are kept in the user's cache
    folder under the hash of the surface. Between pieces there may be cracks of about
    1e-4 of its size.

    Raises:
        InputError: The mesh cannot be read, is empty, flat or not closed, or is not
            convex and the extra `meshes` is not installed.
    """
    pieces: list[Array] = []
    for vertices, triangles in _parts(*_load(mesh)):
        hull_volume = hull(vertices).computeVolume()
        if _volume(vertices, triangles) * _CONVEX_VOLUME_RATIO >= hull_volume:
            pieces.append(vertices)
        else:
            pieces += decomposed(mesh.path, vertices, triangles, _EFFORT)
    return pieces


def _parts(vertices: Array, triangles: Triangles) -> list[tuple[Array, Triangles]]:
    """The surfaces of a mesh that do not hang together.

    A surface that bounds a cavity inside of another stays with all others.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    _, point = np.unique(vertices, axis=0, return_inverse=True)
    corners = point.reshape(-1)[triangles]
    start, end = corners.ravel(), np.roll(corners, -1, axis=1).ravel()
    n = int(corners.max()) + 1
    links = coo_array((np.ones(len(start), np.int8), (start, end)), shape=(n, n))
    count, label = connected_components(links, directed=False)
    labels = label[corners[:, 0]]
    parts = []
    for number in range(count):
        own = triangles[labels == number]
        if len(own) == 0:
            continue
        used, compact = np.unique(own, return_inverse=True)
        parts.append((vertices[used], compact.reshape(-1, 3)))
    if len(parts) == 1 or any(_signed_volume(*part) <= 0.0 for part in parts):
        return [(vertices, triangles)]
    return parts


def hull(points: Array) -> coal.ConvexBase:
    """The convex hull of points (n, 3)."""
    corners = coal.StdVec_Vec3s()
    corners.extend(list(np.ascontiguousarray(points)))
    return coal.Convex.convexHull(corners, True, "Qt")


def check_size(mesh: Mesh, largest: float) -> None:
    """Refuse a mesh that is larger (m) than such a thing can be.

    Raises:
        InputError: It is, or the file has too many triangles or cannot be read.
    """
    _check_count(mesh, _declared_triangles(mesh.path))
    vertices = np.array(read_mesh(mesh).vertices())
    size = np.ptp(vertices, axis=0) if np.isfinite(vertices).all() else np.zeros(3)
    if size.max() > largest:
        extents = " x ".join(f"{extent:.3g}" for extent in size)
        raise InputError(
            f"{mesh.path}: this mesh is {extents} m large, and what is carried is at "
            f"most {largest:g} m; if it is in millimetres, give it 'scale: 0.001'"
        )


def _load(mesh: Mesh) -> tuple[Array, Triangles]:
    _check_count(mesh, _declared_triangles(mesh.path))
    surface = read_mesh(mesh)
    _check_count(mesh, surface.num_tris)
    vertices, triangles = read_triangles(surface)
    if fault := _fault(vertices, triangles):
        raise InputError(f"{mesh.path}: this mesh {fault}")
    return vertices, triangles


def _check_count(mesh: Mesh, triangles: int) -> None:
    if triangles > _MOST_TRIANGLES:
        raise InputError(
            f"{mesh.path}: this mesh has {triangles:,} triangles, and at most "
            f"{_MOST_TRIANGLES:,} are taken; simplify it first"
        )


def _declared_triangles(path: Path) -> int:
    """How many triangles a binary STL file has; 0 where only reading it can tell.

    Reading a million takes the better part of a minute.
    """
    if path.suffix.lower() != ".stl" or not path.is_file():
        return 0
    with path.open("rb") as file:
        head = file.read(_STL_HEAD)
    count = int.from_bytes(head[-4:], "little")
    return count if path.stat().st_size == _STL_HEAD + _STL_TRIANGLE * count else 0


def read_mesh(mesh: Mesh) -> coal.BVHModelBase:
    """The surface in a file, closed or not.

    Raises:
        InputError: The file cannot be read.
    """
    try:
        return coal.MeshLoader().load(str(mesh.path), np.array(mesh.scale))
    except (RuntimeError, ValueError) as error:
        raise InputError(
            f"{mesh.path}: this mesh cannot be read: {_reason(error)}"
        ) from error


def read_triangles(surface: coal.BVHModelBase) -> tuple[Array, Triangles]:
    """The vertices (n, 3) of a surface and its triangles."""
    # coal's triangles raise no IndexError past their end, so that list() fails
    corners = [surface.tri_indices(i) for i in range(surface.num_tris)]
    triangles = np.array([(c[0], c[1], c[2]) for c in corners], dtype=np.int64)
    return np.array(surface.vertices()), triangles


def _reason(error: Exception) -> str:
    """Why a file cannot be read, without where in coal's source that was found."""
    _, _, message = str(error).partition("message: ")
    name, _, cause = message.partition("\n")
    if "No meshes remaining" in cause:
        return "it has no triangles"
    return cause.partition("\n")[0] or name or str(error)


def _fault(vertices: Array, triangles: Triangles) -> str | None:
    """Why the mesh is no solid, None if it is one."""
    if not np.isfinite(vertices).all():
        return "has a vertex that is not finite"
    if np.linalg.matrix_rank(vertices - vertices.mean(axis=0), tol=1e-9) < 3:
        return "is flat; a closed solid is needed"
    if not _is_closed(vertices, triangles):
        return (
            "is not closed: some edge has a triangle on one side only, or two that do "
            "not face the same way"
        )
    return None


def _is_closed(vertices: Array, triangles: Triangles) -> bool:
    """Whether every edge is passed as often one way as the other.

    So it is only where the surface has no border and all triangles face the same side.
    """
    _, point = np.unique(vertices, axis=0, return_inverse=True)
    a, b, c = point.reshape(-1)[triangles].T
    start, end = np.concatenate([a, b, c]), np.concatenate([b, c, a])
    n = len(vertices)
    return np.array_equal(np.sort(start * n + end), np.sort(end * n + start))


def _volume(vertices: Array, triangles: Triangles) -> float:
    """The volume inside a closed mesh."""
    return abs(_signed_volume(vertices, triangles))


def _signed_volume(vertices: Array, triangles: Triangles) -> float:
    """The volume by the divergence theorem; negative where triangles face inward."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
