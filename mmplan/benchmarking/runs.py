"""Doing one run: the search, the motion where it is asked for, and what they cost."""

from __future__ import annotations

import platform
import time
from dataclasses import replace
from datetime import datetime, timezone
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from mmplan.benchmarking.records import OPTIMIZER, PLANNING, Job, Record
from mmplan.benchmarking.software import software
from mmplan.benchmarking.stopwatch import Stopwatch, TimedScore
from mmplan.candidate import Candidate
from mmplan.exceptions import InputError, NoPlanError
from mmplan.failure import Attempt
from mmplan.grasps import Mixture
from mmplan.optimizers import Optimization, optimize, search_space
from mmplan.pipeline import grasp_family, plan_candidates, task_generators
from mmplan.plan import Plan
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.scoring import End, Outcome


def run(job: Job) -> Record:
    """Do one run; its random numbers are those of `mmplan solve` with the same seed.

    The result is the same in whatever process it is computed, and after whatever other
    runs; only what is measured differs.

    Raises:
        InputError: The scene or the software here is not what the job was made for.
    """
    problem = _with_settings(_problem(job), job)
    rng = task_generators(problem, job.seed)[0]
    watch = Stopwatch()
    with watch.stage(OPTIMIZER):
        score = TimedScore(problem, watch)
        search = _search(job, score, rng)
    times = watch.times  # before the score is used for anything else
    found = search.found
    best = _best(score, found)
    plan = None
    if job.planner and found is not None:
        planning = Stopwatch()
        with planning.stage(PLANNING):
            plan = _plan_account(*plan_candidates(score, found, job.seed, rng))
        times |= planning.times
    return Record(
        **job.key._asdict(),
        label=job.label,
        success=best is not None,
        score=best.triple.total if best else 0.0,
        ends=_ends(best),
        grasp=_grasp_name(problem, best),
        genes=best.triple.grasp.tolist() if best else None,
        used=found.evaluations if found else 0,
        cycles=found.cycles if found else None,
        history=[[int(n), float(b)] for n, b in found.history] if found else [],
        outcomes=_outcomes(found),
        failure=search.failure,
        plan=plan,
        seconds=search.seconds,
        times=times,
        host=platform.node(),
        finished=datetime.now(timezone.utc).isoformat(timespec="seconds"),
    )


class _Search(NamedTuple):
    """A search, or why it could not begin; the wall clock's seconds of its history."""

    found: Optimization | None
    failure: str | None
    seconds: list[float]


def _search(job: Job, score: TimedScore, rng: np.random.Generator) -> _Search:
    started = time.perf_counter()
    laps: list[tuple[int, float]] = []  # evaluations and seconds at ends of batches
    try:
        found = optimize(
            score,
            job.factory(search_space(score), job.settings, rng),
            job.settings.evaluations,
            score.problem.planner.candidates,
            lambda spent: laps.append((spent, time.perf_counter() - started)),
        )
    except NoPlanError as error:
        return _Search(None, str(error), [])
    spent, seconds = np.array(laps).T
    batch = np.searchsorted(spent, found.history[:, 0])
    return _Search(found, None, seconds[batch].tolist())


def _problem(job: Job) -> Problem:
    """The problem of a job, the very one that it was made for."""
    if software() != job.software:
        raise InputError(f"a run was made for {job.software}, but here is {software()}")
    problem = _load(job.scene, job.fingerprint)
    if problem.fingerprint != job.fingerprint:
        raise InputError(f"{job.scene}: is not the scene that the benchmark began with")
    return problem


@lru_cache(maxsize=128)
def _load(scene: str, fingerprint: str) -> Problem:  # noqa: ARG001 (loads anew)
    return load_problem(scene)


def _with_settings(problem: Problem, job: Job) -> Problem:
    planner = replace(problem.planner, name=job.planner or problem.planner.name)
    return replace(problem, optimizer=job.settings, planner=planner)


def _best(score: TimedScore, found: Optimization | None) -> Candidate | None:
    if found is None or not found.candidates:
        return None
    return Candidate.of_triple(found.candidates[0], score)


def _ends(best: Candidate | None) -> dict[str, Any]:
    if best is None:
        return {}
    return {
        end.name.lower(): {
            "base": best.triple.q_base[end].tolist(),
            "score": best.scores[end],
        }
        for end in End
    }


def _grasp_name(problem: Problem, best: Candidate | None) -> str | None:
    if best is None:
        return None
    names, family = grasp_family(problem.object(problem.tasks[0].object))
    if isinstance(family, Mixture):
        return names[int(family.family_of(best.triple.grasp[None])[0])]
    return names[0]


def _outcomes(found: Optimization | None) -> dict[str, dict[str, int]]:
    if found is None:
        return {}
    return {
        end.name.lower(): {o.label: int(found.outcomes[end, o]) for o in Outcome}
        for end in End
    }


def _plan_account(plan: Plan | None, attempts: tuple[Attempt, ...]) -> dict[str, Any]:
    """What planning came to: the plan in numbers, its proof, and what failed before."""
    account: dict[str, Any] = {
        "verified": plan is not None,
        "tried": len(attempts) + (plan is not None),
        "refuted": sum(a.blocked.segment == "verification" for a in attempts),
        "attempts": [
            {
                "score": a.score,
                "segment": a.blocked.segment,
                "message": a.blocked.message,
            }
            for a in attempts
        ],
    }
    if plan is None:
        return account
    task = plan.tasks[0]
    ends = (task.start, task.goal)
    return {
        **account,
        "score": float(sum(sum(end.scores.values()) for end in ends)),
        "duration": plan.duration,
        "segments": {s.name: s.duration for s in task.segments},
        "verification": plan.verification and plan.verification.to_json(),
    }
