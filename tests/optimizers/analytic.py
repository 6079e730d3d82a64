"""An analytic problem, so that optimizers can be tested without any geometry."""

from __future__ import annotations

from dataclasses import dataclass, field
from importlib.util import find_spec

import numpy as np
import numpy.typing as npt

from mmplan.genes import GeneSpace
from mmplan.optimizers import OPTIMIZERS, BasePlacements, Optimization, SearchSpace
from mmplan.optimizers import optimize as run
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End, Outcome, Scores
from mmplan.shapes import Array

LIBRARIES = {
    "cmaes": "cma",
    "differential_evolution": "pymoo",
    "nevergrad": "nevergrad",
}
# Optimizers of libraries are tested where the extra `contenders` is installed.
INSTALLED = [n for n in OPTIMIZERS if n not in LIBRARIES or find_spec(LIBRARIES[n])]
# Nevergrad's takes milliseconds an evaluation, too long for thousands of them.
QUICK = [n for n in INSTALLED if n != "nevergrad"]

CENTRES = {End.START: (1.0, 0.0), End.GOAL: (0.0, 1.5)}
INNER, OUTER = 0.28, 1.06
GRASPS = GeneSpace(
    np.array([0.02, -np.pi]), np.array([0.2, np.pi]), np.array([False, True])
)
# The best base at either end, off the object's middle, and the best grasp.
BEST_BASE = {End.START: np.array([0.5, 0.4]), End.GOAL: np.array([-0.3, 0.9])}
BEST_GRASP = np.array([0.07, 3.0])


def free(q_base: Array) -> npt.NDArray[np.bool_]:
    """Bases are in collision beyond x = 1.2."""
    return q_base[:, 0] <= 1.2


SPACE = SearchSpace(
    {end: BasePlacements(CENTRES[end], INNER, OUTER, free) for end in End}, GRASPS
)


def totals(end: End, q_base: Array, grasps: Array) -> Array:
    """Scores up to 100 at the best base and grasp, 0 far away from them.

    Which direction of the grasp is best depends on the base.
    """
    aside = q_base - BEST_BASE[end]
    off = np.linalg.norm(aside, axis=1)
    turn = grasps[:, 1] - BEST_GRASP[1] - 3.0 * aside[:, 0]
    turned = np.abs(np.mod(turn + np.pi, 2 * np.pi) - np.pi)
    raised = np.abs(grasps[:, 0] - BEST_GRASP[0])
    total = 100.0 * np.exp(-2.0 * off - 0.5 * turned - 10.0 * raised)
    bad = (off > 0.7) | (turned > 2.0) | ~free(q_base)
    return np.where(bad, 0.0, total)


@dataclass
class AnalyticScore:
    """Stands in for the score function and counts what it is asked for."""

    asked: list[tuple[End, Array, Array, Array]] = field(default_factory=list)

    def __call__(self, end: End, q_base: Array, grasps: Array) -> Scores:
        total = totals(end, q_base, grasps)
        self.asked.append((end, q_base, grasps, total))
        outcome = np.where(total > 0.0, Outcome.SCORED, Outcome.COLLISION)
        nothing = np.zeros((len(total), 0))
        return Scores(total, nothing, nothing, outcome.astype(np.int8))

    @property
    def count(self) -> int:
        return sum(len(total) for *_, total in self.asked)

    def pairs(self) -> dict[tuple[End, bytes, bytes], float]:
        """Every pair of base and grasp that was asked for, with its score."""
        return {
            (end, base.tobytes(), grasp.tobytes()): float(total)
            for end, q_base, grasps, found in self.asked
            for base, grasp, total in zip(q_base, grasps, found, strict=True)
        }


def optimize(
    name: str, evaluations: int, seed: int = 0, candidates: int = 10
) -> tuple[Optimization, AnalyticScore]:
    """Run an optimizer of the paper's sizes on the analytic problem."""
    score = AnalyticScore()
    rng = np.random.default_rng(seed)
    optimizer = OPTIMIZERS[name](SPACE, OptimizerSettings(), rng)
    return run(score, optimizer, evaluations, candidates), score  # type: ignore[arg-type]
