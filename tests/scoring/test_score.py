"""Score(q_base, grasp) is the best of all feasible branches, and only that."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from mmplan.ik import InverseKinematics, Solutions
from mmplan.pipeline import score_function
from mmplan.problem import Problem, ScoreSettings
from mmplan.scoring import End, Grasped, Outcome, ScoreFunction, Scores
from mmplan.scoring.clutter import Clutter
from mmplan.scoring.manipulability import manipulability
from mmplan.shapes import Array
from tests.scoring.conftest import Evaluated


def same(a: Scores, b: Scores) -> bool:
    """Whether two answers are equal, bit for bit."""
    return all(np.array_equal(x, y, equal_nan=True) for x, y in zip(a, b, strict=True))


def rows_of(scores: Scores, rows: Array) -> Scores:
    return Scores(*(part[rows] for part in scores))


def some_rows(evaluated: Evaluated) -> Array:
    """A few rows of every outcome that there is."""
    outcomes = evaluated.scores.outcome
    return np.concatenate([np.flatnonzero(outcomes == o)[:8] for o in set(outcomes)])


def feasible_branches(
    score: ScoreFunction, end: End, q_base: Array, grasp: Array
) -> list[Array]:
    """The feasible solutions (nq,) for one base and grasp, one at a time."""
    world, name, robot = score.worlds[end], score.task.object, score.problem.robot
    hold = score.holds(grasp[None])
    T_world_tool = world.standing[name] @ hold.T_object_tool[0]
    T_base_tool = np.linalg.inv(robot.base_poses(q_base[None])[0]) @ T_world_tool
    solutions = robot.ik.solve(T_base_tool[None])
    found = []
    for q_arm in solutions.q[solutions.within]:
        opened, closed = robot.q_neutral.copy(), robot.q_neutral.copy()
        for q, hand in ((opened, hold.opened[0]), (closed, hold.closed[0])):
            q[robot.base.indices], q[robot.arm.indices] = q_base, q_arm
            q[robot.hand.indices] = hand
        touching = world.permit_touch(name, fingers=True)
        if not world.contacts(opened) and not touching.contacts(closed):
            found.append(closed)
    return found


def worth(score: ScoreFunction, end: End, q: Array) -> Array:
    """The raw terms (n, 3) of configurations (n, nq), nothing remembered."""
    name, robot = score.task.object, score.problem.robot
    clutter = Clutter(robot, {e: w.without(name) for e, w in score.worlds.items()})
    each = np.arange(len(q))
    T_world_tool = np.array([robot.tool_pose(row) for row in q])
    C = clutter(Grasped(end, q, each, each, T_world_tool))
    return np.stack([np.ones(len(q)), manipulability(robot, q), C], axis=1)


def test_the_score_is_the_best_of_all_feasible_branches(
    evaluated: Evaluated, kitchen: Problem
) -> None:
    end, q_base, grasps, scores = evaluated
    score, n = score_function(kitchen), 150
    branches = [feasible_branches(score, end, q_base[i], grasps[i]) for i in range(n)]
    counts = [len(found) for found in branches]
    assert max(counts) > 1
    q = np.array([one for found in branches for one in found])
    totals = worth(score, end, q) @ score.factors
    expected = np.zeros(n)
    np.maximum.at(expected, np.repeat(np.arange(n), counts), totals)
    np.testing.assert_allclose(scores.total[:n], expected, rtol=0, atol=1e-9)


def test_a_row_scores_the_same_alone_in_a_batch_and_again(
    evaluated: Evaluated, kitchen: Problem
) -> None:
    end, q_base, grasps, scores = evaluated
    fresh = score_function(kitchen)
    for row in some_rows(evaluated):
        expected = rows_of(scores, [row])
        one = slice(row, row + 1)
        assert same(fresh(end, q_base[one], grasps[one]), expected)
        assert same(fresh(end, q_base[one], grasps[one]), expected)


def test_the_order_of_a_batch_does_not_matter(
    evaluated: Evaluated, kitchen: Problem
) -> None:
    end, q_base, grasps, scores = evaluated
    order = np.random.default_rng(0).permutation(len(grasps))
    order = np.concatenate([order, order[:50]])  # some rows twice
    again = score_function(kitchen)(end, q_base[order], grasps[order])
    assert same(again, rows_of(scores, order))


def test_what_a_grasp_was_paired_with_before_does_not_matter(
    evaluated: Evaluated, kitchen: Problem
) -> None:
    good = np.flatnonzero(evaluated.scores.total > 0.0)[:8]
    q_base = np.repeat(evaluated.q_base[good], len(good), axis=0)
    grasps = np.tile(evaluated.grasps[good], (len(good), 1))
    forward = score_function(kitchen)(evaluated.end, q_base, grasps)
    backward = score_function(kitchen)(evaluated.end, q_base[::-1], grasps[::-1])
    assert np.count_nonzero(forward.total) > len(good)
    assert same(forward, rows_of(backward, slice(None, None, -1)))


def test_the_best_configuration_reaches_the_grasp_from_the_base(
    evaluated: Evaluated, kitchen_score: ScoreFunction
) -> None:
    end, q_base, grasps, scores = evaluated
    robot, world = kitchen_score.problem.robot, kitchen_score.worlds[end]
    hold = kitchen_score.holds(grasps)
    for row in np.flatnonzero(scores.total > 0.0):
        q = scores.q[row]
        T_world_tool = world.standing["wineglass"] @ hold.T_object_tool[row]
        np.testing.assert_allclose(robot.tool_pose(q), T_world_tool, atol=1e-9)
        assert np.array_equal(q[robot.base.indices], q_base[row])
        assert np.array_equal(q[robot.hand.indices], hold.closed[row])
        arm = q[robot.arm.indices]
        assert np.all((arm >= robot.arm.lower) & (arm <= robot.arm.upper))


def test_terms_add_up_and_are_zero_where_nothing_is_feasible(
    evaluated: Evaluated,
) -> None:
    total, terms, q, outcome = evaluated.scores
    scored = outcome == Outcome.SCORED
    assert scored.any()
    assert not scored.all()
    np.testing.assert_allclose(terms.sum(axis=1), total, atol=1e-12)
    assert np.array_equal(total > 0.0, scored)
    assert np.array_equal(np.isfinite(q).all(axis=1), scored)
    assert np.array_equal(np.isnan(q).all(axis=1), ~scored)
    assert not terms[~scored].any()


@pytest.mark.parametrize("weights", [(1.0, 0.0, 0.0), (0.5, 2.0, 3.0), (0, 0, 1)])
def test_weights_scale_the_terms(
    weights: tuple[float, float, float], evaluated: Evaluated, kitchen: Problem
) -> None:
    end, q_base, grasps, scores = evaluated
    rows = np.flatnonzero(scores.total > 0.0)[:10]
    score = score_function(replace(kitchen, score=ScoreSettings(*weights)))
    weighted = score(end, q_base[rows], grasps[rows])
    scales = kitchen.robot.score_scales
    to_scale = worth(score, end, weighted.q) / [
        1.0,
        scales.manipulability,
        scales.clutter,
    ]
    expected = 50.0 * np.array(weights) * to_scale
    np.testing.assert_allclose(weighted.terms, expected, rtol=0, atol=1e-9)


@dataclass(frozen=True)
class ManyBranches:
    """A solver that finds each solution many times, in another order each time."""

    solver: InverseKinematics
    times: int
    complete: bool = True
    explanation: str = "many times the same"

    def solve(self, T_base_tool: Array) -> Solutions:
        found = self.solver.solve(T_base_tool)
        b = found.exists.shape[1]
        order = [np.roll(np.arange(b), turn) for turn in range(self.times)]
        places = np.concatenate(order)
        return Solutions(
            found.q[:, places], found.exists[:, places], found.within[:, places]
        )


def test_many_branches_score_as_the_best_of_them(
    evaluated: Evaluated, kitchen: Problem
) -> None:
    end, q_base, grasps, scores = evaluated
    robot = kitchen.robot
    many = replace(robot, ik=ManyBranches(robot.ik, 40))
    score = score_function(replace(kitchen, robot=many))
    rows = some_rows(evaluated)
    found = score(end, q_base[rows], grasps[rows])
    np.testing.assert_array_equal(found.outcome, scores.outcome[rows])
    np.testing.assert_array_equal(found.total, scores.total[rows])
