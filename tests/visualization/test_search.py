"""The search that is run again for a plan: the same candidates, and what they are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mmplan.pipeline import after_task
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.visualization.search import Search, searches


@pytest.fixture(scope="module")
def found(problem: Problem, plan: Plan) -> list[Search]:
    return list(searches(problem, plan))


def test_the_plans_own_candidate_is_found_again(
    found: list[Search], plan: Plan
) -> None:
    assert [search.task for search in found] == [0, 1]
    for search, task in zip(found, plan.tasks, strict=True):
        (own,) = [c for c in search.candidates if "the plan's" in c.label]
        assert own.object == task.object
        for shown, end in zip(own.ends, (task.start, task.goal), strict=True):
            assert shown.breakdown.terms == pytest.approx(end.scores)
        assert own.total == pytest.approx(
            sum(task.start.scores.values()) + sum(task.goal.scores.values())
        )


def test_candidates_come_best_first(found: list[Search]) -> None:
    for search in found:
        totals = [c.total for c in search.candidates]
        assert totals == sorted(totals, reverse=True)


def test_the_lines_are_as_long_as_the_distances_that_are_scored(
    found: list[Search],
) -> None:
    for candidate in (c for search in found for c in search.candidates):
        for end in candidate.ends:
            nearest = {n.link: n for n in end.nearest}
            assert len(end.breakdown.links) > 5
            for link in end.breakdown.links:
                near = nearest[link.link]
                length = np.linalg.norm(near.on_link - near.on_obstacle)
                assert near.distance == pytest.approx(link.distance, abs=1e-5)
                assert length == pytest.approx(max(near.distance, 0.0), abs=1e-5)


def test_cycles_show_the_populations_of_both_ends(found: list[Search]) -> None:
    bases = 16  # of the scene's optimizer
    for search in found:
        first = search.cycles[0]
        assert [len(end.positions) for end in first.ends] == [bases, bases]
        for cycle in search.cycles:
            for end in cycle.ends:
                assert len(end.scores) == len(end.positions)
                assert (np.diff(end.scores) <= 0.0).all()
        last = search.cycles[-1].ends[0].scores.max()
        assert last >= search.cycles[0].ends[0].scores.max() - 1e-9


def test_a_plan_of_other_settings_is_shown_besides(
    problem: Problem, plan: Plan
) -> None:
    other = replace(
        problem, optimizer=replace(problem.optimizer, name="random", evaluations=200)
    )
    for search, task in zip(searches(other, plan), plan.tasks, strict=True):
        own = search.candidates[-1]
        assert own.label == "the plan's"
        assert own.ends[0].breakdown.terms == pytest.approx(task.start.scores)
        assert search.cycles[0].label == "part 1"


def test_a_search_can_be_ended(problem: Problem, plan: Plan) -> None:
    class EndedError(Exception):
        pass

    def end(_: int) -> None:
        raise EndedError

    with pytest.raises(EndedError):
        list(searches(problem, plan, end))


def test_a_task_leaves_its_object_at_the_goal_of_that_task(
    problem: Problem, plan: Plan
) -> None:
    second = replace(problem, tasks=problem.tasks[1:])
    left = after_task(second, plan.tasks[1])
    bottle = left.object("bottle").T_world_object
    assert np.array_equal(bottle, problem.tasks[1].T_world_goal)
    assert np.array_equal(left.q_start, plan.tasks[1].segments[-1].positions[-1])
