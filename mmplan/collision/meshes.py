"""Triangle meshes as closed solids: their hull, or convex pieces of it."""

from __future__ import annotations

import hashlib
import os
import tempfile
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


def convex_pieces(mesh: Mesh) -> list[Array]:
    """The corners (m, 3) of convex pieces that together fill the mesh.

    A convex mesh is one piece. Any other is decomposed by CoACD once and the pieces
    are kept in the user's cache folder under the hash of the mesh.

    Raises:
        InputError: The mesh cannot be read, is empty or flat, or is not convex and
            the extra `meshes` is not installed.
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


def _load(mesh: Mesh) -> tuple[Array, npt.NDArray[np.int64]]:
    try:
        model = coal.MeshLoader().load(str(mesh.path), np.array(mesh.scale))
    except (RuntimeError, ValueError) as error:
        raise InputError(f"{mesh.path}: this mesh cannot be read: {error}") from error
    if model.num_tris == 0:
        raise InputError(f"{mesh.path}: this mesh has no triangles")
    vertices = np.array(model.vertices())
    triangles = np.array([list(model.tri_indices(i)) for i in range(model.num_tris)])
    if np.linalg.matrix_rank(vertices - vertices.mean(axis=0), tol=1e-9) < 3:
        raise InputError(f"{mesh.path}: this mesh is flat; a closed solid is needed")
    return vertices, triangles


def _volume(vertices: Array, triangles: npt.NDArray[np.int64]) -> float:
    """The volume inside a closed mesh by the divergence theorem."""
    a, b, c = (vertices[triangles[:, i]] for i in range(3))
    return abs(float(np.einsum("ij,ij->", a, np.cross(b, c)))) / 6.0


def _decomposed(
    mesh: Mesh, vertices: Array, triangles: npt.NDArray[np.int64]
) -> list[Array]:
    digest = hashlib.sha256(vertices.tobytes() + triangles.tobytes())
    digest.update(repr(_CONCAVITY).encode())
    cached = _cache_folder() / f"{digest.hexdigest()}.npz"
    if not cached.exists():
        _write(cached, _coacd(mesh, vertices, triangles))
    with np.load(cached) as pieces:
        return [pieces[name] for name in sorted(pieces.files, key=lambda n: int(n[4:]))]


def _coacd(
    mesh: Mesh, vertices: Array, triangles: npt.NDArray[np.int64]
) -> list[Array]:
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


def _write(path: Path, pieces: list[Array]) -> None:
    """Write the pieces so that the file appears whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
        np.savez(file, *pieces)
    Path(file.name).replace(path)
