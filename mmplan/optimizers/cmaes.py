"""CMA-ES on the joint vector, by the library `cma` (Hansen)."""

from __future__ import annotations

from typing import Any

import numpy as np

from mmplan.optimizers.contender import Contender, library, seed_of
from mmplan.optimizers.joint import START_ONLY_VALUE
from mmplan.optimizers.optimizer import SearchSpace
from mmplan.problem import OptimizerSettings
from mmplan.shapes import Array

# Standard deviation of the first generation, in shares of the genes' ranges.
_STEP = 0.2
_DRAWS = 16


class CmaEs(Contender):
    """CMA-ES with the library's defaults, restarted where it has converged.

    Joint vectors are drawn at random until one works at both ends, from which CMA-ES
    starts; after it stops the same begins anew with a population twice as large
    (IPOP, Auger and Hansen 2005). Angles are unbounded, other genes are kept within
    their bounds by the library's smooth transformation.
    """

    def __init__(
        self,
        space: SearchSpace,
        settings: OptimizerSettings,  # noqa: ARG002 (it has none to make)
        rng: np.random.Generator,
    ) -> None:
        """Start without a strategy; `settings` are not needed.

        Raises:
            InputError: The library is not installed.
        """
        super().__init__(space, rng)
        self._cma = library("cmaes", "cma", "cma")
        self._strategy: Any = None
        self._population = 4 + int(3 * np.log(len(self.box)))

    def next_vectors(self) -> Array:
        """The strategy's generation, or random vectors while it has no start."""
        if self._strategy is None:
            return self.box.sample(_DRAWS, self.rng)
        return np.array(self._strategy.ask())

    def take_costs(self, vectors: Array, costs: Array) -> None:
        """Update the strategy; start it at the first vector that works."""
        if self._strategy is not None:
            self._strategy.tell(list(vectors), costs.tolist())
            if self._strategy.stop():
                self._strategy = None
                self._population *= 2
        elif costs.min() < -START_ONLY_VALUE:
            self._strategy = self._start(vectors[np.argmin(costs)])

    def _start(self, vector: Array) -> Any:
        low = [None if free else 0.0 for free in self.box.periodic]
        high = [None if free else 1.0 for free in self.box.periodic]
        options = {
            "bounds": [low, high],
            "popsize": self._population,
            "seed": seed_of(self.rng),
            "verbose": -9,
        }
        return self._cma.CMAEvolutionStrategy(vector, _STEP, options)
