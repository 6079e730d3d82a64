"""Exact signed distances of single pairs of geometries."""

from __future__ import annotations

import coal
import pinocchio as pin

from mmplan.collision.requests import PROOF_TOLERANCE, distance_request
from mmplan.shapes import Array


def transform(T: Array) -> coal.Transform3s:
    """A pose (4, 4) as `signed_distance` takes it."""
    return coal.Transform3s(T[:3, :3], T[:3, 3])


def signed_distance(
    first: coal.CollisionGeometry,
    T_world_first: coal.Transform3s,
    second: coal.CollisionGeometry,
    T_world_second: coal.Transform3s,
) -> float:
    """The distance (m) of two convex geometries; negative is the depth of overlap.

    No answer depends on an earlier one: every query starts from coal's default guess.
    """
    result = coal.DistanceResult()
    return float(
        coal.distance(first, T_world_first, second, T_world_second, _REQUEST, result)
    )


class Separation:
    """Signed distances of the bodies of a geometry model at any poses."""

    def __init__(self, geometry: pin.GeometryModel) -> None:
        """Take the shapes of a geometry model; its placements are not used."""
        self._shapes = [body.geometry for body in geometry.geometryObjects]

    def distance(
        self, i: int, T_world_i: coal.Transform3s, j: int, T_world_j: coal.Transform3s
    ) -> float:
        """The signed distance (m) of bodies i and j at poses made by `transform`."""
        return signed_distance(self._shapes[i], T_world_i, self._shapes[j], T_world_j)


_REQUEST = distance_request(PROOF_TOLERANCE)
