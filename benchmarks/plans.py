"""How many seeds give a verified plan, and what that takes.

    python benchmarks/plans.py [--scenes wineglass plate ...] [--seeds 100]

Every plan is solved for, saved, loaded again and verified against the scene loaded
anew. Times are CPU seconds of `mmplan.solve` in one process, imports done: the search
for bases and grasp, then paths, timing and proof.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

import mmplan


class Run(NamedTuple):
    """What one verified plan took, and how long its motion is, s."""

    optimization: float
    paths: float
    total: float
    motion: float


def main() -> None:
    """Print a line for each scene, and one for each seed without a plan."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="+", default=["wineglass", "plate"])
    parser.add_argument("--seeds", type=int, default=100)
    options = parser.parse_args()
    print(
        "| scene | robot | seeds | verified plans | optimization s, median | paths s, "
        "median | total s, median / 95 % | motion s, median |"
    )
    print("|---|---|---|---|---|---|---|---|")
    for scene in options.scenes:
        runs = [_run(scene, seed) for seed in range(options.seeds)]
        robot = mmplan.load_problem(scene).robot.name
        print(f"| {scene} | {robot} | 0 to {options.seeds - 1} | {_cells(runs)} |")
        sys.stdout.flush()


def _cells(runs: list[Run | None]) -> str:
    """The number of plans and the columns of times."""
    found = [run for run in runs if run is not None]
    if not found:
        return "0 | | | |"
    optimization, paths, total, motion = np.array(found).T
    half, most = np.percentile(total, [50, 95])
    return (
        f"{len(found)} | {np.median(optimization):.2f} | {np.median(paths):.2f} | "
        f"{half:.2f} / {most:.2f} | {np.median(motion):.1f}"
    )


def _run(scene: str, seed: int) -> Run | None:
    """What a seed took, None without a verified plan."""
    problem = mmplan.load_problem(scene)
    searched: list[float] = []

    def note(what: str, done: int, of: int | None) -> None:  # noqa: ARG001
        if what == "optimization":
            searched[:] = [time.process_time()]

    begin = time.process_time()
    try:
        plan = mmplan.solve(problem, seed=seed, progress=note)
    except mmplan.MmplanError as error:
        print(f"{scene} {seed}: {error}", flush=True)
        return None
    end = time.process_time()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plan.json"
        plan.save(path)
        mmplan.verify(mmplan.Plan.load(path), mmplan.load_problem(scene))
    return Run(searched[0] - begin, end - searched[0], end - begin, plan.duration)


if __name__ == "__main__":
    main()
