"""The pair of base and grasp that overlaps with what it must not by the least."""

from __future__ import annotations

import numpy as np

from mmplan.blockers import collisions
from mmplan.collision.nearest import nearest_points
from mmplan.explanation.near_miss import NearMiss, line_between
from mmplan.optimizers import Queries, SearchSpace
from mmplan.scoring import End, Outcome, Overlap, ScoreFunction
from mmplan.shapes import Array

_LOOKED_AT = 40  # collisions
_STEPS = 40  # of the descent to a nearer miss
_STEP = 0.05  # m, or the share of a grasp gene's range, at first
_COLLIDING = (Outcome.COLLISION, Outcome.HAND_OPEN_COLLISION)


def nearest_overlap(
    score: ScoreFunction,
    space: SearchSpace,
    end: End,
    queries: Queries,
    rng: np.random.Generator,
    *,
    same_grasp: bool = False,
) -> NearMiss | None:
    """The shallowest of the queries' collisions, brought nearer by random steps.

    Steps leave the `same_grasp` if asked to. None where nothing is in collision.
    """
    found = collisions(score, end, queries, _LOOKED_AT, _COLLIDING)
    depths = [c[0].depth if c else np.inf for c in found.contacts]
    if not np.isfinite(min(depths, default=np.inf)):
        return None
    best = int(np.argmin(depths))
    q_base, grasp = found.queries.q_base[best], found.queries.grasps[best]
    overlap = score.overlap(end, q_base, grasp)
    assert overlap is not None, "it was found to overlap"
    for step in np.geomspace(_STEP, _STEP / 50.0, _STEPS):
        q, g = _moved(space, end, q_base, grasp, step, rng)
        g = grasp if same_grasp else g
        if score(end, q[None], g[None]).outcome[0] not in _COLLIDING:
            continue
        other = score.overlap(end, q, g)
        if other is not None and _depth(other) < _depth(overlap):
            overlap, q_base, grasp = other, q, g
    return _miss(score, end, q_base, grasp, overlap)


def _moved(
    space: SearchSpace,
    end: End,
    q_base: Array,
    grasp: Array,
    step: float,
    rng: np.random.Generator,
) -> tuple[Array, Array]:
    """A base (b,) and genes (g,) a random step (m, or share of a range) from others."""
    moved = q_base + rng.normal(0.0, step, len(q_base))
    genes = grasp + rng.normal(0.0, step, len(grasp)) * space.grasps.range
    return space.bases[end].nearest(moved[None])[0], space.grasps.contain(genes)


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
