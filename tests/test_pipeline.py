"""Problems are solved from end to end, and what cannot be solved is accounted for."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import mmplan
from mmplan import pipeline
from mmplan.exceptions import NoPlanError, VerificationError
from mmplan.grasps import Axis
from mmplan.plan import Plan
from mmplan.problem import Object, OptimizerSettings, PlannerSettings, Problem
from mmplan.shapes import Array, Box
from mmplan.verification import examine
from mmplan.verification_report import Fault, VerificationReport
from tests.honest import shift
from tests.tabletop import cup_problem, two_tasks, walled_in

SEGMENTS = [
    "transit",
    "approach",
    "grasp",
    "lift",
    "transfer",
    "lower",
    "release",
    "retreat",
]


def names(plan: Plan, task: int = 0) -> list[str]:
    return [segment.name for segment in plan.tasks[task].segments]


def with_lengths(problem: Problem, **lengths: float) -> Problem:
    """The problem with straight tool motions of given lengths in all tasks."""
    return replace(problem, tasks=tuple(replace(t, **lengths) for t in problem.tasks))


@pytest.fixture(scope="module")
def both_tasks() -> Plan:
    return mmplan.solve(two_tasks(), seed=0)


def test_edges_of_several_lengths_lead_out_of_a_crowded_shelf() -> None:
    problem = mmplan.load_problem(Path(__file__).parent / "scenes/crowded_shelf.yaml")
    assert mmplan.verify(mmplan.solve(problem, seed=4), problem).ok
    long = replace(problem.planner, range=1.5, candidates=1)
    error = failure(replace(problem, planner=long), seed=4)
    assert "failed on the way: transfer (1)" in str(error)


@pytest.mark.parametrize("name", ["wineglass", "plate"])
def test_the_shipped_scenes_are_solved(name: str) -> None:
    problem = mmplan.load_problem(name)
    quick = replace(problem, optimizer=replace(problem.optimizer, evaluations=2500))
    plan = mmplan.solve(quick, seed=0)
    assert names(plan) == SEGMENTS
    assert mmplan.verify(plan, mmplan.load_problem(name)).ok


def test_two_tasks_are_solved_and_proven_as_a_whole(both_tasks: Plan) -> None:
    problem = two_tasks()
    assert [task.object for task in both_tasks.tasks] == ["cup", "bottle"]
    report = mmplan.verify(both_tasks, problem)
    assert report == both_tasks.verification


def test_the_robot_goes_on_from_where_it_is(both_tasks: Plan) -> None:
    segments = [s for task in both_tasks.tasks for s in task.segments]
    assert np.array_equal(segments[0].positions[0], two_tasks().q_start)
    for before, after in pairwise(segments):
        np.testing.assert_allclose(
            after.positions[0], before.positions[-1], rtol=0, atol=1e-12
        )


def test_objects_end_where_they_are_wanted(both_tasks: Plan) -> None:
    final = both_tasks.tasks[-1].segments[-1].objects
    for task in two_tasks().tasks:
        np.testing.assert_allclose(final[task.object], task.T_world_goal, atol=1e-6)


def test_one_object_can_be_moved_twice() -> None:
    problem = cup_problem()
    (task,) = problem.tasks
    back = replace(task, T_world_goal=problem.object("cup").T_world_object)
    there_and_back = replace(problem, tasks=(task, back))
    plan = mmplan.solve(there_and_back, seed=1)
    assert mmplan.verify(plan, there_and_back).ok
    np.testing.assert_allclose(
        plan.tasks[1].segments[-1].objects["cup"], back.T_world_goal, atol=1e-6
    )


def test_every_task_has_random_numbers_of_its_own() -> None:
    one, other = pipeline.task_generators(two_tasks(), seed=3)
    again, _ = pipeline.task_generators(two_tasks(), seed=3)
    drawn = one.random()
    assert drawn == again.random()
    assert drawn != other.random()


def test_the_same_seed_gives_the_same_plan_and_another_one_another() -> None:
    one, again, other = (mmplan.solve(cup_problem(), seed=s) for s in (4, 4, 5))
    for a, b in zip(one.tasks[0].segments, again.tasks[0].segments, strict=True):
        assert np.array_equal(a.times, b.times)
        assert np.array_equal(a.positions, b.positions)
        assert np.array_equal(a.velocities, b.velocities)
    assert not np.array_equal(one.tasks[0].genes, other.tasks[0].genes)


def test_lengths_of_zero_give_the_papers_two_paths() -> None:
    problem = with_lengths(
        cup_problem(), approach=0.0, lift=0.0, lower=0.0, retreat=0.0
    )
    plan = mmplan.solve(problem, seed=0)
    assert names(plan) == ["transit", "grasp", "transfer", "release"]
    assert mmplan.verify(plan, problem).ok


def test_a_length_that_is_given_is_kept_to_the_letter() -> None:
    problem = with_lengths(cup_problem(), approach=0.07, lift=0.04)
    plan = mmplan.solve(problem, seed=0)
    segments = {s.name: s for s in plan.tasks[0].segments}
    tool = problem.robot.tool_pose
    for name, axis, length in (("approach", None, 0.07), ("lift", (0, 0, 1), 0.04)):
        q = segments[name].positions
        way = tool(q[-1])[:3, 3] - tool(q[0])[:3, 3]
        direction = tool(q[0])[:3, 2] if axis is None else np.array(axis)
        np.testing.assert_allclose(way, length * direction, atol=1e-6)


def test_a_plan_names_the_grasp_family_that_it_uses(both_tasks: Plan) -> None:
    task = both_tasks.tasks[1]
    grasps = two_tasks().object("bottle").grasps
    assert set(grasps) == {"low", "high"}
    family = grasps[task.grasp]
    assert isinstance(family, Axis)
    low, high = family.along
    assert low <= task.T_object_tool[2, 3] <= high


def with_grasps(problem: Problem, **grasps: tuple[float, float]) -> Problem:
    """The problem with other grasps of the first task's object."""
    families = {name: Axis(along) for name, along in grasps.items()}

    def changed(item: Object) -> Object:
        own = item.name == problem.tasks[0].object
        return replace(item, grasps=families) if own else item

    return replace(problem, objects=tuple(changed(item) for item in problem.objects))


