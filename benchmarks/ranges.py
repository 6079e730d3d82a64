"""What it gains that edges of a planner's trees have several lengths in turn.

    for family in bin kitchen shelf table; do
        mmplan generate --family $family --count 6 --seed 77 --difficulty 0.75 -o gen/
        mmplan generate --family $family --count 4 --seed 911 --difficulty 0.95 -o gen/
    done
    python benchmarks/ranges.py gen/*.yaml [--seeds 2] [--ranges 1.5 0.4 ...]

Every scene is solved with edges of each length alone, and with several in turn, for the
same seeds. CPU seconds are those of whole runs, also of those that find nothing.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from typing import NamedTuple

import numpy as np

import mmplan
from mmplan.collision import compile_motions
from mmplan.problem import Problem


class Run(NamedTuple):
    """What came of one seed."""

    seconds: float  # CPU
    solved: bool
    candidates: int  # begun, some of them twice
    duration: float  # s, of the motion


def main() -> None:
    """Print a row for each range, over all scenes."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="+")
    parser.add_argument("--seeds", type=int, default=2)
    parser.add_argument("--ranges", type=float, nargs="+", default=[1.5, 0.4, 0.2])
    options = parser.parse_args()
    compile_motions()
    mmplan.solve(mmplan.load_problem("wineglass"))  # loads what is loaded when needed
    ranges = [None, *options.ranges]
    runs: dict[float | None, list[Run]] = {longest: [] for longest in ranges}
    for scene in options.scenes:
        problem = mmplan.load_problem(scene)
        for seed in range(options.seeds):
            for longest in ranges:
                runs[longest].append(_run(problem, longest, seed))
    print(
        "| range, m | solved | candidates begun | motion, s, median "
        "| CPU s, median / 95 % | mean |"
    )
    print("|" + " --- |" * 6)
    for longest in ranges:
        print(_row(longest, runs[longest]))


def _run(problem: Problem, longest: float | None, seed: int) -> Run:
    planner = replace(problem.planner, range=longest)
    begun: list[int] = []

    def note(what: str, done: int, of: int | None) -> None:
        if what == "planning" and done != of:
            begun.append(done)

    begin = time.process_time()
    try:
        plan = mmplan.solve(replace(problem, planner=planner), seed=seed, progress=note)
    except mmplan.NoPlanError:
        plan = None
    seconds = time.process_time() - begin
    duration = plan.duration if plan is not None else 0.0
    return Run(seconds, plan is not None, len(begun), duration)


def _row(longest: float | None, runs: list[Run]) -> str:
    seconds = [run.seconds for run in runs]
    durations = [run.duration for run in runs if run.solved]
    median, most = np.percentile(seconds, [50, 95])
    return (
        f"| {longest or 'in turn'} | {len(durations)} of {len(runs)} "
        f"| {sum(run.candidates for run in runs)} | {np.median(durations):.2f} "
        f"| {median:.2f} / {most:.2f} | {np.mean(seconds):.2f} |"
    )


if __name__ == "__main__":
    main()
