"""What it gains that RRTConnect extends the smaller of its trees.

    python benchmarks/turns.py [FILE] [--robot tiago] [--seeds 5] [--range 0.4]

Every problem is solved with OMPL's RRTConnect as mmplan uses it, whose larger tree lets
its turns pass, and with the trees in turn, for the same seeds, one after the other. CPU
ms are those until a first path, proven continuously, was found.
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from pathlib import Path
from unittest.mock import patch

import numpy as np

from mmplan.benchmarking.paths.arena import PANDA, contestant, make_arena
from mmplan.benchmarking.paths.planning import own_planner
from mmplan.benchmarking.paths.problems import load_path_problems
from mmplan.benchmarking.paths.records import Answer
from mmplan.planning.turns import Turns
from mmplan.problem import PlannerSettings

PROBLEMS = Path(__file__).parent / "data" / "panda_motionbenchmaker.json.gz"


class InTurn(Turns):
    """No turn passes, as OMPL has it."""

    def begin(self) -> None:
        """Let either tree have its turn."""
        super().begin()
        self.passes = False


USED = {"in turn": InTurn, "the smaller": Turns}


def main() -> None:
    """Print a row for each family and way of choosing a tree."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("problems", nargs="?", type=Path, default=PROBLEMS)
    parser.add_argument("--robot", default=PANDA)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--range", type=float, default=0.4, metavar="M")
    options = parser.parse_args()
    settings = PlannerSettings(
        range=options.range, motion_check="continuous", shortcuts=0, time_limit=60.0
    )
    planner, robot = own_planner("RRTConnect", settings), contestant(options.robot)
    answers: dict[tuple[str, str], list[Answer]] = defaultdict(list)
    for problem in load_path_problems(options.problems).problems:
        plan = planner(make_arena(robot, problem)).plan
        plan(options.seeds)  # so that what is learnt of an arena is known
        for seed in range(options.seeds):
            for name, turns in USED.items():
                with patch("mmplan.planning.search.Turns", turns):
                    answer = plan(seed)
                answers["all", name].append(answer)
                answers[problem.family, name].append(answer)
    print("| family | tree | found | first path, ms, median / 95 % | mean | edges |")
    print("|" + " --- |" * 6)
    for (family, name), those in answers.items():
        print(f"| {family} | {name} | {_cells(those)} |")


def _cells(answers: list[Answer]) -> str:
    found = sum(a.first is not None for a in answers)
    ms = np.array([a.first_seconds for a in answers]) * 1e3
    edges = np.median([a.edges for a in answers if a.edges is not None])
    median, most = np.percentile(ms, [50.0, 95.0])
    times = f"{median:.1f} / {most:.1f} | {ms.mean():.1f}"
    return f"{found} of {len(answers)} | {times} | {edges:.0f}"


if __name__ == "__main__":
    main()
