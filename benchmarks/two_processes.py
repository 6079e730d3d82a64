"""What a second process gains in each stage, and that it changes nothing.

    python benchmarks/two_processes.py [--scenes wineglass ...] [--stages motion ...]
        [--seeds 5] [--repeats 3] [--alone]

Each seed is run by one process and by two, in turn and so many times that the quickest
of each counts. Seconds are those on the clock, so the machine should have two cores and
nothing else to do: with --alone (Linux) runs wait until that is so, and are repeated if
it was not so to their end. Stages are the optimization, the motion of the best
candidates until one has a motion, and all of `mmplan solve`, the proof included. All
that comes of them must be equal to the last bit.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable
from contextlib import closing
from functools import cache
from pathlib import Path
from typing import TypeAlias

import numpy as np

import mmplan
from mmplan.candidate import Candidate
from mmplan.collision import CollisionWorld, compile_motions
from mmplan.exceptions import NoPlanError
from mmplan.motion import Blocked, TaskMotion
from mmplan.optimizers import Optimization, optimize
from mmplan.pipeline import optimizer_of, score_function, task_generators
from mmplan.plan import Segment
from mmplan.problem import Problem
from mmplan.scoring import ScoreFunction

SCENES = (
    "wineglass",
    "plate",
    "panda_bin",
    "tiago_shelf",
    "pr2_sideboard",
    "wineglass_upright",
    "ur5_machine_tending",
)
# Others disturb a run that work for more than this share of it, and are watched for as
# many s before it begins.
_DISTURBING = 0.1
_WAIT = 0.5
# Seconds on the clock, and everything that came of a run, in bytes.
Run: TypeAlias = tuple[float, list[bytes]]


def main() -> None:
    """Print a row for each scene and stage."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenes", nargs="+", default=SCENES)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--stages", nargs="+", choices=STAGES, default=list(STAGES))
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--alone", action="store_true")
    options = parser.parse_args()
    compile_motions()
    mmplan.solve(mmplan.load_problem(SCENES[0]))  # loads what is loaded when needed
    print(
        "| scene | stage | seeds | one process, s | two processes, s | ratio | equal |"
    )
    print("|" + " --- |" * 7)
    for scene in options.scenes:
        for stage in options.stages:
            _print_row(scene, stage, options)


def _print_row(scene: str, stage: str, options: argparse.Namespace) -> None:
    problem, seeds = mmplan.load_problem(scene), options.seeds
    times, equal = np.empty((seeds, 2)), 0
    for seed in range(seeds):
        pairs = [
            _both(STAGES[stage], problem, seed, i % 2 == 1, options.alone)
            for i in range(options.repeats)
        ]
        times[seed] = np.min([[s for s, _ in pair] for pair in pairs], axis=0)
        equal += all(first == second for (_, first), (_, second) in pairs)
    one, two = np.median(times, axis=0)
    ratio = np.median(times[:, 0] / times[:, 1])
    print(
        f"| {scene} | {stage} | {seeds} | {one:.2f} | {two:.2f} | {ratio:.2f} "
        f"| {equal}/{seeds} |",
        flush=True,
    )


def _both(
    stage: Callable[[Problem, int, int], Run],
    problem: Problem,
    seed: int,
    two_first: bool,
    alone: bool,
) -> tuple[Run, Run]:
    """The runs by one process and by two."""
    while True:
        begin = _begin_alone() if alone else 0.0
        order = (2, 1) if two_first else (1, 2)
        runs = {jobs: stage(problem, seed, jobs) for jobs in order}
        if not alone:
            break
        share = (_others_work() - begin) / (runs[1][0] + runs[2][0])
        if share < _DISTURBING:
            break
    return runs[1], runs[2]


def _begin_alone() -> float:
    """Wait until no other process is at work."""
    while True:
        before = _others_work()
        time.sleep(_WAIT)
        after = _others_work()
        if after - before < _DISTURBING * _WAIT:
            return after


def _others_work() -> float:
    """CPU s that other processes than this and its children have worked so far."""
    user, nice, system = Path("/proc/stat").read_text().split()[1:4]
    everybody = (int(user) + int(nice) + int(system)) / os.sysconf("SC_CLK_TCK")
    return everybody - sum(os.times()[:4])


def _optimization(problem: Problem, seed: int, jobs: int) -> Run:
    begin = time.perf_counter()
    _, found = _optimized(problem, seed, jobs)
    seconds = time.perf_counter() - begin
    evaluated = found.evaluated
    arrays = [found.history, found.outcomes, evaluated.q_base, evaluated.grasps]
    scores = [c.scores for c in found.candidates]
    return seconds, [np.asarray(x).tobytes() for x in (*arrays, *scores)]


def _motion(problem: Problem, seed: int, jobs: int) -> Run:
    """In a world of its own, as no run may find what another has left in its caches."""
    world = CollisionWorld.of_problem(problem)
    motion = TaskMotion(problem, problem.tasks[0], world, jobs=jobs)
    rng = np.random.default_rng(seed)
    candidates = _candidates(problem, seed)
    begin = time.perf_counter()
    outcomes = []
    with closing(motion.plan_in_turn(candidates, rng)) as found:
        for _, outcome in found:
            outcomes.append(outcome)
            if not isinstance(outcome, Blocked):
                break
    seconds = time.perf_counter() - begin
    return seconds, [row for outcome in outcomes for row in _bytes(outcome)]


def _solve(problem: Problem, seed: int, jobs: int) -> Run:
    begin = time.perf_counter()
    try:
        plan = mmplan.solve(problem, seed=seed, jobs=jobs)
    except NoPlanError as error:
        return time.perf_counter() - begin, [str(error).encode()]
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
def _candidates(problem: Problem, seed: int) -> tuple[Candidate, ...]:
    score, found = _optimized(problem, seed, 1)
    return tuple(Candidate.of_triple(t, score) for t in found.candidates)


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
