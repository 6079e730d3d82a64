"""What a second process gains in each stage, and that it changes nothing.

    python benchmarks/two_processes.py [SCENE ...] [--seeds 5] [--stages motion ...]

Each seed is run by one process and by two, in turn; seconds are those on the clock, so
the machine should have two cores and nothing else to do. Stages are the optimization,
the motion of the best candidates until one has a motion, and all of `mmplan solve`, the
proof included. All that comes of them must be equal to the last bit.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import cache
from typing import TypeAlias

import numpy as np

import mmplan
from mmplan.candidate import Candidate
from mmplan.collision import compile_motions
from mmplan.motion import Blocked, TaskMotion
from mmplan.optimizers import Optimization, optimize
from mmplan.pipeline import optimizer_of, score_function, task_generators
from mmplan.plan import Segment
from mmplan.problem import Problem
from mmplan.scoring import End, ScoreFunction

SCENES = (
    "wineglass",
    "plate",
    "panda_bin",
    "tiago_shelf",
    "pr2_sideboard",
    "wineglass_upright",
    "ur5_machine_tending",
)
# Seconds on the clock, and everything that came of a run, in bytes.
Run: TypeAlias = tuple[float, list[bytes]]


def main() -> None:
    """Print a row for each scene and stage."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--stages", nargs="+", choices=STAGES, default=list(STAGES))
    options = parser.parse_args()
    compile_motions()
    mmplan.solve(mmplan.load_problem(SCENES[0]))  # loads what is loaded when needed
    print(
        "| scene | stage | seeds | one process, s | two processes, s | ratio | equal |"
    )
    print("|" + " --- |" * 7)
    for scene in options.scenes:
        for stage in options.stages:
            _print_row(scene, stage, options.seeds)


def _print_row(scene: str, stage: str, seeds: int) -> None:
    problem = mmplan.load_problem(scene)
    pairs = [_both(STAGES[stage], problem, seed) for seed in range(seeds)]
    times = np.array([[seconds for seconds, _ in pair] for pair in pairs])
    one, two = np.median(times, axis=0)
    ratio = np.median(times[:, 0] / times[:, 1])
    equal = sum(first == second for (_, first), (_, second) in pairs)
    print(
        f"| {scene} | {stage} | {seeds} | {one:.2f} | {two:.2f} | {ratio:.2f} "
        f"| {equal}/{seeds} |",
        flush=True,
    )


def _both(
    stage: Callable[[Problem, int, int], Run], problem: Problem, seed: int
) -> tuple[Run, Run]:
    """The runs by one process and by two; which is first changes with the seed."""
    runs = {jobs: stage(problem, seed, jobs) for jobs in ((1, 2), (2, 1))[seed % 2]}
    return runs[1], runs[2]


def _optimization(problem: Problem, seed: int, jobs: int) -> Run:
    begin = time.perf_counter()
    _, found = _optimized(problem, seed, jobs)
    seconds = time.perf_counter() - begin
    evaluated = found.evaluated
    arrays = [found.history, found.outcomes, evaluated.q_base, evaluated.grasps]
    scores = [c.scores for c in found.candidates]
    return seconds, [np.asarray(x).tobytes() for x in (*arrays, *scores)]


def _motion(problem: Problem, seed: int, jobs: int) -> Run:
    """Candidates are the same objects for any number of jobs."""
    score, candidates = _candidates(problem, seed)
    motion = TaskMotion(score.problem, score.task, score.worlds[End.START], jobs=jobs)
    rng = np.random.default_rng(seed)
    begin = time.perf_counter()
    outcomes = []
    for candidate in candidates:
        outcomes.append(motion.plan(candidate, rng))
        if not isinstance(outcomes[-1], Blocked):
            break
    seconds = time.perf_counter() - begin
    return seconds, [row for outcome in outcomes for row in _bytes(outcome)]


def _solve(problem: Problem, seed: int, jobs: int) -> Run:
    begin = time.perf_counter()
    plan = mmplan.solve(problem, seed=seed, jobs=jobs)
    seconds = time.perf_counter() - begin
    return seconds, [row for task in plan.tasks for row in _bytes(task.segments)]


STAGES = {"optimization": _optimization, "motion": _motion, "solve": _solve}


def _optimized(
    problem: Problem, seed: int, jobs: int
) -> tuple[ScoreFunction, Optimization]:
    score = score_function(problem)
    (rng, *_) = task_generators(problem, seed)
    optimizer = optimizer_of(score, rng)
    evaluations = problem.optimizer.evaluations
    most = problem.planner.candidates
    return score, optimize(score, optimizer, evaluations, most, jobs=jobs)


@cache
def _candidates(
    problem: Problem, seed: int
) -> tuple[ScoreFunction, tuple[Candidate, ...]]:
    score, found = _optimized(problem, seed, 1)
    return score, tuple(Candidate.of_triple(t, score) for t in found.candidates)


def _bytes(outcome: tuple[Segment, ...] | Blocked) -> list[bytes]:
    """All numbers of segments, or what stood in their way."""
    if isinstance(outcome, Blocked):
        return [repr(outcome).encode()]
    return [
        part
        for s in outcome
        for part in (
            s.name.encode(),
            s.times.tobytes(),
            s.positions.tobytes(),
            s.velocities.tobytes(),
        )
    ]


if __name__ == "__main__":
    main()
