"""The method on one page: optimize both bases and the grasp, plan, prove."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import closing
from dataclasses import replace
from functools import cache
from typing import Protocol

import numpy as np

from mmplan.candidate import Candidate
from mmplan.collision import CollisionWorld
from mmplan.exceptions import NoPlanError, VerificationError
from mmplan.failure import Attempt, failure_report
from mmplan.grasps import GraspFamily, Mixture
from mmplan.motion import Blocked, Outcome, TaskMotion
from mmplan.optimizers import (
    OPTIMIZERS,
    Optimization,
    Optimizer,
    optimize,
    search_space,
)
from mmplan.plan import Plan, Segment, TaskEnd, TaskPlan
from mmplan.plan_assembly import assemble_plan
from mmplan.problem import Object, Problem, Task
from mmplan.scoring import End, ScoreFunction
from mmplan.shapes import Array
from mmplan.verification import examine


class Progress(Protocol):
    """Is told how far `solve` has come; `of` is None where the end is not known."""

    def __call__(self, what: str, done: int, of: int | None) -> None:
        """Take note of a stage's progress."""
        ...


def solve(
    problem: Problem,
    *,
    seed: int = 0,
    progress: Progress | None = None,
    jobs: int = 1,
) -> Plan:
    """Find grasps, base placements and a verified, timed motion for all tasks.

    The same problem, seed and machine give the same plan, whatever the number of
    `jobs`: with two, both ends are scored at the same time, the ways to the object and
    to its goal are looked for so and, once a candidate has failed, two others planned.

    Raises:
        NoPlanError: No plan was found; the error carries the account.
        VerificationError: The tasks are proven one by one, but not in a row.
    """
    report: Progress = progress or _ignore
    rest, plans = problem, []
    for number, rng in enumerate(task_generators(problem, seed)):
        one = replace(rest, tasks=(problem.tasks[number],))
        plan = _solve_task(one, number, seed, rng, report, jobs)
        plans.append(plan)
        rest = after_task(one, plan.tasks[0])
    if len(plans) == 1:
        return plans[0]
    whole = assemble_plan(problem, [plan.tasks[0] for plan in plans], seed)
    verification = examine(whole, problem)
    if not verification.ok:
        raise VerificationError(tuple(str(f) for f in verification.faults))
    return replace(whole, verification=verification)


def task_generators(problem: Problem, seed: int) -> list[np.random.Generator]:
    """The random numbers of each task."""
    sequences = np.random.SeedSequence(seed).spawn(len(problem.tasks))
    return [np.random.default_rng(sequence) for sequence in sequences]


def _ignore(what: str, done: int, of: int | None) -> None:
    """Nobody watches."""


def _solve_task(
    problem: Problem,
    number: int,
    seed: int,
    rng: np.random.Generator,
    report: Progress,
    jobs: int,
) -> Plan:
    """The verified plan of a problem with one task, the `number`th of the scene."""
    score = score_function(problem)
    found = _optimize(score, rng, report, jobs)
    plan, attempts = plan_candidates(score, found, seed, rng, report, jobs)
    if plan is not None:
        return plan
    account = failure_report(number, score, found, attempts)
    raise NoPlanError("\n".join(account.lines()), account)


def score_function(problem: Problem) -> ScoreFunction:
    """The score of a problem's first task, in its world before that task."""
    task = problem.tasks[0]
    _, family = grasp_family(problem.object(task.object))
    return ScoreFunction(problem, task, CollisionWorld.of_problem(problem), family)


def plan_candidates(
    score: ScoreFunction,
    found: Optimization,
    seed: int,
    rng: np.random.Generator,
    report: Progress | None = None,
    jobs: int = 1,
) -> tuple[Plan | None, tuple[Attempt, ...]]:
    """The verified plan of the best candidate that has one, and the failures before.

    `seed` is what the plan says that it was made from. If all fail, those that do so at
    a straight motion that the scene does not insist on are tried without such motions.
    """
    failed: dict[int, Attempt] = {}
    numbers = list(range(len(found.candidates)))
    for without_lines in (False, True):
        motion = TaskMotion(
            score.problem, score.task, score.worlds[End.START], without_lines, jobs
        )
        plan = _first_plan(
            score, motion, found, numbers, seed, rng, failed, report or _ignore
        )
        numbers = [n for n in numbers if _line_in_the_way(score.task, failed.get(n))]
        if plan is not None or not numbers:
            break
    return plan, tuple(attempt for _, attempt in sorted(failed.items()))


