"""The nearest miss: the pair of base and grasp that fails by the least."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.blockers import Collisions
from mmplan.explanation.causes import Cause
from mmplan.explanation.evidence import Evidence
from mmplan.explanation.survey import Survey
from mmplan.optimizers import SearchSpace
from mmplan.scoring import End, Outcome, ScoreFunction

_MILLIMETRES = 1000.0
_STEPS = 40  # of the descent to a nearer miss
_STEP = 0.05  # m, or the share of a grasp gene's range, at first
_COLLIDING = (Outcome.COLLISION, Outcome.HAND_OPEN_COLLISION)


@dataclass(frozen=True)
class NearMiss:
    """What is missing in the best pair of base and grasp that fails at one end.

    `amount` is a depth in m where two things overlap, and rad or m where `first` is a
    joint beyond its limit, in which case `second` is None.
    """

    end: End
    first: str
    second: str | None
    amount: float
    base: tuple[float, ...]
    grasp: tuple[float, ...]

    def __str__(self) -> str:
        """The miss in words."""
        where = f"at the {self.end.name.lower()}"
        base = ", ".join(f"{x:.3f}" for x in self.base)
        stands = f"with the base at ({base})" if self.base else ""
        if self.second is None:
            return (
                f"{where} {self.first} is {self.amount:.3f} beyond its limit {stands}"
            )
        depth = self.amount * _MILLIMETRES
        return f"{where} {self.first} misses {self.second} by -{depth:.1f} mm {stands}"


def nearest_miss(
    evidence: Evidence, cause: Cause, rng: np.random.Generator
) -> NearMiss | None:
    """The nearest miss of what a cause is about, None where there is no measure."""
    if cause.end is None:
        return None
    if cause.kind == "joint limits":
        return _nearest_limit(evidence.score, evidence.surveys[cause.end])
    if cause.kind in ("collision", "hand opened"):
        found = evidence.collisions(cause.end, _COLLIDING)
        return _nearest_collision(evidence.score, cause.end, found, evidence.space, rng)
    return None


def _nearest_collision(
    score: ScoreFunction,
    end: End,
    found: Collisions,
    space: SearchSpace,
    rng: np.random.Generator,
) -> NearMiss | None:
    """The shallowest of the collisions, brought nearer by random steps from there.

    None where there are no collisions.
    """
    depths = [c[0].depth if c else np.inf for c in found.contacts]
    if not np.isfinite(min(depths, default=np.inf)):
        return None
    best = int(np.argmin(depths))
    contact = found.contacts[best][0]
    q_base, grasp = found.queries.q_base[best], found.queries.grasps[best]
    genes = space.grasps
    for step in np.geomspace(_STEP, _STEP / 50.0, _STEPS):
        moved = q_base + rng.normal(0.0, step, len(q_base))
        q = space.bases[end].nearest(moved[None])[0]
        g = genes.contain(grasp + rng.normal(0.0, step, len(grasp)) * genes.range)
        if score(end, q[None], g[None]).outcome[0] not in _COLLIDING:
            continue
        contacts = score.contacts(end, q, g)
        if contacts and contacts[0].depth < contact.depth:
            contact, q_base, grasp = contacts[0], q, g
    return NearMiss(
        end,
        contact.first,
        contact.second,
        contact.depth,
        tuple(q_base.tolist()),
        tuple(grasp.tolist()),
    )


def _nearest_limit(score: ScoreFunction, survey: Survey) -> NearMiss | None:
    """The configuration that is least beyond the joint limits, None if there is none.

    Only bases count that are free of collision, unless none of them is near enough.
    """
    beyond = survey.reach == Outcome.JOINT_LIMITS
    free = beyond & (survey.base == Outcome.SCORED)
    rows = np.flatnonzero(free if free.any() else beyond)
    if len(rows) == 0:
        return None
    q_base, grasps = survey.queries.q_base[rows], survey.queries.grasps[rows]
    arms = score.arms(survey.end, q_base, grasps)
    group = score.problem.robot.arm
    q = arms.q[..., group.indices]  # (n, branches, arm joints)
    excess = np.maximum(group.lower - q, q - group.upper)
    worst = np.where(arms.exists, excess.max(axis=2), np.inf)
    row, branch = np.unravel_index(int(np.argmin(worst)), worst.shape)
    joint = int(np.argmax(excess[row, branch]))
    return NearMiss(
        survey.end,
        group.names[joint],
        None,
        float(excess[row, branch, joint]),
        tuple(q_base[row].tolist()),
        tuple(grasps[row].tolist()),
    )
