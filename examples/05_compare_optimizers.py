"""Compare optimizers on one scene, at the same budget and on the same seeds.

For a comparison that deserves the name, with statistics and a report, there is
`mmplan benchmark`.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import mmplan
from mmplan.optimizers import OPTIMIZERS, optimize, search_space
from mmplan.pipeline import score_function

SCENE = Path(__file__).parent / "cup.yaml"
EVALUATIONS, SEEDS = 600, range(3)


def main() -> None:
    """Print the best scores that each of three optimizers finds."""
    problem = mmplan.load_problem(SCENE)
    score = score_function(problem)
    settings = replace(
        problem.optimizer, evaluations=EVALUATIONS, bases=16, grasps=12, partners=3
    )
    for name in ("random", "coevolution", "blockwise"):
        best = []
        for seed in SEEDS:
            rng = np.random.default_rng(seed)
            optimizer = OPTIMIZERS[name](search_space(score), settings, rng)
            found = optimize(score, optimizer, EVALUATIONS, candidates=1)
            best.append(found.candidates[0].total if found.candidates else 0.0)
        print(f"{name:12} {np.mean(best):6.1f} ± {np.std(best):.1f}")


if __name__ == "__main__":
    main()
