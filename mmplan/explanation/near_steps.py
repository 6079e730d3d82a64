"""Random steps from one pair of base and grasp to others near it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mmplan.optimizers import Queries, SearchSpace
from mmplan.scoring import End, ScoreFunction
from mmplan.shapes import Array

_SHRINK = 50.0  # the last step is that much smaller than the first


@dataclass(frozen=True, eq=False)
class Steps:
    """Steps at one end of a task; those with the `same_grasp` move the base alone."""

    score: ScoreFunction
    space: SearchSpace
    end: End
    rng: np.random.Generator
    same_grasp: bool = False

    def sizes(self, first: float, count: int) -> Iterator[float]:
        """The sizes of some steps, falling: m, and the share of a gene's range."""
        yield from np.geomspace(first, first / _SHRINK, count).tolist()

    def pair(self, q_base: Array, grasp: Array) -> Queries:
        """A base (b,) and genes (g,) as a single query."""
        return Queries(np.full(1, self.end, np.int8), q_base[None], grasp[None])

    def taken(self, q_base: Array, grasp: Array, size: float) -> Queries:
        """The pair a step away from a base (b,) and genes (g,), within all bounds."""
        low, high = self.score.problem.base_bounds.T
        q_base = np.clip(q_base + self.rng.normal(0.0, size, len(q_base)), low, high)
        if not self.same_grasp:
            genes = self.space.grasps
            step = self.rng.normal(0.0, size, len(grasp)) * genes.range
            grasp = genes.contain(grasp + step)
        return self.pair(q_base, grasp)
