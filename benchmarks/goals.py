"""What it costs and gains that candidates are goals of one search.

    python benchmarks/goals.py [SCENE ...] [--seeds 5] [--goals 1 8]

Each scene is solved with each number of goals, in turn, for the same seeds. CPU seconds
are those of the motion alone, from the optimizer's candidates to the verified plan.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

import mmplan
from mmplan.collision import compile_motions
from mmplan.optimizers import Optimization, optimize
from mmplan.pipeline import (
    optimizer_of,
    plan_candidates,
    score_function,
    task_generators,
)
from mmplan.problem import Problem
from mmplan.scoring import ScoreFunction

SCENES = ("wineglass", "plate", "panda_bin", "tiago_shelf", "ur5_machine_tending")


class Run(NamedTuple):
    """What came of one seed."""

    seconds: float  # CPU
    score: float
    transit: float  # s
    duration: float  # s, of the whole task
    attempts: int  # candidates that failed before


def main() -> None:
    """Print a row for each scene and number of goals."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--goals", type=int, nargs="+", default=[1, 8])
    options = parser.parse_args()
    compile_motions()
    mmplan.solve(mmplan.load_problem("wineglass"))  # loads what is loaded when needed
    print(
        "| scene | goals | solved | score | motion, CPU s | transit, s | whole task, s "
        "| candidates failed |"
    )
    print("|" + " --- |" * 8)
    for scene in options.scenes:
        problem = mmplan.load_problem(scene)
        runs = [_runs(problem, seed, options.goals) for seed in range(options.seeds)]
        for goals, column in zip(options.goals, zip(*runs, strict=True), strict=True):
            print(_row(scene, goals, column), flush=True)


def _runs(problem: Problem, seed: int, goals: Sequence[int]) -> list[Run | None]:
    """The runs with each number of goals, all with what one optimization found."""
    score = score_function(problem)
    (rng, *_) = task_generators(problem, seed)
    found = optimize(
        score,
        optimizer_of(score, rng),
        problem.optimizer.evaluations,
        problem.planner.candidates,
    )
    return [_run(score, found, seed, number) for number in goals]


def _run(
    score: ScoreFunction, found: Optimization, seed: int, goals: int
) -> Run | None:
    planner = replace(score.problem.planner, goals=goals)
    score.problem = replace(score.problem, planner=planner)
    rng = np.random.default_rng(seed)
    begin = time.process_time()
    plan, attempts = plan_candidates(score, found, seed, rng)
    seconds = time.process_time() - begin
    if plan is None:
        return None
    (task,) = plan.tasks
    total = sum(sum(end.scores.values()) for end in (task.start, task.goal))
    times = [float(segment.times[-1]) for segment in task.segments]
    return Run(seconds, total, times[0], sum(times), len(attempts))


def _row(scene: str, goals: int, runs: Sequence[Run | None]) -> str:
    done = np.array([run for run in runs if run is not None]).reshape(
        -1, len(Run._fields)
    )
    seconds, score, transit, duration, attempts = np.median(done, axis=0)
    return (
        f"| {scene} | {goals} | {len(done)}/{len(runs)} | {score:.1f} | {seconds:.2f} "
        f"| {transit:.2f} | {duration:.2f} | {attempts:.0f} |"
    )


if __name__ == "__main__":
    main()
