"""How far a grasp that serves the start serves the goal, too.

Draws grasps within their bounds and bases within the annuli, as the optimizers do, and
counts which grasps are feasible at either end for at least one of the bases drawn. The
last column is the share of the grasps that work at the start which work for no base at
the goal: who picks the grasp by the start alone fails that often.

    python benchmarks/grasp_coupling.py [scenes ...] [--grasps 200] [--bases 150]
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.collision import CollisionWorld
from mmplan.grasps import GraspFamily, Mixture
from mmplan.optimizers import search_space
from mmplan.problem import Problem
from mmplan.scene_file import load_problem
from mmplan.scoring import End, Outcome, ScoreFunction


class Coupling(NamedTuple):
    """Which draws are feasible, (grasps, bases) at start and at goal."""

    start: npt.NDArray[np.bool_]
    goal: npt.NDArray[np.bool_]

    @property
    def fails_at_goal(self) -> float:
        """The share of grasps that work at the start and at the goal for no base."""
        works_at_start = self.start.any(axis=1)
        return float(np.mean(~self.goal[works_at_start].any(axis=1)))


def measure(problem: Problem, grasps: int, bases: int, seed: int) -> Coupling:
    """Test random grasps of the first task's object with random bases at both ends."""
    rng = np.random.default_rng(seed)
    task = problem.tasks[0]
    family = _family(problem, task.object)
    score = ScoreFunction(problem, task, CollisionWorld.of_problem(problem), family)
    space = search_space(score)
    drawn = space.grasps.sample(grasps, rng)
    feasible = []
    for end in End:
        q_base = space.bases[end].q_base(space.bases[end].sample(grasps * bases, rng))
        outcome = score(end, q_base, np.repeat(drawn, bases, axis=0)).outcome
        feasible.append((outcome == Outcome.SCORED).reshape(grasps, bases))
    return Coupling(*feasible)


def _family(problem: Problem, name: str) -> GraspFamily:
    families = tuple(problem.object(name).grasps.values())
    return families[0] if len(families) == 1 else Mixture(families)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print one line a scene."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "scenes", nargs="*", default=["scenes/wineglass.yaml", "scenes/plate.yaml"]
    )
    parser.add_argument("--grasps", type=int, default=200)
    parser.add_argument("--bases", type=int, default=150)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args(arguments)
    print(f"{'':12} {'pairs feasible':>19} {'grasps with a base':>29}")
    heads = ("start", "goal", "start", "goal", "both", "fail at goal")
    print(f"{'scene':12}", *(f"{head:>9}" for head in heads))
    for scene in options.scenes:
        problem = load_problem(scene)
        coupling = measure(problem, options.grasps, options.bases, options.seed)
        start, goal = coupling.start.any(axis=1), coupling.goal.any(axis=1)
        shares = [float(np.mean(s)) for s in (*coupling, start, goal, start & goal)]
        shares.append(coupling.fails_at_goal)
        print(f"{problem.name:12}", *(f"{100 * share:7.1f} %" for share in shares))


if __name__ == "__main__":
    main()
