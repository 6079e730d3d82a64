"""Random sampling: the paper's baseline (section V)."""

from __future__ import annotations

import numpy as np

from mmplan.optimizers.joint import JointSearch, Triples, sample_triples
from mmplan.optimizers.optimizer import SearchSpace
from mmplan.problem import OptimizerSettings
from mmplan.shapes import Array

_BATCH = 256


class RandomSampling(JointSearch):
    """Triples of start base, goal base and grasp, drawn independently.

    Bases come from the same annuli as co-evolution's first populations and grasps from
    the same bounds. No more are drawn at once than can be evaluated at both ends.
    """

    def __init__(
        self,
        space: SearchSpace,
        settings: OptimizerSettings,  # noqa: ARG002 (it has none to make)
        rng: np.random.Generator,
    ) -> None:
        """Start with nothing drawn; `settings` are not needed."""
        super().__init__(space)
        self._rng = rng

    def propose(self, most: int) -> Triples:
        """Triples drawn anew."""
        return sample_triples(self._space, min(_BATCH, most), self._rng)

    def learn(self, scores: Array) -> None:
        """Nothing: every draw is independent of those before."""
