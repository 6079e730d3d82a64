"""Running a benchmark: all contenders on all problems, on the same seeds."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path
from typing import TypeAlias

from mmplan.benchmarking.floor_plan import floor_plan
from mmplan.benchmarking.processes import InThisProcess, LocalProcesses, Scheduler
from mmplan.benchmarking.records import Job
from mmplan.benchmarking.software import software
from mmplan.benchmarking.store import ProblemEntry, Store
from mmplan.exceptions import InputError
from mmplan.files.suggestions import unknown
from mmplan.optimizers import OPTIMIZERS, OptimizerFactory
from mmplan.planning import require_planner
from mmplan.problem import Problem
from mmplan.scene_file import load_problem

RUNS = 200  # as many as in the paper
CONTENDERS = ("coevolution", "random")

# Called with the runs that are stored so far and with all that there are to be.
Progress: TypeAlias = Callable[[int, int], None]


@dataclass(frozen=True)
class Outcome:
    """How a benchmark ended: runs stored before, stored now, left to others."""

    before: int
    done: int
    left: int  # being done by another process on the same store

    def __str__(self) -> str:
        """One line for people."""
        left = f"; {self.left} are being done by another process" if self.left else ""
        return f"{self.done} runs done, {self.before} were there before{left}"


def run_benchmark(
    scenes: Iterable[str | Path],
    folder: str | Path,
    *,
    optimizers: Sequence[str] | Mapping[str, OptimizerFactory] = CONTENDERS,
    runs: int = RUNS,
    first_seed: int = 0,
    evaluations: Sequence[int] = (),
    planners: Sequence[str] = (),
    scheduler: Scheduler | None = None,
    progress: Progress | None = None,
) -> Outcome:
    """Do all runs that the store in `folder` does not have yet.

    Every optimizer gets the same seeds and the same number of score evaluations.

    Args:
        scenes: Paths of scene files with one task, or names of shipped scenes.
        folder: Where the store is, or is to be.
        optimizers: Names of mmplan's; or, by name, classes that a fresh process can
            import.
        runs: How many seeds, from `first_seed` on.
        first_seed: The seed of the first run.
        evaluations: Budgets, each a contest of its own; else that of each scene.
        planners: Names of OMPL planners, where motions are to be planned too.
        scheduler: Who does the runs; else this process.
        progress: Is told how far it has come.

    Raises:
        InputError: A scene, a name or the store cannot be used.
    """
    factories = _factories(optimizers)
    for name in planners:
        require_planner(name)
    problems = _problems(scenes)
    jobs = [
        make_job(problem, budget, name, factory, planner, seed)
        for seed in range(first_seed, first_seed + runs)
        for problem in problems
        for budget, planner in product(
            evaluations or (problem.optimizer.evaluations,), planners or ("",)
        )
        for name, factory in factories.items()
    ]
    with Store(folder, create=True) as store:
        for problem in problems:
            store.register(_entry(problem), software())
        return _do(store, jobs, scheduler or InThisProcess(), progress)


def scheduler_of(jobs: int, address: str | None) -> Scheduler:
    """The scheduler for a number of local processes, or for a Dask cluster."""
    if address is not None:
        from mmplan.benchmarking.dask_cluster import DaskCluster

        return DaskCluster(address)
    return InThisProcess() if jobs == 1 else LocalProcesses(jobs)


def _do(
    store: Store, jobs: list[Job], scheduler: Scheduler, progress: Progress | None
) -> Outcome:
    missing = store.missing(jobs)
    before, done = len(jobs) - len(missing), 0
    for record in scheduler(_claimed(store, missing)):
        store.add(record)
        done += 1
        if progress is not None:
            progress(before + done, len(jobs))
    return Outcome(before, done, len(store.missing(missing)))


def _claimed(store: Store, jobs: Iterable[Job]) -> Iterator[Job]:
    return (job for job in jobs if store.claim(job))


def _factories(
    optimizers: Sequence[str] | Mapping[str, OptimizerFactory],
) -> Mapping[str, OptimizerFactory]:
    if isinstance(optimizers, Mapping):
        return optimizers
    for name in optimizers:
        if name not in OPTIMIZERS:
            raise InputError(unknown("optimizer", name, OPTIMIZERS))
    return {name: OPTIMIZERS[name] for name in optimizers}


def _problems(scenes: Iterable[str | Path]) -> list[Problem]:
    """The problems, each once.

    Raises:
        InputError: One of them has several tasks, or two share a name.
    """
    problems: dict[str, Problem] = {}
    for scene in scenes:
        problem = load_problem(scene)
        if len(problem.tasks) != 1:
            raise InputError(
                f"{scene}: has {len(problem.tasks)} tasks; a benchmark wants scenes "
                "with one"
            )
        other = problems.setdefault(problem.name, problem)
        if other.fingerprint != problem.fingerprint:
            raise InputError(
                f"{scene}: has the name '{problem.name}', as {other.path} has"
            )
    return list(problems.values())


def make_job(
    problem: Problem,
    budget: int,
    name: str,
    factory: OptimizerFactory,
    planner: str,
    seed: int,
) -> Job:
    """One run of an optimizer, and of a planner where there is one, on a problem."""
    return Job(
        scene=_scene(problem),
        problem=problem.name,
        fingerprint=problem.fingerprint,
        software=software(),
        factory=factory,
        settings=replace(problem.optimizer, name=name, evaluations=budget),
        seed=seed,
        planner=planner,
    )


def _entry(problem: Problem) -> ProblemEntry:
    return ProblemEntry(
        problem.name, _scene(problem), problem.fingerprint, floor_plan(problem)
    )


def _scene(problem: Problem) -> str:
    assert problem.path is not None  # it was loaded from there
    return str(problem.path.absolute())
