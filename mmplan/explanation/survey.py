"""Pairs of base and grasp drawn at random at one end of a task, and what they meet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mmplan.optimizers import Queries, SearchSpace
from mmplan.scoring import End, Outcome, ScoreFunction
from mmplan.shapes import Array

_FEW = 0.1  # share of the annulus within bounds below which more is drawn
_SLACK = 0.3  # m, about as far as offsets take a base beyond the annulus

Outcomes = npt.NDArray[np.int8]


@dataclass(frozen=True, eq=False)
class Survey:
    """n pairs at one end; every one is followed as far as it gets.

    `reach` is what the arm alone could do, whatever is in the way: NO_IK, JOINT_LIMITS
    or SCORED. `near` says whether the grasp is within the stretched arm's reach.
    """

    end: End
    queries: Queries
    outcome: Outcomes  # (n,) of Outcome
    base: Outcomes  # (n,) of Outcome: what is known of the base alone
    reach: Outcomes  # (n,) of Outcome
    near: npt.NDArray[np.bool_]  # (n,)
    holds: Outcomes  # (n,) of Outcome: how the hand holds the object

    def __len__(self) -> int:
        """The number of pairs."""
        return len(self.outcome)


def survey(
    score: ScoreFunction,
    end: End,
    space: SearchSpace,
    n: int,
    rng: np.random.Generator,
) -> Survey:
    """Draw n pairs: bases over the annulus about the object, grasps over their bounds.

    Where nearly all of the annulus is out of bounds, up to n more are drawn within
    them.
    """
    q_base = _bases(score, end, space, n, rng)
    grasps = space.grasps.sample(len(q_base), rng)
    return Survey(
        end=end,
        queries=Queries(np.full(len(q_base), end, np.int8), q_base, grasps),
        outcome=score(end, q_base, grasps).outcome,
        base=score.base_outcomes(end, q_base),
        reach=score.arms(end, q_base, grasps).outcome,
        near=_near(score, end, q_base, grasps),
        holds=score.holds(grasps).outcome,
    )


def is_reached(
    score: ScoreFunction,
    end: End,
    space: SearchSpace,
    n: int,
    rng: np.random.Generator,
) -> bool:
    """Whether the arm reaches one of n grasps from a base that is free."""
    q_base = _bases(score, end, space, n, rng)
    grasps = space.grasps.sample(len(q_base), rng)
    free = score.base_outcomes(end, q_base) == Outcome.SCORED
    reach = score.arms(end, q_base[free], grasps[free]).outcome
    return bool(np.any(reach == Outcome.SCORED))


def _bases(
    score: ScoreFunction,
    end: End,
    space: SearchSpace,
    n: int,
    rng: np.random.Generator,
) -> Array:
    """Bases (n or more, b), enough of them within their bounds."""
    placements = space.bases[end]
    drawn = placements.q_base(placements.genes.sample(n, rng))
    inside = score.base_outcomes(end, drawn) != Outcome.OUT_OF_BOUNDS
    if inside.mean() > _FEW:
        return drawn
    span = score.problem.robot.reach + _SLACK
    return np.concatenate([drawn, bases_about(score, end, span, n, rng)])


def bases_about(
    score: ScoreFunction, end: End, span: float, n: int, rng: np.random.Generator
) -> Array:
    """Bases (n, b) uniform in that part of their bounds that is about the object.

    That is within a distance `span` (m) along x and y; none if that is empty.
    """
    low, high = score.problem.base_bounds.T
    if len(low) == 0:  # a base without joints has one placement
        return np.empty((n, 0))
    centre = score.centre_of_mass(end)[:2]
    low, high = np.maximum(low, -np.pi), np.minimum(high, np.pi)
    low[:2] = np.maximum(score.problem.base_bounds[:2, 0], centre - span)
    high[:2] = np.minimum(score.problem.base_bounds[:2, 1], centre + span)
    if np.any(low > high):
        return np.empty((0, len(low)))
    return rng.uniform(low, high, (n, len(low)))


def _near(
    score: ScoreFunction, end: End, q_base: Array, grasps: Array
) -> npt.NDArray[np.bool_]:
    """Whether the tool is no farther from the base, seen from above, than it gets."""
    robot = score.problem.robot
    T_world_object = score.worlds[end].standing[score.task.object]
    tool = (T_world_object @ score.family.tool_poses(grasps))[:, :2, 3]
    base = robot.base_poses(q_base)[:, :2, 3]
    near: npt.NDArray[np.bool_] = np.linalg.norm(tool - base, axis=1) <= robot.reach
    return near
