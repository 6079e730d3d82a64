"""The configuration that is beyond the joint limits by the least."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.explanation.near_miss import NearMiss
from mmplan.explanation.survey import Survey
from mmplan.optimizers import Queries
from mmplan.robot import Robot
from mmplan.scoring import Outcome, ScoreFunction
from mmplan.shapes import Array

_NEAREST, _NAMED = 20, 3  # configurations looked at, joints named


class _BeyondLimits(NamedTuple):
    """Pairs whose arm reaches beyond its limits alone, each at its best branch."""

    queries: Queries  # n of them
    q: Array  # (n, nq)
    excess: Array  # (n, arm joints), rad or m; negative within the limits


def nearest_limit(score: ScoreFunction, survey: Survey) -> NearMiss | None:
    """The configuration that is least beyond the limits, None if there is none."""
    queries, q, excess = _beyond_limits(score, survey)
    if len(q) == 0:
        return None
    row = int(np.argmin(excess.max(axis=1)))
    joint = int(np.argmax(excess[row]))
    robot = score.problem.robot
    name = robot.arm.names[joint]
    return NearMiss(
        end=survey.end,
        kind="slide" if slides(robot, name) else "turn",
        first=name,
        second=None,
        amount=float(excess[row, joint]),
        base=tuple(queries.q_base[row].tolist()),
        grasp=tuple(queries.grasps[row].tolist()),
        q=tuple(q[row].tolist()),
    )


def tightest_joints(score: ScoreFunction, survey: Survey) -> list[str]:
    """The joints that are most often beyond their limits where little is missing."""
    excess = _beyond_limits(score, survey).excess
    nearest = excess[np.argsort(excess.max(axis=1), kind="stable")[:_NEAREST]]
    often = np.count_nonzero(nearest > 0.0, axis=0)
    order = np.argsort(-often, kind="stable")[:_NAMED]
    return [score.problem.robot.arm.names[j] for j in order if often[j]]


def _beyond_limits(score: ScoreFunction, survey: Survey) -> _BeyondLimits:
    """Those of a survey, each in the branch whose greatest excess is the least.

    Only bases count that are free of collision, unless none of them is near enough.
    """
    beyond = survey.reach == Outcome.JOINT_LIMITS
    free = beyond & (survey.base == Outcome.SCORED)
    queries = survey.queries.take(free if free.any() else beyond)
    arms = score.arms(survey.end, queries.q_base, queries.grasps)
    group = score.problem.robot.arm
    q = arms.q[..., group.indices]  # (n, branches, arm joints)
    excess = np.maximum(group.lower - q, q - group.upper)
    worst = np.where(arms.exists, excess.max(axis=2), np.inf)
    rows: npt.NDArray[np.int64] = np.arange(len(worst))
    branch = worst.argmin(axis=1)
    return _BeyondLimits(queries, arms.q[rows, branch], excess[rows, branch])


def slides(robot: Robot, joint: str) -> bool:
    """Whether a joint is prismatic."""
    kind = robot.model.joints[robot.model.getJointId(joint)].shortname()
    return str(kind).startswith("JointModelP")
