"""How coal is asked: exactly, and without memory of earlier questions."""

from __future__ import annotations

import warnings
from collections.abc import Iterable

import coal
import pinocchio as pin

from mmplan.shapes import Array

# Distances are exact to this, m.
GJK_TOLERANCE = 1e-10


def make_exact(data: pin.GeometryData, allowed_depth: Array | None = None) -> None:
    """Set up all requests of a geometry model's data.

    Pairs may overlap by `allowed_depth` (m), (pairs,).
    """
    _forget(data.collisionRequests)
    _forget(data.distanceRequests)
    for request in data.distanceRequests:
        request.gjk_tolerance = GJK_TOLERANCE
    if allowed_depth is not None:
        for request, depth in zip(data.collisionRequests, allowed_depth, strict=True):
            request.security_margin = -float(depth)


def distance_request() -> coal.DistanceRequest:
    """An exact request for single pairs."""
    request = coal.DistanceRequest()
    _forget([request])
    request.gjk_tolerance = GJK_TOLERANCE
    return request


def _forget(requests: Iterable[coal.DistanceRequest | coal.CollisionRequest]) -> None:
    """Make every query start from the default guess.

    A cached guess, which is on by default, can make GJK miss a deep overlap and makes
    answers depend on earlier ones. It is turned off by a flag that coal calls
    deprecated, but whose replacement does not turn it off.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        for request in requests:
            request.gjk_initial_guess = coal.GJKInitialGuess.DefaultGuess
            request.enable_cached_gjk_guess = False
