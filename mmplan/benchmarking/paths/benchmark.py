"""Running a benchmark of path planners: all on all problems, on the same seeds."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import groupby, product
from pathlib import Path

from mmplan.benchmarking.benchmark import Outcome, Progress
from mmplan.benchmarking.paths.arena import Arena, Contestant, make_arena
from mmplan.benchmarking.paths.planning import own_planner
from mmplan.benchmarking.paths.problems import PathProblems
from mmplan.benchmarking.paths.records import (
    PathJob,
    PathRecord,
    PathStore,
    PlannerFactory,
    Prepared,
)
from mmplan.benchmarking.paths.runs import run
from mmplan.benchmarking.run_store import ProblemEntry
from mmplan.benchmarking.software import software
from mmplan.exceptions import InputError
from mmplan.files.suggestions import unknown
from mmplan.planning import require_planner
from mmplan.problem import PlannerSettings


@dataclass(frozen=True, eq=False)
class Competitor:
    """A planner under a name; `settings` are what else tells its runs from others."""

    name: str
    factory: PlannerFactory
    settings: Mapping[str, object] = field(default_factory=dict)


def own_competitor(name: str, settings: PlannerSettings) -> Competitor:
    """One of OMPL's planners as mmplan uses it.

    Raises:
        InputError: if there is no planner of that name.
    """
    require_planner(name)
    own = own_planner(name, settings)
    shown = {k: v for k, v in asdict(own.settings).items() if k != "name"}
    return Competitor(name, own, shown)


def run_path_benchmark(
    problems: PathProblems,
    robot: Contestant,
    competitors: Sequence[Competitor],
    folder: str | Path,
    *,
    runs: int,
    first_seed: int = 0,
    families: Sequence[str] = (),
    progress: Progress | None = None,
) -> Outcome:
    """Do all runs that the store in `folder` does not have yet, in this process.

    Every competitor gets the same problems; those of one problem and seed come one
    after the other, so that a machine that slows down is as slow for all.

    Args:
        problems: What is to be planned.
        robot: The robot that they are for.
        competitors: Planners, each under a name of its own.
        folder: Where the store is, or is to be.
        runs: How many seeds, from `first_seed` on.
        first_seed: The seed of the first run.
        families: Only these; else all.
        progress: Is told how far it has come.

    Raises:
        InputError: The problems are for another robot, a family is not known, or the
            store cannot be used.
    """
    _require_families(problems, families)
    for problem in problems.problems:
        make_arena(robot, problem)
    jobs = [
        PathJob(
            problems.name, problem, c.name, json.dumps(c.settings, sort_keys=True), seed
        )
        for problem in problems.problems
        if not families or problem.family in families
        for seed, c in product(range(first_seed, first_seed + runs), competitors)
    ]
    with PathStore(folder, create=True) as store:
        store.register(_entry(problems, robot), software())
        missing = store.missing(jobs)
        before = done = len(jobs) - len(missing)
        for record in _do(store, missing, robot, competitors):
            store.add(record)
            done += 1
            if progress is not None:
                progress(done, len(jobs))
        return Outcome(before, done - before, len(store.missing(missing)))


def _do(
    store: PathStore,
    jobs: Sequence[PathJob],
    robot: Contestant,
    competitors: Sequence[Competitor],
) -> Iterator[PathRecord]:
    """What comes of the jobs, problem by problem."""
    factories = {c.name: c.factory for c in competitors}
    for _, group in groupby(jobs, key=lambda job: id(job.problem)):
        planners: dict[str, Prepared] = {}
        arena: Arena | None = None
        for job in group:
            if not store.claim(job):
                continue
            arena = arena or make_arena(robot, job.problem)
            if job.planner not in planners:
                own = make_arena(robot, job.problem)
                planners[job.planner] = factories[job.planner](own)
            yield run(job, arena, planners[job.planner])


def _require_families(problems: PathProblems, families: Sequence[str]) -> None:
    for name in families:
        if name not in problems.families:
            raise InputError(unknown("family", name, problems.families))


def _entry(problems: PathProblems, robot: Contestant) -> ProblemEntry:
    """The problems and their robot, as they must stay in a store."""
    total = hashlib.sha256(problems.fingerprint.encode())
    total.update(f"{robot.hand}".encode())
    total.update(robot.robot.path.read_bytes())
    return ProblemEntry(
        problems.name, str(problems.path.absolute()), total.hexdigest(), {}
    )
