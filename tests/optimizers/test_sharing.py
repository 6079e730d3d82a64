"""Two processes find what one finds, to the last bit."""

from __future__ import annotations

import multiprocessing
from dataclasses import replace

import numpy as np
import pytest

import mmplan
from mmplan.optimizers import OPTIMIZERS, Optimization, optimize, search_space
from mmplan.pipeline import score_function
from mmplan.problem import Problem, WeightedTerm
from mmplan.scoring import End, ScoreFunction
from mmplan.scoring.term import Grasped
from mmplan.shapes import Array
from tests.tabletop import cup_problem

BUDGET = 1500

pytestmark = pytest.mark.skipif(
    "fork" not in multiprocessing.get_all_start_methods(),
    reason="processes cannot be forked here",
)


def found(problem: Problem, name: str, jobs: int) -> tuple[Optimization, ScoreFunction]:
    score = score_function(problem)
    settings = replace(problem.optimizer, name=name, evaluations=BUDGET)
    rng = np.random.default_rng(5)
    optimizer = OPTIMIZERS[name](search_space(score), settings, rng)
    return optimize(score, optimizer, BUDGET, 10, jobs=jobs), score


@pytest.mark.parametrize("name", ["coevolution", "random", "blockwise"])
def test_the_same_is_found(name: str) -> None:
    (one, alone), (other, helped) = (found(cup_problem(), name, n) for n in (1, 2))
    assert np.array_equal(one.history, other.history)
    assert np.array_equal(one.outcomes, other.outcomes)
    assert np.array_equal(one.evaluated.q_base, other.evaluated.q_base)
    assert np.array_equal(one.evaluated.grasps, other.evaluated.grasps)
    assert len(one.candidates) == len(other.candidates) > 0
    for a, b in zip(one.candidates, other.candidates, strict=True):
        assert a.scores == b.scores
        q = [
            score(End.GOAL, a.q_base[End.GOAL][None], a.grasp[None])
            for score in (alone, helped)
        ]
        assert np.array_equal(q[0].q, q[1].q)
        assert np.array_equal(q[0].terms, q[1].terms)


def test_plans_are_the_same() -> None:
    problem = mmplan.load_problem("mug")
    quick = replace(problem, optimizer=replace(problem.optimizer, evaluations=1500))
    one, other = (mmplan.solve(quick, seed=1, jobs=jobs) for jobs in (1, 2))
    for a, b in zip(one.tasks[0].segments, other.tasks[0].segments, strict=True):
        assert np.array_equal(a.times, b.times)
        assert np.array_equal(a.positions, b.positions)


def only_at_the_start(grasped: Grasped) -> Array:
    """A term of somebody's own that is faulty at the goal."""
    if grasped.end == End.GOAL:
        raise ZeroDivisionError("no such thing at the goal")
    return np.ones(len(grasped.q))


def test_what_a_term_raises_comes_through() -> None:
    problem = cup_problem()
    term = WeightedTerm("mine", only_at_the_start, 1.0)
    problem = replace(problem, score=replace(problem.score, more=(term,)))
    with pytest.raises(ZeroDivisionError, match="no such thing at the goal"):
        found(problem, "coevolution", 2)
    assert not multiprocessing.active_children()