def test_a_family_that_cannot_work_is_left_aside() -> None:
    plan = mmplan.solve(
        with_grasps(cup_problem(), in_table=(-0.08, -0.075), side=(0.0, 0.05)), seed=0
    )
    assert plan.tasks[0].grasp == "side"


def failure(problem: Problem, seed: int = 0) -> NoPlanError:
    with pytest.raises(NoPlanError) as caught:
        mmplan.solve(problem, seed=seed)
    return caught.value


@pytest.mark.parametrize(
    ("grasps", "reason"),
    [
        ({"bowl": (0.13, 0.2)}, "no grasp works at the goal"),
        ({"foot": (0.02, 0.025)}, "no grasp works at the start"),
        (
            {"foot": (0.02, 0.025), "bowl": (0.13, 0.2)},
            "no single grasp works at both ends",
        ),
        ({"nothing": (0.3, 0.4)}, "no grasp works at either end"),
    ],
)
def test_the_reason_is_which_end_no_grasp_serves(
    grasps: dict[str, tuple[float, float]], reason: str
) -> None:
    problem = with_grasps(mmplan.load_problem("wineglass"), **grasps)
    settings = OptimizerSettings(evaluations=1200)
    error = failure(replace(problem, optimizer=settings))
    assert error.report is not None
    assert error.report.reason == reason
    assert str(error).startswith(f"task 1 (wineglass): {reason}\n")


def test_a_robot_that_cannot_get_out_is_told_as_such() -> None:
    planner = PlannerSettings(iterations=60, candidates=2)
    error = failure(replace(walled_in(), planner=planner))
    assert error.report is not None
    assert error.report.reason == "all 2 candidates failed on the way: transit (2)"
    for attempt in error.report.attempts:
        assert attempt.blocked.segment == "transit"
        assert "left to go" in attempt.blocked.message
        assert attempt.blocked.message in str(error)


