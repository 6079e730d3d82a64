"""Cutting concave solids into convex pieces with CoACD, once for each mesh."""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
import zipfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin  # noqa: F401  cannot read URDFs once CoACD came first

from mmplan.exceptions import InputError
from mmplan.shapes import Array

Triangles = npt.NDArray[np.int64]  # (t, 3), indices into the vertices


class Effort(NamedTuple):
    """How finely to cut.

    `concavity` at which a piece counts as convex, as a share of the mesh's size, and
    `iterations` of the search for each cut.
    """

    concavity: float
    iterations: int


def decomposed(
    path: Path, vertices: Array, triangles: Triangles, effort: Effort
) -> list[Array]:
    """The corners (m, 3) of convex pieces that together fill a mesh, read from `path`.

    They are kept in the user's cache folder under the hash of the mesh and the effort.
    Between pieces there may be cracks of about 1e-4 of the mesh's size.

    Raises:
        InputError: The extra `meshes` is not installed.
    """
    digest = hashlib.sha256(vertices.tobytes() + triangles.tobytes())
    digest.update(repr(effort).encode())
    cached = _cache_folder() / f"{digest.hexdigest()}.npz"
    pieces = _read(cached)
    if pieces is None:
        pieces = _cut(path, vertices, triangles, effort)
        # Without a cache the pieces are made anew each time.
        with contextlib.suppress(OSError):
            _write(cached, pieces)
    return pieces


def _cut(
    path: Path, vertices: Array, triangles: Triangles, effort: Effort
) -> list[Array]:
    try:
        import coacd
    except ImportError as error:
        raise InputError(
            f"{path}: this mesh is not convex; to cut it into convex pieces "
            "install the extra: pip install 'mmplan[meshes]'"
        ) from error
    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(vertices, triangles),
        threshold=effort.concavity,
        mcts_iterations=effort.iterations,
        seed=0,
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
