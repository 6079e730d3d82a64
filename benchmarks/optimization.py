"""How fast the optimization is, beside a straightforward reference, with equal scores.

    python benchmarks/optimization.py [--scene wineglass] [--seeds 10] [--sample 400]

One seed after the other the optimizer spends the paper's 6,940 evaluations, timed as a
whole on one core; then the reference (`_reference.py`) evaluates an even sample of the
same queries, and scores are compared. Both are measured in turn, in the same run.
"""

from __future__ import annotations

import argparse
import time

import numpy as np
from _reference import ReferenceScore

import mmplan
from mmplan.collision import CollisionWorld
from mmplan.optimizers import OPTIMIZERS, Optimization, optimize, search_space
from mmplan.pipeline import grasp_family
from mmplan.problem import Problem
from mmplan.scoring import End, ScoreFunction


def main() -> None:
    """Print a line for each seed, then the medians."""
    options = _options()
    problem = mmplan.load_problem(options.scene)
    rows = []
    print("seed  seconds  us/evaluation  reference us/evaluation  ratio  score error")
    for seed in range(options.seeds):
        seconds, score, found = _optimize(problem, options.optimizer, seed)
        slow, error = _compare(score, found, options.sample)
        fast = seconds / found.evaluations
        rows.append((seconds, fast * 1e6, slow * 1e6, slow / fast, error))
        print(
            "{:4d}  {:7.2f}  {:13.0f}  {:23.0f}  {:5.1f}  {:11.1e}".format(
                seed, *rows[-1]
            )
        )
    medians = np.median(rows, axis=0)
    worst = max(row[-1] for row in rows)
    print(
        f"median of {options.seeds} seeds: {medians[0]:.2f} s for "
        f"{problem.optimizer.evaluations} evaluations, {medians[3]:.1f} times the "
        f"reference's throughput, scores equal to {worst:.1e}"
    )


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="wineglass")
    parser.add_argument("--optimizer", default="coevolution", choices=OPTIMIZERS)
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--sample", type=int, default=400)
    return parser.parse_args()


def _optimize(
    problem: Problem, name: str, seed: int
) -> tuple[float, ScoreFunction, Optimization]:
    """One search as `mmplan.solve` makes it, and the seconds that it took."""
    task = problem.tasks[0]
    begin = time.perf_counter()
    world = CollisionWorld.of_problem(problem)
    _, family = grasp_family(problem.object(task.object))
    score = ScoreFunction(problem, task, world, family)
    rng = np.random.default_rng(seed)
    optimizer = OPTIMIZERS[name](search_space(score), problem.optimizer, rng)
    found = optimize(score, optimizer, problem.optimizer.evaluations, 20)
    return time.perf_counter() - begin, score, found


def _compare(
    score: ScoreFunction, found: Optimization, sample: int
) -> tuple[float, float]:
    """Seconds an evaluation of the reference, and the greatest difference of scores."""
    reference = ReferenceScore(score)
    asked = found.evaluated
    rows = np.linspace(0, len(asked.end) - 1, sample).astype(int)
    error, seconds = 0.0, 0.0
    for row in rows:
        end, q_base, grasp = End(asked.end[row]), asked.q_base[row], asked.grasps[row]
        begin = time.perf_counter()
        expected = reference(end, q_base, grasp)
        seconds += time.perf_counter() - begin
        got = score(end, q_base[None], grasp[None]).total[0]
        error = max(error, abs(got - expected))
    return seconds / sample, error


if __name__ == "__main__":
    main()
