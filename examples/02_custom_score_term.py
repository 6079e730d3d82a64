"""A term of one's own in the score: stay near where the robot starts.

A term is called with configurations and says a value for each. A value of 1 with a
weight of 1 counts 50 points, as the other terms do at the robot's scale.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import mmplan
from mmplan.problem import Problem, WeightedTerm
from mmplan.scoring import Grasped

SCENE = Path(__file__).parent / "cup.yaml"


@dataclass(frozen=True, eq=False)
class Nearness:
    """1 where the base starts, half of that a metre away."""

    problem: Problem

    def __call__(self, grasped: Grasped) -> np.ndarray:
        """The value of each configuration (n, nq), (n,)."""
        base = self.problem.robot.base.indices[:2]
        away = grasped.q[:, base] - self.problem.q_start[base]
        return 1.0 / (1.0 + np.linalg.norm(away, axis=1))


def main() -> None:
    """Solve with and without the term, and compare how far the base goes."""
    problem = mmplan.load_problem(SCENE)
    for weight in (0.0, 3.0):
        term = WeightedTerm("nearness", Nearness(problem), weight)
        wanted = replace(problem, score=replace(problem.score, more=(term,)))
        (task,) = mmplan.solve(wanted, seed=1).tasks
        away = np.linalg.norm(task.start.base - problem.q_start[:2])
        scores = {name: round(value, 1) for name, value in task.start.scores.items()}
        print(f"weight {weight}: base goes {away:.2f} m to the cup, scores {scores}")


if __name__ == "__main__":
    main()
