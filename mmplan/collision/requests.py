"""How coal is asked: exactly, and without memory of earlier questions."""

from __future__ import annotations

import warnings

import coal
import pinocchio as pin

from mmplan.shapes import Array

# Distances are exact to this, m.
GJK_TOLERANCE = 1e-10


def make_exact(data: pin.GeometryData, allowed_depth: Array | None = None) -> None:
    """Set up all requests of a geometry model's data.

    A cached guess, coal's default, can make GJK miss a deep overlap and makes answers
    depend on earlier ones. Pairs may overlap by `allowed_depth` (m), (pairs,).
    """
    with warnings.catch_warnings():
        # Deprecated, and heeded nevertheless.
        warnings.filterwarnings("ignore", "enable_cached_gjk_guess", DeprecationWarning)
        for requests in (data.collisionRequests, data.distanceRequests):
            for request in requests:
                request.gjk_initial_guess = coal.GJKInitialGuess.DefaultGuess
                request.enable_cached_gjk_guess = False
    for request in data.distanceRequests:
        request.gjk_tolerance = GJK_TOLERANCE
    if allowed_depth is not None:
        for request, depth in zip(data.collisionRequests, allowed_depth, strict=True):
            request.security_margin = -float(depth)