def _first_plan(
    score: ScoreFunction,
    motion: TaskMotion,
    found: Optimization,
    numbers: Sequence[int],
    seed: int,
    rng: np.random.Generator,
    failed: dict[int, Attempt],
    report: Progress,
) -> Plan | None:
    """The first verified plan of some of the candidates, by their numbers.

    `failed` is told of those before that fail, and forgets the one that does not.
    """
    made = cache(lambda k: Candidate.of_triple(found.candidates[numbers[k]], score))
    report("planning", 0, len(numbers))
    with closing(_outcomes(motion, made, len(numbers), rng)) as outcomes:
        for done, (k, planned) in enumerate(outcomes, start=1):
            plan: Plan | Blocked
            if isinstance(planned, Blocked):
                plan = planned
            else:
                plan = _verified(score, made(k), planned, seed)
            if isinstance(plan, Plan):
                failed.pop(numbers[k], None)
                return plan
            failed[numbers[k]] = Attempt(made(k).triple.total, plan)
            report("planning", done, len(numbers))
    return None


def _outcomes(
    motion: TaskMotion,
    made: Callable[[int], Candidate],
    count: int,
    rng: np.random.Generator,
) -> Generator[tuple[int, Outcome]]:
    """The number of each candidate that is made, and what is planned for it."""
    together = motion.problem.planner.goals
    if together == 1:
        yield from motion.plan_in_turn(map(made, range(count)), rng)
        return
    for first in range(0, count, together):
        group = range(first, min(first + together, count))
        for k, outcome in motion.plan_together([made(k) for k in group], rng):
            yield group[k], outcome


def _verified(
    score: ScoreFunction, candidate: Candidate, segments: tuple[Segment, ...], seed: int
) -> Plan | Blocked:
    """The plan with these segments, if it passes the verifier."""
    problem, task = score.problem, score.task
    names, family = grasp_family(problem.object(task.object))
    name = names[_family_number(family, candidate.triple.grasp)]
    plan = assemble_plan(
        problem, [_task_plan(task.object, name, candidate, segments)], seed
    )
    verification = examine(plan, problem)
    if verification.ok:
        return replace(plan, verification=verification)
    return Blocked("verification", str(verification.faults[0]))


def _line_in_the_way(task: Task, attempt: Attempt | None) -> bool:
    """Whether a straight motion that the scene leaves open stopped a candidate."""
    if attempt is None:
        return False
    return getattr(task, attempt.blocked.segment, 0.0) is None


def _optimize(
    score: ScoreFunction, rng: np.random.Generator, report: Progress, jobs: int = 1
) -> Optimization:
    evaluations = score.problem.optimizer.evaluations
    return optimize(
        score,
        optimizer_of(score, rng),
        evaluations,
        score.problem.planner.candidates,
        lambda spent: report("optimization", spent, evaluations),
        jobs,
    )


def optimizer_of(score: ScoreFunction, rng: np.random.Generator) -> Optimizer:
    """The optimizer that a problem's settings name, at its start."""
    settings = score.problem.optimizer
    return OPTIMIZERS[settings.name](search_space(score), settings, rng)


def grasp_family(item: Object) -> tuple[tuple[str, ...], GraspFamily]:
    """The names of an object's grasp families and all of them as one family."""
    families = tuple(item.grasps.values())
    family = families[0] if len(families) == 1 else Mixture(families)
    return tuple(item.grasps), family


def _family_number(family: GraspFamily, genes: Array) -> int:
    if isinstance(family, Mixture):
        return int(family.family_of(genes[None])[0])
    return 0


def _task_plan(
    name: str, grasp: str, candidate: Candidate, segments: tuple[Segment, ...]
) -> TaskPlan:
    start, goal = (
        TaskEnd(candidate.triple.q_base[end], candidate.scores[end]) for end in End
    )
    return TaskPlan(
        object=name,
        grasp=grasp,
        genes=candidate.triple.grasp,
        T_object_tool=candidate.T_object_tool,
        hand_open=candidate.opened,
        hand_closed=candidate.closed,
        start=start,
        goal=goal,
        segments=segments,
    )


def after_task(problem: Problem, task: TaskPlan) -> Problem:
    """A problem with one task as the plan of that task leaves it."""
    objects = tuple(
        replace(o, T_world_object=problem.tasks[0].T_world_goal)
        if o.name == task.object
        else o
        for o in problem.objects
    )
    q_end = task.segments[-1].positions[-1]
    return replace(problem, q_start=q_end, objects=objects)
