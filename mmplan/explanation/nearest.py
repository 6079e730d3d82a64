"""Which nearest miss belongs to a cause."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mmplan.explanation.causes import Cause
from mmplan.explanation.evidence import Evidence
from mmplan.explanation.near_limit import nearest_limit
from mmplan.explanation.near_miss import NearMiss
from mmplan.explanation.near_overlap import nearest_overlap
from mmplan.explanation.near_reach import nearest_reach
from mmplan.explanation.near_steps import Steps
from mmplan.explanation.survey import bases_about
from mmplan.optimizers import Queries
from mmplan.scoring import End, Outcome
from mmplan.shapes import Array

# Of what works at one end, bases and grasps that are tried at the other.
_GRASPS, _BASES = 12, 12
# Where no base near the object is free: how much farther to look, m, and how often.
_FAR, _DRAWN = 3.0, 3000


def nearest_miss(
    evidence: Evidence, cause: Cause, rng: np.random.Generator
) -> NearMiss | None:
    """The nearest miss of what a cause is about, None where there is no measure."""
    if cause.kind == "common grasp":
        return _furthest_grasp(evidence, rng)
    if cause.end is None:
        return None
    seen = evidence.surveys[cause.end]
    if cause.kind == "joint limits":
        return nearest_limit(evidence.score, seen)
    steps = Steps(evidence.score, evidence.space, cause.end, rng)
    if cause.kind in ("collision", "hand opened"):
        return nearest_overlap(steps, evidence.queries)
    if cause.kind in ("reach", "base", "base bounds"):
        free = seen.queries.take(seen.base == Outcome.SCORED)
        pairs = free if len(free.end) else _far_pairs(evidence, cause.end, rng)
        return nearest_reach(steps, pairs)
    return None


def _far_pairs(evidence: Evidence, end: End, rng: np.random.Generator) -> Queries:
    """Free bases, too far away to reach from, with grasps."""
    score = evidence.score
    span = score.problem.robot.reach + _FAR
    q_base = bases_about(score, end, span, _DRAWN, rng)
    q_base = q_base[score.base_outcomes(end, q_base) == Outcome.SCORED]
    n = len(q_base)
    return Queries(
        np.full(n, end, np.int8), q_base, evidence.space.grasps.sample(n, rng)
    )


def _furthest_grasp(evidence: Evidence, rng: np.random.Generator) -> NearMiss | None:
    """Of the grasps that work at one end, the one that misses by the least."""
    misses = []
    for end in End:
        pairs = _pairs_with_grasps_of_the_other(evidence, end, rng)
        steps = Steps(evidence.score, evidence.space, end, rng, same_grasp=True)
        miss = nearest_overlap(steps, pairs) or nearest_reach(steps, pairs)
        if miss is not None:
            misses.append(replace(miss, works_at=End(1 - end)))
    return min(misses, key=lambda miss: miss.amount, default=None)


def _pairs_with_grasps_of_the_other(
    evidence: Evidence, end: End, rng: np.random.Generator
) -> Queries:
    """Bases that work at an end, each with grasps that work at the other end."""
    bases, grasps = (_working(evidence, e) for e in (end, End(1 - end)))
    q_base = _some(bases.q_base, _BASES, rng)
    genes = _some(grasps.grasps, _GRASPS, rng)
    n, m = len(q_base), len(genes)
    return Queries(
        end=np.full(n * m, end, np.int8),
        q_base=np.repeat(q_base, m, axis=0),
        grasps=np.tile(genes, (n, 1)),
    )


def _working(evidence: Evidence, end: End) -> Queries:
    """The pairs that were seen to be feasible at an end."""
    seen = evidence.queries.take(evidence.queries.end == end)
    outcome = evidence.score(end, seen.q_base, seen.grasps).outcome
    return seen.take(outcome == Outcome.SCORED)


def _some(rows: Array, most: int, rng: np.random.Generator) -> Array:
    chosen: Array = rng.choice(rows, min(most, len(rows)), replace=False)
    return chosen
