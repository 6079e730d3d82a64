"""Triangle meshes as closed solids: their hull, or convex pieces of it."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
import zipfile
from pathlib import Path

import coal
import numpy as np
import numpy.typing as npt

from mmplan.exceptions import InputError
from mmplan.shapes import Array, Mesh

# A mesh whose hull is at most this much larger than itself is taken as convex.
_CONVEX_VOLUME_RATIO = 1.01
# Concavity at which the decomposition stops, as a share of the mesh's size.
_CONCAVITY = 0.02

Triangles = npt.NDArray[np.int64]  # (t, 3), indices into the vertices


def convex_pieces(mesh: Mesh) -> list[Array]:
    """The corners (m, 3) of convex pieces that together fill the mesh.

    A convex mesh is one piece. Any other is decomposed by CoACD once and the pieces
    are kept in the user's cache folder under the hash of the mesh. Between pieces there
    may be cracks of about 1e-4 of the mesh's size.

    Raises:
        InputError: The mesh cannot be read, is empty, flat or not closed, or is not
            convex and the extra `meshes` is not installed.
    """
    vertices, triangles = _load(mesh)
    hull_volume = hull(vertices).computeVolume()
    if _volume(vertices, triangles) * _CONVEX_VOLUME_RATIO >= hull_volume:
        return [vertices]
    return _decomposed(mesh, vertices, triangles)


def hull(points: Array) -> coal.ConvexBase:
    """The convex hull of points (n, 3)."""
    corners = coal.StdVec_Vec3s()
    corners.extend(list(np.ascontiguousarray(points)))
    return coal.Convex.convexHull(corners, True, "Qt")


def _load(mesh: Mesh) -> tuple[Array, Triangles]:
    try:
        model = coal.MeshLoader().load(str(mesh.path), np.array(mesh.scale))
    except (RuntimeError, ValueError) as error:
        raise InputError(
            f"{mesh.path}: this mesh cannot be read: {_reason(error)}"
        ) from error
    vertices = np.array(model.vertices())
    # coal's triangles raise no IndexError past their end, so that list() fails
    corners = [model.tri_indices(i) for i in range(model.num_tris)]
    triangles = np.array([(c[0], c[1], c[2]) for c in corners], dtype=np.int64)
    if fault := _fault(vertices, triangles):
        raise InputError(f"{mesh.path}: this mesh {fault}")
    return vertices, triangles


def _reason(error: Exception) -> str:
    """Why a file cannot be read, without where in coal's source that was found."""
    _, _, message = str(error).partition("message: ")
    name, _, cause = message.partition("\n")
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
    """The volume inside a closed mesh by the divergence theorem."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6.0


def _decomposed(mesh: Mesh, vertices: Array, triangles: Triangles) -> list[Array]:
    digest = hashlib.sha256(vertices.tobytes() + triangles.tobytes())
    digest.update(repr(_CONCAVITY).encode())
    cached = _cache_folder() / f"{digest.hexdigest()}.npz"
    pieces = _read(cached)
    if pieces is None:
        pieces = _coacd(mesh, vertices, triangles)
        # Without a cache the pieces are made anew each time.
        with contextlib.suppress(OSError):
            _write(cached, pieces)
    return pieces


def _coacd(mesh: Mesh, vertices: Array, triangles: Triangles) -> list[Array]:
    try:
        import coacd
    except ImportError as error:
        raise InputError(
            f"{mesh.path}: this mesh is not convex; to cut it into convex pieces "
            "install the extra: pip install 'mmplan[meshes]'"
        ) from error
    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(vertices, triangles), threshold=_CONCAVITY, seed=0
    )
    return [np.asarray(points, dtype=np.float64) for points, _ in parts]


def _cache_folder() -> Path:
    root = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(root) / "mmplan" / "meshes"


def _read(path: Path) -> list[Array] | None:
    """The pieces in a file of the cache; None where there is no sound one."""
    try:
        with path.open("rb") as file, np.load(file) as pieces:
            return [pieces[f"arr_{i}"] for i in range(len(pieces.files))]
    except (OSError, EOFError, KeyError, ValueError, zipfile.BadZipFile):
        return None


def _write(path: Path, pieces: list[Array]) -> None:
    """Write the pieces so that the file appears whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        part = Path(file.name)
        try:
            np.savez(file, *pieces)
            file.close()
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
