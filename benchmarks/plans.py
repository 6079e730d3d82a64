"""How many seeds give a verified plan, and what that takes.

    python benchmarks/plans.py [--scenes wineglass plate] [--seeds 100]

Every plan is solved for, saved, loaded again and verified against the scene loaded
anew. Times are those of `mmplan.solve` in one process, imports done.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path

import numpy as np

import mmplan


def main() -> None:
    """Print a line for each scene, and one for each seed without a plan."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scenes", nargs="+", default=["wineglass", "plate"])
    parser.add_argument("--seeds", type=int, default=100)
    options = parser.parse_args()
    print(
        "| scene | seeds | verified plans | solve s, median / 95 % | motion s, median |"
    )
    print("|---|---|---|---|---|")
    for scene in options.scenes:
        runs = [_run(scene, seed) for seed in range(options.seeds)]
        seconds, durations = np.array([r for r in runs if r is not None]).T
        half, most = np.percentile(seconds, [50, 95])
        print(
            f"| {scene} | 0 to {options.seeds - 1} | {len(seconds)} | "
            f"{half:.2f} / {most:.2f} | {np.median(durations):.1f} |",
            flush=True,
        )


def _run(scene: str, seed: int) -> tuple[float, float] | None:
    """Seconds to solve and seconds of motion, None without a verified plan."""
    problem = mmplan.load_problem(scene)
    begin = time.perf_counter()
    try:
        plan = mmplan.solve(problem, seed=seed)
    except mmplan.MmplanError as error:
        print(f"{scene} {seed}: {error}", flush=True)
        return None
    seconds = time.perf_counter() - begin
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plan.json"
        plan.save(path)
        mmplan.verify(mmplan.Plan.load(path), mmplan.load_problem(scene))
    return seconds, plan.duration


if __name__ == "__main__":
    main()
