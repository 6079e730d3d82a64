"""Which generated problems are kept: those that were seen to have a solution.

Pinocchio, coal and OMPL are imported in the functions, so that a faulty argument of
`generate` is reported at once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from mmplan.exceptions import NoPlanError, VerificationError
from mmplan.problem import Problem

if TYPE_CHECKING:
    from mmplan.scoring import ScoreFunction

Acceptance: TypeAlias = Callable[[Problem], bool]

# Optimizer, score evaluations and seed of each search for a candidate, cheapest first.
SEARCHES = (
    ("random", 600, 0),
    ("coevolution", 2000, 0),
    ("coevolution", 6940, 1),
    ("coevolution", 6940, 2),
)


def has_candidate(problem: Problem) -> bool:
    """Whether a search finds bases and a grasp that score above 0 at both ends."""
    from mmplan.pipeline import score_function

    score = score_function(problem)
    try:
        return any(_found(score, *search) for search in SEARCHES)
    except NoPlanError:  # no room for the base
        return False


def found_by(problem: Problem, name: str, evaluations: int, seed: int) -> bool:
    """Whether one optimizer finds them within a budget of score evaluations.

    Raises:
        NoPlanError: There is no room for the base.
    """
    from mmplan.pipeline import score_function

    return _found(score_function(problem), name, evaluations, seed)


def has_plan(problem: Problem) -> bool:
    """Whether `solve` finds a verified plan, with its defaults and seed 0."""
    from mmplan.pipeline import solve

    if not has_candidate(problem):
        return False
    try:
        solve(problem)
    except (NoPlanError, VerificationError):
        return False
    return True


def _found(score: ScoreFunction, name: str, evaluations: int, seed: int) -> bool:
    from mmplan.optimizers import OPTIMIZERS, optimize, search_space

    settings = replace(score.problem.optimizer, name=name, evaluations=evaluations)
    rng = np.random.default_rng(seed)
    optimizer = OPTIMIZERS[name](search_space(score), settings, rng)
    return bool(optimize(score, optimizer, evaluations, 1).candidates)
