"""Boolean collision checks of many configurations at once, through Pinocchio."""

from __future__ import annotations

from collections.abc import Iterator

import coal
import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.shapes import Array

_Pool = pin.TreeBroadPhaseManagerPool_DynamicAABBTreeCollisionManager


class Checker:
    """Checks one geometry model; owns everything that Pinocchio only borrows.

    Pinocchio's broadphase managers keep neither model nor data alive and do not see
    later changes, so a checker is made once the geometry model is final.
    """

    def __init__(
        self, model: pin.Model, geometry: pin.GeometryModel, allowed_depth: Array
    ) -> None:
        """Prepare the checks; pairs may overlap by `allowed_depth` (m), (pairs,)."""
        self._model = model
        self._geometry = geometry
        self._allowed_depth = allowed_depth
        self._data = model.createData()
        self._geometry_data = geometry.createData()
        self._pool = _Pool(model, geometry, 1)
        for data in (self._geometry_data, self._pool.getGeometryData(0)):
            _configure(data, allowed_depth)

    def in_collision(self, q: Array) -> npt.NDArray[np.bool_]:
        """Which of the configurations (n, nq) are in collision, (n,)."""
        if len(q) == 0:
            return np.zeros(0, dtype=np.bool_)
        hits = pin.computeCollisionsInParallel(1, self._pool, _columns(q), True, False)
        return np.asarray(hits, dtype=np.bool_).ravel()

    def any_collision(self, q: Array) -> bool:
        """Whether any of the configurations (n, nq) is in collision."""
        if len(q) == 0:
            return False
        hits = pin.computeCollisionsInParallel(1, self._pool, _columns(q), True, True)
        return bool(np.any(hits))

    def overlaps(self, q: Array) -> Iterator[tuple[int, float]]:
        """Pairs that collide at q (nq,): index and depth (m)."""
        data, geometry_data = self._data, self._geometry_data
        pin.computeCollisions(
            self._model, data, self._geometry, geometry_data, np.asarray(q), False
        )
        for index, result in enumerate(geometry_data.collisionResults):
            if result.isCollision():
                distance = pin.computeDistance(self._geometry, geometry_data, index)
                yield index, max(0.0, -float(distance.min_distance))


def _columns(q: Array) -> Array:
    """Configurations as the Fortran-ordered columns (nq, n) that Pinocchio takes."""
    return np.ascontiguousarray(q, dtype=np.float64).T


def _configure(data: pin.GeometryData, allowed_depth: Array) -> None:
    """Exact, stateless requests: a cached guess can make GJK miss a deep overlap."""
    for request, depth in zip(data.collisionRequests, allowed_depth, strict=True):
        request.gjk_initial_guess = coal.GJKInitialGuess.DefaultGuess
        request.enable_cached_gjk_guess = False
        request.security_margin = -float(depth)
    for request in data.distanceRequests:
        request.gjk_initial_guess = coal.GJKInitialGuess.DefaultGuess
        request.enable_cached_gjk_guess = False
