"""Terms of one's own count as the others do, and faulty ones are told."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from mmplan.optimizers import search_space
from mmplan.pipeline import score_function
from mmplan.problem import WeightedTerm
from mmplan.scoring import End, Grasped, Outcome, ScoreFunction, Scores
from mmplan.shapes import Array
from tests.tabletop import cup_problem


def scored(*more: WeightedTerm) -> tuple[ScoreFunction, Scores]:
    """The same 200 pairs with terms of one's own."""
    problem = cup_problem()
    settings = replace(problem.score, more=more)
    score = score_function(replace(problem, score=settings))
    rng = np.random.default_rng(0)
    space = search_space(score)
    bases = space.bases[End.START]
    q_base = bases.q_base(bases.sample(200, rng))
    return score, score(End.START, q_base, space.grasps.sample(200, rng))


def constant(value: float) -> Callable[[Grasped], Array]:
    return lambda grasped: np.full(len(grasped.q), value)


def test_a_constant_term_adds_its_points_where_there_is_a_score() -> None:
    _, before = scored()
    score, after = scored(WeightedTerm("constant", constant(0.5), 2.0))
    feasible = before.outcome == Outcome.SCORED
    assert feasible.any()
    assert score.terms[-1] == "constant"
    assert np.array_equal(before.outcome, after.outcome)
    assert np.allclose(after.total[feasible] - before.total[feasible], 50.0)
    assert np.allclose(after.terms[feasible, -1], 50.0)
    assert np.array_equal(after.total[~feasible], before.total[~feasible])


def test_the_branch_is_chosen_with_the_term() -> None:
    """Where the term outweighs all else, no branch that was taken before beats it."""

    def low_elbow(grasped: Grasped) -> Array:
        return 1.0 - np.sin(grasped.q[:, 3])

    _, before = scored()
    _, after = scored(WeightedTerm("elbow", low_elbow, 1000.0))
    feasible = before.outcome == Outcome.SCORED
    old, new = (-np.sin(s.q[feasible, 3]) for s in (before, after))
    assert np.all(new >= old - 1e-12)
    assert np.any(new > old + 1e-6)
    assert np.allclose(after.total, after.terms.sum(axis=1))


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
def test_a_value_that_no_score_can_have_is_refused(value: float) -> None:
    with pytest.raises(ValueError, match="a value of this term is negative or not"):
        scored(WeightedTerm("bad", constant(value)))
