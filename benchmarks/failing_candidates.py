"""What candidates that fail cost: the most that planning several at once could gain.

    python benchmarks/failing_candidates.py [SCENE ...] [--seeds 3]

Every scene (by default each that is shipped) is solved; CPU seconds are those of whole
runs, and of the motions of candidates that came to nothing.
"""

from __future__ import annotations

import argparse
import time
from contextlib import suppress

import mmplan
from mmplan import assets
from mmplan.collision import compile_motions


class Watch:
    """Adds up what candidates take after which another one is tried."""

    def __init__(self) -> None:
        """Begin with none."""
        self.failed = 0
        self.seconds = 0.0
        self._begin: float | None = None

    def __call__(self, what: str, done: int, of: int | None) -> None:  # noqa: ARG002
        """Take note of the progress of `mmplan.solve`; so many candidates are done."""
        now = time.process_time()
        planning = what == "planning"
        if planning and done > 0 and self._begin is not None:
            self.failed += 1
            self.seconds += now - self._begin
        self._begin = now if planning else None


def main() -> None:
    """Print a row for each scene, and the sum."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--seeds", type=int, default=3)
    options = parser.parse_args()
    compile_motions()
    mmplan.solve(mmplan.load_problem("wineglass"))  # loads what is loaded when needed
    print("| scene | runs | with failures | candidates failed | failed, s | all, s |")
    print("|" + " --- |" * 6)
    rows = []
    for scene in options.scenes or assets.scene_names():
        rows.append([options.seeds, *_sums(scene, options.seeds)])
        print(_row(scene, rows[-1]), flush=True)
    print(_row("all", [sum(column) for column in zip(*rows, strict=True)]))


def _sums(scene: str, seeds: int) -> tuple[int, int, float, float]:
    """Runs with failures, candidates failed, CPU s of these and of all runs."""
    problem = mmplan.load_problem(scene)
    watches, begin = [Watch() for _ in range(seeds)], time.process_time()
    for seed, watch in enumerate(watches):
        with suppress(mmplan.NoPlanError):
            mmplan.solve(problem, seed=seed, progress=watch)
    seconds = time.process_time() - begin
    return (
        sum(watch.failed > 0 for watch in watches),
        sum(watch.failed for watch in watches),
        sum(watch.seconds for watch in watches),
        seconds,
    )


def _row(name: str, sums: list[float]) -> str:
    runs, with_failures, failed, lost, seconds = sums
    return (
        f"| {name} | {runs} | {with_failures} | {failed} | {lost:.2f} | {seconds:.2f} |"
    )


if __name__ == "__main__":
    main()
