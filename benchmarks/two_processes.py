"""What a second process gains in the optimization, and that it changes nothing.

    python benchmarks/two_processes.py [SCENE ...] [--seeds 5]

Each seed is optimized by one process and by two, in turn; seconds are those on the
clock, so the machine should have two cores and nothing else to do. All that was asked
for and found must be equal to the last bit.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import mmplan
from mmplan.optimizers import Optimization, optimize
from mmplan.pipeline import optimizer_of, score_function, task_generators
from mmplan.problem import Problem

SCENES = ("wineglass", "plate", "panda_bin", "tiago_shelf", "pr2_sideboard")


def main() -> None:
    """Print a row for each scene."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--seeds", type=int, default=5)
    options = parser.parse_args()
    print("| scene | seeds | one process, s | two processes, s | ratio | equal |")
    print("| --- | --- | --- | --- | --- | --- |")
    for scene in options.scenes:
        problem = mmplan.load_problem(scene)
        runs = [_both(problem, seed) for seed in range(options.seeds)]
        one, two = np.median([times for times, _ in runs], axis=0)
        ratio = np.median([times[0] / times[1] for times, _ in runs])
        equal = sum(same for _, same in runs)
        print(
            f"| {scene} | {len(runs)} | {one:.2f} | {two:.2f} | {ratio:.2f} "
            f"| {equal}/{len(runs)} |",
            flush=True,
        )


def _both(problem: Problem, seed: int) -> tuple[tuple[float, float], bool]:
    """The times of one and of two processes, and whether they found the same."""
    (one, first), (two, second) = (_optimized(problem, seed, n) for n in (1, 2))
    return (one, two), _same(first, second)


def _optimized(problem: Problem, seed: int, jobs: int) -> tuple[float, Optimization]:
    begin = time.perf_counter()
    score = score_function(problem)
    (rng, *_) = task_generators(problem, seed)
    optimizer = optimizer_of(score, rng)
    evaluations = problem.optimizer.evaluations
    found = optimize(score, optimizer, evaluations, 10, jobs=jobs)
    return time.perf_counter() - begin, found


def _same(one: Optimization, other: Optimization) -> bool:
    """Whether two searches asked for the same and found the same, bit for bit."""
    pairs = [
        (one.history, other.history),
        (one.outcomes, other.outcomes),
        (one.evaluated.q_base, other.evaluated.q_base),
        (one.evaluated.grasps, other.evaluated.grasps),
        ([c.scores for c in one.candidates], [c.scores for c in other.candidates]),
    ]
    return all(np.array_equal(ours, theirs) for ours, theirs in pairs)


if __name__ == "__main__":
    main()
