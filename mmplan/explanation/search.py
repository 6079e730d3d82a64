"""A small search for candidates, and whether motions are free for them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mmplan.candidate import Candidate
from mmplan.explanation.settings import Setting
from mmplan.motion import Blocked, TaskMotion
from mmplan.optimizers import OPTIMIZERS, Optimization, Triple, optimize, search_space
from mmplan.pipeline import grasp_family
from mmplan.scoring import End, ScoreFunction

# Of all optimizers it finds a first candidate with the fewest evaluations.
_OPTIMIZER = "blockwise"


def setting_score(setting: Setting) -> ScoreFunction:
    """The score of a setting's task."""
    problem, world = setting
    _, family = grasp_family(problem.object(setting.task.object))
    return ScoreFunction(problem, setting.task, world, family)


def search(
    score: ScoreFunction, evaluations: int, rng: np.random.Generator, candidates: int
) -> Optimization:
    """Look for candidates with a budget of evaluations.

    Raises:
        NoPlanError: There is no room for the base.
    """
    settings = replace(score.problem.optimizer, evaluations=evaluations)
    optimizer = OPTIMIZERS[_OPTIMIZER](search_space(score), settings, rng)
    return optimize(score, optimizer, evaluations, candidates)


def blocked_line(score: ScoreFunction, triple: Triple) -> Blocked | None:
    """What stands in the way of a candidate's straight motions and of its hand.

    Straight motions may be left out where the scene does not insist on them.
    """
    return _motion(score).blocked_short(Candidate.of_triple(triple, score))


def blocked_motion(
    score: ScoreFunction, triple: Triple, rng: np.random.Generator
) -> Blocked | None:
    """What stands in the way of a candidate's whole motion, paths included."""
    motion = _motion(score).plan(Candidate.of_triple(triple, score), rng)
    return motion if isinstance(motion, Blocked) else None


def _motion(score: ScoreFunction) -> TaskMotion:
    world = score.worlds[End.START]
    return TaskMotion(score.problem, score.task, world, without_lines=True)
