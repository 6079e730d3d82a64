"""Cutting concave solids into convex pieces with CoACD, once for each mesh."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin  # noqa: F401  cannot read URDFs once CoACD came first

from mmplan.array_cache import cached
from mmplan.exceptions import InputError
from mmplan.shapes import Array

Triangles = npt.NDArray[np.int64]  # (t, 3), indices into the vertices


class Effort(NamedTuple):
    """How finely to cut.

    `concavity` at which a piece counts as convex, as a share of the mesh's size,
    `iterations` of the search for each cut, and how many `pieces` there may be, -1
    for any number.
    """

    concavity: float
    iterations: int
    pieces: int = -1


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
    return cached(
        "meshes", digest.hexdigest(), lambda: _cut(path, vertices, triangles, effort)
    )


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
        max_convex_hull=effort.pieces,
        seed=0,
    )
    return [np.asarray(points, dtype=np.float64) for points, _ in parts]
