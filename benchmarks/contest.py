"""Optimizers against each other at equal budgets, on the same scenes and seeds.

    python benchmarks/contest.py [SCENE ...] [--optimizers coevolution,random,...]
        [--budgets 500,2000,6940] [--seeds 5] [--first-seed 0] [--jobs 1]

SCENE is the name of a shipped scene or the path of a file; without any, both of the
paper's problems. An optimizer with a budget of its own, such as `blockwise@1000`, keeps
to it in every table, which is how searches that take equally long are compared. One row
an optimizer: mean and standard deviation of the best sum of
both scores (0 where no joint candidate was found), the share of seeds with one, and
the median of the CPU seconds. Below, how far the first optimizer named is ahead of each
other: the mean of the differences on equal seeds with a 95 % bootstrap interval.
"""

from __future__ import annotations

import argparse
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from functools import lru_cache
from itertools import islice, product
from multiprocessing import get_context
from typing import NamedTuple

import numpy as np

import mmplan
from mmplan.benchmarking.statistics import difference, spread
from mmplan.optimizers import OPTIMIZERS, optimize, search_space
from mmplan.pipeline import score_function, task_generators
from mmplan.problem import Problem


class Run(NamedTuple):
    """One search."""

    scene: str
    budget: int
    optimizer: str
    seed: int


class Result(NamedTuple):
    """What it came to."""

    score: float  # of the best joint candidate that it hands on
    seconds: float  # of CPU time


def main() -> None:
    """Run the contest and print a table for each scene and budget."""
    options = _options()
    names = options.optimizers.split(",")
    budgets = [int(text) for text in options.budgets.split(",")]
    seeds = range(options.first_seed, options.first_seed + options.seeds)
    runs = [Run(*r) for r in product(options.scenes, budgets, names, seeds)]
    context = get_context("spawn")
    with ProcessPoolExecutor(options.jobs, mp_context=context) as pool:
        results = zip(runs, pool.map(_search, runs), strict=True)
        for scene, budget in product(options.scenes, budgets):
            of_table = islice(results, len(names) * len(seeds))
            found: dict[str, dict[int, Result]] = {name: {} for name in names}
            for run, result in of_table:
                found[run.optimizer][run.seed] = result
            print(f"\n{scene}, {budget} evaluations, {len(seeds)} seeds")
            _print_scores(found)
            _print_differences(found)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*", default=["wineglass", "plate"])
    parser.add_argument("--optimizers", default="blockwise,coevolution,random")
    parser.add_argument("--budgets", default="500,2000,6940")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--first-seed", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    options = parser.parse_args()
    for name in options.optimizers.split(","):
        optimizer, at, budget = name.partition("@")
        if optimizer not in OPTIMIZERS:
            parser.error(f"{name}: there is {', '.join(OPTIMIZERS)}")
        if at and not budget.isdecimal():
            parser.error(f"{name}: a budget is a number, as in {optimizer}@1000")
    return options


@lru_cache(maxsize=4)
def _problem(scene: str) -> Problem:
    return mmplan.load_problem(scene)


def _search(run: Run) -> Result:
    """One search with the random numbers of `mmplan solve` and the same seed."""
    problem = _problem(run.scene)
    name, _, own_budget = run.optimizer.partition("@")
    budget = int(own_budget or run.budget)
    settings = replace(problem.optimizer, name=name, evaluations=budget)
    rng = task_generators(problem, run.seed)[0]
    begin = time.process_time()
    score = score_function(problem)
    optimizer = OPTIMIZERS[name](search_space(score), settings, rng)
    found = optimize(score, optimizer, budget, candidates=1)
    seconds = time.process_time() - begin
    best = found.candidates[0].total if found.candidates else 0.0
    return Result(best, seconds)


def _print_scores(found: dict[str, dict[int, Result]]) -> None:
    for name, by_seed in found.items():
        scores = [result.score for result in by_seed.values()]
        total = spread(scores)
        success = np.mean(np.array(scores) > 0.0)
        seconds = np.median([result.seconds for result in by_seed.values()])
        print(
            f"  {name:24s} {total.mean:7.2f} ± {total.deviation:5.2f}   "
            f"success {success:4.0%}   {seconds:6.2f} s"
        )


def _print_differences(found: dict[str, dict[int, Result]]) -> None:
    ahead, *others = found
    scores = {
        name: {seed: result.score for seed, result in by_seed.items()}
        for name, by_seed in found.items()
    }
    for name in others:
        d = difference(scores[ahead], scores[name])
        if d is not None:
            print(
                f"  {ahead} - {name:24s} {d.mean:+7.2f} "
                f"[{d.low:+.2f}, {d.high:+.2f}]   p = {d.p:.2g}"
            )


if __name__ == "__main__":
    main()
