"""The pair of base and grasp that overlaps with what it must not by the least."""

from __future__ import annotations

import numpy as np

from mmplan.blockers import collisions
from mmplan.collision.nearest import nearest_points
from mmplan.explanation.near_miss import NearMiss, line_between
from mmplan.explanation.near_steps import Steps
from mmplan.optimizers import Queries
from mmplan.scoring import End, Outcome, Overlap, ScoreFunction
from mmplan.shapes import Array

_LOOKED_AT = 40  # collisions
_STEPS = 40  # of the descent to a nearer miss
_STEP = 0.05  # m, or the share of a grasp gene's range, at first
_COLLIDING = (Outcome.COLLISION, Outcome.HAND_OPEN_COLLISION)


def nearest_overlap(steps: Steps, queries: Queries) -> NearMiss | None:
    """The shallowest of the queries' collisions, brought nearer by random steps.

    None where nothing is in collision.
    """
    score, end = steps.score, steps.end
    found = collisions(score, end, queries, _LOOKED_AT, _COLLIDING)
    depths = [c[0].depth if c else np.inf for c in found.contacts]
    if not np.isfinite(min(depths, default=np.inf)):
        return None
    best = int(np.argmin(depths))
    q_base, grasp = found.queries.q_base[best], found.queries.grasps[best]
    overlap = score.overlap(end, q_base, grasp)
    assert overlap is not None, "it was found to overlap"
    for size in steps.sizes(_STEP, _STEPS):
        _, bases, grasps = steps.taken(q_base, grasp, size)
        if score(end, bases, grasps).outcome[0] not in _COLLIDING:
            continue
        other = score.overlap(end, bases[0], grasps[0])
        if other is not None and _depth(other) < _depth(overlap):
            overlap, q_base, grasp = other, bases[0], grasps[0]
    return _miss(score, end, q_base, grasp, overlap)


def _depth(overlap: Overlap) -> float:
    return overlap.contacts[0].depth


def _miss(
    score: ScoreFunction, end: End, q_base: Array, grasp: Array, overlap: Overlap
) -> NearMiss:
    contact = overlap.contacts[0]
    points = nearest_points(score.worlds[end], overlap.q, contact.first, contact.second)
    return NearMiss(
        end=end,
        kind="overlap",
        first=contact.first,
        second=contact.second,
        amount=contact.depth,
        base=tuple(q_base.tolist()),
        grasp=tuple(grasp.tolist()),
        q=tuple(overlap.q.tolist()),
        line=line_between(*points),
    )
