"""A grasp family of one's own: a cup from straight above, the fingers across its top.

A family says the bounds of its genes and turns genes into poses of the tool frame in
the object's frame: z is the approach direction, y that in which the fingers close.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import mmplan
from mmplan.genes import GeneSpace
from mmplan.problem import Problem

SCENE = Path(__file__).parent / "cup.yaml"


@dataclass(frozen=True)
class FromAbove:
    """Two genes: the height of the pads (m), and the turn of the hand (rad)."""

    heights: tuple[float, float]

    @property
    def genes(self) -> GeneSpace:
        """The bounds of both genes; the turn goes round and round."""
        low, high = self.heights
        return GeneSpace(
            np.array([low, -np.pi]), np.array([high, np.pi]), np.array([False, True])
        )

    def tool_poses(self, genes: np.ndarray) -> np.ndarray:
        """The poses T_object_tool (n, 4, 4) of genes (n, 2)."""
        height, turn = genes.T
        T = np.zeros((len(genes), 4, 4))
        T[:, 0, 0], T[:, 1, 0] = -np.cos(turn), np.sin(turn)  # x = y × z
        T[:, 0, 1], T[:, 1, 1] = np.sin(turn), np.cos(turn)  # fingers close along y
        T[:, 2, 2] = -1.0  # straight down
        T[:, 2, 3] = height
        T[:, 3, 3] = 1.0
        return T

    def quality(self, genes: np.ndarray) -> np.ndarray:
        """All of these grasps are as good as any."""
        return np.ones(len(genes))


def with_grasps(problem: Problem, **grasps: FromAbove) -> Problem:
    """The problem with other grasps of its only object."""
    (cup,) = problem.objects
    return replace(problem, objects=(replace(cup, grasps=grasps),))


def main() -> None:
    """Solve with hands that come from above alone."""
    problem = mmplan.load_problem(SCENE)
    plan = mmplan.solve(with_grasps(problem, above=FromAbove((0.04, 0.07))), seed=1)
    (task,) = plan.tasks
    approach = task.T_object_tool[:3, 2]
    print(f"grasp '{task.grasp}', approach along {approach.round(3) + 0.0}")
    assert approach[2] == -1.0


if __name__ == "__main__":
    main()
