"""Several candidates are goals of one search."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import mmplan
from mmplan import pipeline
from mmplan.candidate import Candidate
from mmplan.exceptions import NoPlanError
from mmplan.motion import Blocked, TaskMotion, task_motion
from mmplan.motion.ways import Way, WayFinder
from mmplan.optimizers import Optimization
from mmplan.planning import PlanningWorld
from mmplan.problem import PlannerSettings, Problem
from mmplan.scoring import End, ScoreFunction
from mmplan.shapes import Array
from tests.tabletop import cup_problem, walled_in

GOALS = 6


@cache
def optimized() -> tuple[ScoreFunction, Optimization]:
    """The score of a problem, and what its optimizer found."""
    score = pipeline.score_function(cup_problem())
    rng = np.random.default_rng(0)
    return score, pipeline._optimize(score, rng, pipeline._ignore)


def found() -> list[Candidate]:
    score, search = optimized()
    return [Candidate.of_triple(t, score) for t in search.candidates[:GOALS]]


def motion() -> TaskMotion:
    score, _ = optimized()
    return TaskMotion(score.problem, score.task, score.worlds[End.START])


def test_each_candidate_has_one_outcome() -> None:
    rng = np.random.default_rng(1)
    outcomes = list(motion().plan_together(found(), rng))
    assert sorted(number for number, _ in outcomes) == list(range(len(found())))
    moved = [(k, o) for k, o in outcomes if not isinstance(o, Blocked)]
    assert len(moved) > 1
    for number, segments in moved:
        approach = next(s for s in segments if s.name == "grasp")
        base = cup_problem().robot.base.indices
        np.testing.assert_allclose(
            approach.positions[0, base], found()[number].q[End.START][base], atol=1e-9
        )


def test_one_search_looks_for_all(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    find = WayFinder.find

    def counted(
        self: WayFinder, q_start: Array, q_goals: Array, rng: np.random.Generator
    ) -> Way:
        asked.append(len(q_goals))
        return find(self, q_start, q_goals, rng)

    monkeypatch.setattr(WayFinder, "find", counted)
    together = motion().plan_together(found(), np.random.default_rng(1))
    first = next(k for k, outcome in together if not isinstance(outcome, Blocked))
    assert max(asked) > 1
    alone = motion().plan(found()[first], np.random.default_rng(1))
    assert not isinstance(alone, Blocked)


def test_one_goal_alone_is_as_it_was() -> None:
    """The candidates' order counts, and random numbers are drawn as for one."""
    (number, together), *_ = motion().plan_together(
        found()[:1], np.random.default_rng(3)
    )
    alone = motion().plan(found()[0], np.random.default_rng(3))
    assert number == 0
    assert not isinstance(together, Blocked)
    assert not isinstance(alone, Blocked)
    for a, b in zip(together, alone, strict=True):
        assert np.array_equal(a.positions, b.positions)


def test_worlds_with_other_rules_are_looked_at_apart(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def never(first: PlanningWorld, second: PlanningWorld) -> bool:
        return first is second

    monkeypatch.setattr(task_motion, "are_alike", never)
    outcomes = motion().plan_together(found(), np.random.default_rng(1))
    numbers = [number for number, _ in outcomes]
    assert numbers == sorted(numbers)  # nobody overtakes


def with_goals(problem: Problem) -> Problem:
    planner = PlannerSettings(goals=GOALS, iterations=400, candidates=4)
    return replace(problem, planner=planner)


def test_a_plan_with_goals_together_is_proven_and_repeats() -> None:
    problem = with_goals(cup_problem())
    plan, again = (mmplan.solve(problem, seed=2) for _ in range(2))
    assert mmplan.verify(plan, cup_problem()).ok
    for a, b in zip(plan.tasks[0].segments, again.tasks[0].segments, strict=True):
        assert np.array_equal(a.positions, b.positions)


def test_all_that_cannot_be_reached_are_accounted_for() -> None:
    with pytest.raises(NoPlanError) as caught:
        mmplan.solve(with_goals(walled_in()), seed=0)
    assert caught.value.report is not None
    assert caught.value.report.reason == (
        "all 4 candidates failed on the way: transit (4)"
    )


@pytest.mark.parametrize("goals", [1, 3])
def test_only_lines_that_were_in_the_way_are_left_out(
    goals: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Who fails at a straight line has a second chance, others have none."""
    score, search = optimized()
    tried: list[tuple[bool, tuple[float, ...]]] = []
    ends = ["approach", "lift", "transfer"]
    grasps = [tuple(triple.grasp) for triple in search.candidates]

    def failing(
        self: TaskMotion, candidates: Iterable[Candidate], _: np.random.Generator
    ) -> Iterator[tuple[int, Blocked]]:
        for k, candidate in reversed(list(enumerate(candidates))):
            grasp = tuple(candidate.triple.grasp)
            tried.append((self.without_lines, grasp))
            again = " again" if self.without_lines else ""
            yield k, Blocked(ends[grasps.index(grasp)], f"no{again}")

    monkeypatch.setattr(TaskMotion, "plan_together", failing)
    monkeypatch.setattr(TaskMotion, "plan_in_turn", failing)
    task = replace(score.task, lift=0.1)  # on which the scene insists
    planner = replace(score.problem.planner, goals=goals)
    problem = replace(score.problem, tasks=(task,), planner=planner)
    asked = pipeline.score_function(problem)
    some = replace(search, candidates=search.candidates[:3])
    plan, attempts = pipeline.plan_candidates(asked, some, 0, np.random.default_rng(0))
    assert plan is None
    assert [a.blocked.segment for a in attempts] == ends
    assert [a.blocked.message for a in attempts] == ["no again", "no", "no"]
    assert sorted(tried[:3]) == sorted((False, grasp) for grasp in grasps[:3])
    assert tried[3:] == [(True, grasps[0])]
