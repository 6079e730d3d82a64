"""How coal is asked: exactly, and without memory of earlier questions."""

from __future__ import annotations

import warnings

import coal
import numpy as np
import pinocchio as pin

from mmplan.shapes import Array

# Where coal stops to improve distances, m: those of round bodies may come out about
# twice as much too large. For scores, and for proofs.
SCORE_TOLERANCE, PROOF_TOLERANCE = 1e-6, 1e-9
# Bodies nearer than this touch, m: twice what GJK leaves open in a yes or no.
TOUCH = 2e-6
# What passes by at less than this cannot be proven apart by a few bisections, m.
PROVABLE = 2e-5


def make_exact(data: pin.GeometryData, allowed_depth: Array | None = None) -> None:
    """Set up all requests of a geometry model's data.

    Pairs may overlap by `allowed_depth` (m), (pairs,).
    """
    collisions, distances = data.collisionRequests, data.distanceRequests
    if allowed_depth is None:
        allowed_depth = np.zeros(len(collisions))
    by_depth = {d: collision_request(d) for d in set(allowed_depth.tolist())}
    distance = distance_request(SCORE_TOLERANCE)
    for pair, depth in enumerate(allowed_depth.tolist()):
        collisions[pair] = by_depth[depth]
        distances[pair] = distance


def collision_request(allowed_depth: float) -> coal.CollisionRequest:
    """A request for yes or no that lets overlaps pass down to a depth (m).

    Without contacts coal answers three times as quickly. It then takes what its GJK
    ends on for the distance, which is up to 1 um above 0 even for bodies that overlap
    deeply: hence a margin of `TOUCH`.
    """
    request = coal.CollisionRequest()
    _forget(request)
    depth_counts = allowed_depth > 0.0
    request.enable_contact = depth_counts
    request.security_margin = (
        -allowed_depth if depth_counts else max(TOUCH, -allowed_depth)
    )
    return request


def distance_request(tolerance: float) -> coal.DistanceRequest:
    """A request for distances that coal improves until `tolerance` (m)."""
    request = coal.DistanceRequest()
    _forget(request)
    request.gjk_tolerance = tolerance
    return request


def _forget(request: coal.DistanceRequest | coal.CollisionRequest) -> None:
    """Make every query start from the default guess.

    A cached guess, which is on by default, can make GJK miss a deep overlap and makes
    answers depend on earlier ones. It is turned off by a flag that coal calls
    deprecated, but whose replacement does not turn it off.
    """
    request.gjk_initial_guess = coal.GJKInitialGuess.DefaultGuess
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        request.enable_cached_gjk_guess = False
