"""Triangle meshes as closed solids: their hull, or convex pieces of it."""

from __future__ import annotations

import coal
import numpy as np

from mmplan.array_cache import cached
from mmplan.collision.decomposition import Effort, cut
from mmplan.collision.enclosing import enclosing
from mmplan.collision.mesh_files import TriangleMesh, content_key, read_surface
from mmplan.collision.mesh_parts import is_closed, parts, signed_volume
from mmplan.exceptions import InputError
from mmplan.shapes import Array, Mesh

# A mesh whose hull is at most this much larger than itself is taken as convex.
_CONVEX_VOLUME_RATIO = 1.01
# CoACD's own 150 iterations take 10 times as long and gain a few pieces.
_EFFORT = Effort(concavity=0.02, iterations=20)
# A new number for each change of the method: what caches hold is then made anew.
_METHOD = 2


def convex_pieces(mesh: Mesh, largest: float = np.inf) -> list[Array]:
    """The corners (m, 3) of convex pieces that together fill the mesh.

    Surfaces that do not hang together are taken one by one. A convex one is one piece,
    any other is cut into pieces. Pieces with many corners are replaced by some that
    enclose them with fewer. The pieces are kept in the user's cache folder under the
    hash of the file's content and the scale, so that the triangles are read once.

    Raises:
        InputError: The mesh cannot be read, is larger than `largest` (m), is empty,
            flat or not closed, has too many triangles, or is not convex and the extra
            `meshes` is not installed.
    """

    def make() -> list[Array]:
        surface = read_surface(mesh)
        _check_size(mesh, surface.vertices, largest)
        if fault := _fault(surface):
            raise InputError(f"{mesh.path}: this mesh {fault}")
        return [
            enclosing(piece) for part in parts(surface) for piece in _pieces(mesh, part)
        ]

    pieces = cached("meshes", content_key(mesh, _EFFORT, _METHOD), make)
    _check_size(mesh, np.concatenate(pieces), largest)
    return pieces


def hulls(mesh: Mesh, largest: float = np.inf) -> list[coal.CollisionGeometry]:
    """The convex pieces of a mesh, see `convex_pieces`, for coal."""
    return [hull(piece) for piece in convex_pieces(mesh, largest)]


def hull(points: Array) -> coal.ConvexBase:
    """The convex hull of points (n, 3)."""
    corners = coal.StdVec_Vec3s()
    corners.extend(list(np.ascontiguousarray(points)))
    return coal.Convex.convexHull(corners, True, "Qt")


def _pieces(mesh: Mesh, part: TriangleMesh) -> list[Array]:
    """The corners of the pieces of a surface that hangs together."""
    corners, volume = _hull(part.vertices)
    if abs(signed_volume(part)) * _CONVEX_VOLUME_RATIO >= volume:
        return [corners]
    return [_hull(piece)[0] for piece in cut(mesh.path, part, _EFFORT)]


def _hull(points: Array) -> tuple[Array, float]:
    """The corners (m, 3) and the volume of the hull of points (n, 3).

    To about 1e-9 of its size: where many points are in one plane, qhull finds an exact
    hull only in a time that rises as their square.
    """
    from scipy.spatial import ConvexHull

    found = ConvexHull(points, qhull_options="QJ Pp")
    return points[np.sort(found.vertices)], float(found.volume)


def _check_size(mesh: Mesh, vertices: Array, largest: float) -> None:
    size = np.ptp(vertices, axis=0) if np.isfinite(vertices).all() else np.zeros(3)
    if size.max() > largest:
        extents = " x ".join(f"{extent:.3g}" for extent in size)
        raise InputError(
            f"{mesh.path}: this mesh is {extents} m large, and what is carried is at "
            f"most {largest:g} m; if it is in millimetres, give it 'scale: 0.001'"
        )


def _fault(surface: TriangleMesh) -> str | None:
    """Why the mesh is no solid, None if it is one."""
    vertices = surface.vertices
    if not np.isfinite(vertices).all():
        return "has a vertex that is not finite"
    if np.linalg.matrix_rank(vertices - vertices.mean(axis=0), tol=1e-9) < 3:
        return "is flat; a closed solid is needed"
    if not is_closed(surface):
        return (
            "is not closed: some edge has a triangle on one side only, or two that do "
            "not face the same way"
        )
    return None