def test_no_room_for_the_base_names_the_place() -> None:
    bounds = np.array([[-1.1, -0.9], [-0.1, 0.1]])  # the cup is out of reach
    error = failure(replace(cup_problem(), base_bounds=bounds))
    assert "no room for the base within reach of (0.400, 0.500)" in str(error)


def test_the_second_task_is_named_where_it_fails() -> None:
    problem = two_tasks()
    first, second = problem.tasks
    unreachable = replace(second, T_world_goal=shift(0.4, 0.5, 2.5))
    error = failure(replace(problem, tasks=(first, unreachable)))
    assert error.report is not None
    assert (error.report.task, error.report.object) == (1, "bottle")
    assert str(error).startswith("task 2 (bottle): no grasp works at the goal\n")


REFUSED = VerificationReport((Fault("collision", "made up"),), None, 0.0, 0, 0)


def refuse_first(n: int) -> Callable[[Plan, Problem], VerificationReport]:
    """An `examine` that refuses the first n plans."""
    verdicts: Iterator[VerificationReport | None] = iter([REFUSED] * n)

    def verdict(plan: Plan, problem: Problem) -> VerificationReport:
        return next(verdicts, None) or examine(plan, problem)

    return verdict


def test_a_plan_that_cannot_be_proven_gives_way_to_the_next_candidate(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = mmplan.solve(cup_problem(), seed=0)
    monkeypatch.setattr(pipeline, "examine", refuse_first(1))
    second = mmplan.solve(cup_problem(), seed=0)
    assert second.verification is not None
    assert second.verification.ok
    assert total(second) < total(first)


def total(plan: Plan) -> float:
    ends = plan.tasks[0].start, plan.tasks[0].goal
    return sum(sum(end.scores.values()) for end in ends)


def test_nothing_unproven_is_delivered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pipeline, "examine", refuse_first(1000))
    planner = PlannerSettings(candidates=2)
    report = failure(replace(cup_problem(), planner=planner)).report
    assert report is not None
    assert report.reason == "all 2 candidates failed on the way: verification (2)"
    assert [a.blocked.message for a in report.attempts] == ["made up"] * 2


def test_tasks_must_be_proven_in_a_row_too(monkeypatch: pytest.MonkeyPatch) -> None:
    def verdict(plan: Plan, problem: Problem) -> VerificationReport:
        return examine(plan, problem) if len(plan.tasks) == 1 else REFUSED

    monkeypatch.setattr(pipeline, "examine", verdict)
    with pytest.raises(VerificationError, match="made up"):
        mmplan.solve(two_tasks(), seed=0)


def test_progress_goes_through_the_stages() -> None:
    told: list[tuple[str, int, int | None]] = []
    mmplan.solve(cup_problem(), progress=lambda *step: told.append(step))
    stages = [what for what, _, _ in told]
    assert list(dict.fromkeys(stages)) == ["optimization", "planning"]
    spent = [done for what, done, _ in told if what == "optimization"]
    assert spent == sorted(spent)
    assert spent[-1] == 600
    assert {of for what, _, of in told if what == "optimization"} == {600}


def test_a_scene_with_nothing_but_a_floor(tmp_path: Path) -> None:
    problem = cup_problem()
    floor = tuple(o for o in problem.obstacles if o.ground)
    cup = replace(problem.object("cup"), shape=Box((0.06, 0.06, 0.8)))
    bare = replace(
        problem,
        obstacles=floor,
        objects=(replace(cup, T_world_object=shift(0.4, 0.5, 0.4)),),
        tasks=(replace(problem.tasks[0], T_world_goal=shift(0.4, 0.0, 0.4)),),
    )
    problem = with_grasps(bare, upper=(0.2, 0.37))
    plan = mmplan.solve(problem, seed=0)
    assert finite([end.scores for end in (plan.tasks[0].start, plan.tasks[0].goal)])
    plan.save(tmp_path / "plan.json")
    assert mmplan.verify(Plan.load(tmp_path / "plan.json"), problem).ok


def finite(scores: list[dict[str, float]]) -> bool:
    values: Array = np.array([list(end.values()) for end in scores])
    json.dumps(values.tolist(), allow_nan=False)
    return bool(np.isfinite(values).all())
