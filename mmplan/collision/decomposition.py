"""Cutting concave solids into convex pieces with CoACD."""

from __future__ import annotations

import hashlib
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pinocchio as pin  # noqa: F401  cannot read URDFs once CoACD came first

from mmplan.array_cache import cached
from mmplan.collision.mesh_files import TriangleMesh
from mmplan.collision.simplification import grown, simplified
from mmplan.exceptions import InputError
from mmplan.shapes import Array


class Effort(NamedTuple):
    """How finely to cut.

    `concavity` at which a piece counts as convex, as a share of the mesh's size,
    `iterations` of the search for each cut, and how many `pieces` there may be, -1
    for any number.
    """

    concavity: float
    iterations: int
    pieces: int = -1


def decomposed(path: Path, surface: TriangleMesh, effort: Effort) -> list[Array]:
    """The same as `cut`, kept in the user's cache folder.

    Under the hash of the surface and the effort.

    Raises:
        InputError: The extra `meshes` is not installed.
    """
    digest = hashlib.sha256(surface.vertices.tobytes() + surface.triangles.tobytes())
    digest.update(repr(effort).encode())
    return cached("meshes", digest.hexdigest(), lambda: cut(path, surface, effort))


def cut(path: Path, surface: TriangleMesh, effort: Effort) -> list[Array]:
    """The corners (m, 3) of convex pieces that together fill a mesh, read from `path`.

    Between pieces there may be cracks of about 1e-4 of the mesh's size. A mesh of many
    triangles is simplified first, and then every vertex of it is in one of the pieces.

    Raises:
        InputError: The extra `meshes` is not installed.
    """
    try:
        import coacd

        coarse = simplified(surface)
    except ImportError as error:
        raise InputError(
            f"{path}: this mesh is not convex; to cut it into convex pieces "
            "install the extra: pip install 'mmplan[meshes]'"
        ) from error
    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(*coarse),
        threshold=effort.concavity,
        mcts_iterations=effort.iterations,
        max_convex_hull=effort.pieces,
        seed=0,
    )
    pieces = [np.asarray(points, dtype=np.float64) for points, _ in parts]
    return pieces if coarse is surface else grown(pieces, surface.vertices)
