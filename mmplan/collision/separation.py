"""Exact signed distances of single pairs of bodies at given poses."""

from __future__ import annotations

import coal
import pinocchio as pin

from mmplan.shapes import Array


class Separation:
    """Signed distances of the bodies of a geometry model, one pair at a time.

    Negative is the depth of overlap. No answer depends on an earlier one: every query
    starts from coal's default guess.
    """

    def __init__(self, geometry: pin.GeometryModel) -> None:
        """Take the shapes of a geometry model; its placements are not used."""
        self._shapes = [body.geometry for body in geometry.geometryObjects]
        self._request = coal.DistanceRequest()
        self._request.gjk_initial_guess = coal.GJKInitialGuess.DefaultGuess

    @staticmethod
    def pose(T_world_body: Array) -> coal.Transform3s:
        """A pose (4, 4) as `distance` takes it."""
        return coal.Transform3s(T_world_body[:3, :3], T_world_body[:3, 3])

    def distance(
        self, i: int, T_world_i: coal.Transform3s, j: int, T_world_j: coal.Transform3s
    ) -> float:
        """The signed distance (m) of bodies i and j at poses made by `pose`."""
        result = coal.DistanceResult()
        shapes = self._shapes
        return float(
            coal.distance(
                shapes[i], T_world_i, shapes[j], T_world_j, self._request, result
            )
        )
