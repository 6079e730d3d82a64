"""One run: the same numbers as without a stopwatch, whenever it is done."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mmplan.benchmarking.benchmark import make_job
from mmplan.benchmarking.records import PLANNING, STAGES, Job
from mmplan.benchmarking.runs import run
from mmplan.exceptions import InputError, NoPlanError
from mmplan.optimizers import OPTIMIZERS, CoEvolution, optimize, search_space
from mmplan.pipeline import score_function, solve, task_generators
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from tests.benchmarking.made import contest_scene
from tests.optimizers.analytic import INSTALLED

BUDGET = 300


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return load_problem(contest_scene(tmp_path_factory.mktemp("scene")))


def job(
    problem: Problem, name: str = "coevolution", seed: int = 1, planner: str = ""
) -> Job:
    return make_job(problem, BUDGET, name, OPTIMIZERS[name], planner, seed)


@pytest.mark.parametrize("name", sorted(INSTALLED))
def test_the_stopwatch_does_not_change_the_numbers(problem: Problem, name: str) -> None:
    settings = replace(problem.optimizer, name=name, evaluations=BUDGET)
    plain = replace(problem, optimizer=settings)
    score = score_function(plain)
    rng = task_generators(plain, 1)[0]
    optimizer = OPTIMIZERS[name](search_space(score), settings, rng)
    found = optimize(score, optimizer, BUDGET, problem.planner.candidates)
    record = run(job(problem, name))
    assert record.success
    assert record.score == found.candidates[0].total
    assert record.history == found.history.tolist()
    assert record.genes == found.candidates[0].grasp.tolist()
    assert [end["base"] for end in record.ends.values()] == [
        q.tolist() for q in found.candidates[0].q_base
    ]


def test_a_record_is_consistent(problem: Problem) -> None:
    record = run(job(problem))
    ends = [sum(end["score"].values()) for end in record.ends.values()]
    assert sum(ends) == pytest.approx(record.score, rel=1e-12)
    assert record.used == BUDGET == record.history[-1][0]
    assert record.history[-1][1] >= record.score
    assert sum(n for end in record.outcomes.values() for n in end.values()) == BUDGET
    assert len(record.seconds) == len(record.history)
    assert record.label == "CoEvolution"
    assert record.key == job(problem).key


def test_time_goes_to_stages_and_nowhere_else(problem: Problem) -> None:
    record = run(job(problem))
    assert set(record.times) == set(STAGES) - {PLANNING}
    assert all(t["cpu"] > 0.0 and t["wall"] > 0.0 for t in record.times.values())
    # The last score is known just before the end of the search.
    wall = sum(t["wall"] for t in record.times.values())
    assert record.seconds[-1] <= wall <= record.seconds[-1] + 0.5


def test_runs_do_not_depend_on_those_before(problem: Problem) -> None:
    first = run(job(problem))
    other = run(job(problem, "random", seed=2))
    assert other.result != first.result
    assert run(job(problem)).result == first.result


def test_a_planned_run_is_what_solve_gives_for_its_seed(problem: Problem) -> None:
    record = run(job(problem, planner="RRTConnect"))
    settings = replace(problem.optimizer, evaluations=BUDGET)
    plan = solve(replace(problem, optimizer=settings), seed=1)
    task = plan.tasks[0]
    assert record.plan is not None
    assert record.plan["verified"]
    assert record.solved
    assert record.label == "CoEvolution+RRTConnect"
    assert record.plan["duration"] == plan.duration
    assert record.plan["segments"] == {s.name: s.duration for s in task.segments}
    assert plan.verification is not None
    assert record.plan["verification"] == plan.verification.to_json()
    assert PLANNING in record.times


def test_a_search_that_cannot_begin_is_a_failed_run(problem: Problem) -> None:
    record = run(replace(job(problem), factory=_Hopeless))
    assert not record.success
    assert record.score == 0.0
    assert record.failure == "there is no room"
    assert record.history == []


class _Hopeless(CoEvolution):
    def __init__(self, *_: object) -> None:
        raise NoPlanError("there is no room")


def test_a_failed_search_with_planning_has_no_plan(problem: Problem) -> None:
    one = job(problem, planner="RRTConnect")
    record = run(replace(one, settings=replace(one.settings, evaluations=1)))
    assert not record.success
    assert not record.solved
    assert record.plan == {"verified": False, "tried": 0, "refuted": 0, "attempts": []}


def test_a_scene_that_changed_is_refused(problem: Problem) -> None:
    with pytest.raises(InputError, match="is not the scene that the benchmark"):
        run(replace(job(problem), fingerprint="0" * 64))


def test_other_software_is_refused(problem: Problem) -> None:
    with pytest.raises(InputError, match=r"made for mmplan 0\.0\.1, but here is"):
        run(replace(job(problem), software="mmplan 0.0.1"))
