"""Nevergrad's portfolio Shiwa on the joint vector."""

from __future__ import annotations

from typing import Any

import numpy as np

from mmplan.optimizers.contender import Contender, library, seed_of
from mmplan.optimizers.joint import START_ONLY_VALUE
from mmplan.optimizers.optimizer import SearchSpace
from mmplan.problem import OptimizerSettings
from mmplan.shapes import Array

# Vectors at once; few, so that each can learn from nearly all before it.
_BATCH = 8
_STEP = 0.2  # first step of angles, in shares of a turn


class NevergradPortfolio(Contender):
    """Shiwa, which picks an algorithm by the number of genes and the budget.

    J. Liu et al., "Versatile black-box optimization", GECCO 2020. Its successor NGOpt
    will not do: with small budgets it fits surrogates for as long as 20 s, so that its
    results depend on the clock, and its surrogates fail with numpy 2.4.

    Joint vectors are drawn at random until one works at both ends, as for CMA-ES;
    Shiwa gets that one as its first suggestion and what is left of the budget. Angles
    are unbounded parameters, other genes are bounded by the library.
    """

    def __init__(
        self,
        space: SearchSpace,
        settings: OptimizerSettings,
        rng: np.random.Generator,
    ) -> None:
        """Start without the portfolio; of the settings the budget counts.

        Raises:
            InputError: The library is not installed.
        """
        super().__init__(space, rng)
        self._nevergrad = library("nevergrad", "nevergrad", "nevergrad")
        self._left = settings.evaluations
        self._portfolio: Any = None
        self._asked: list[Any] = []

    def next_vectors(self) -> Array:
        """The portfolio's next vectors, or random ones while it has no start."""
        if self._portfolio is None:
            return self.box.sample(_BATCH, self.rng)
        self._asked = [self._portfolio.ask() for _ in range(_BATCH)]
        return np.array([self._vector(*asked.value) for asked in self._asked])

    def take_costs(self, vectors: Array, costs: Array) -> None:
        """Tell the portfolio; start it with the first vector that works."""
        self._left -= len(costs) + int(np.sum(costs < 0.0))
        if self._portfolio is not None:
            for asked, cost in zip(self._asked, costs.tolist(), strict=True):
                self._portfolio.tell(asked, cost)
        elif costs.min() < -START_ONLY_VALUE:
            self._portfolio = self._start(vectors[np.argmin(costs)])

    def _start(self, vector: Array) -> Any:
        ng, angles = self._nevergrad, self.box.periodic
        free = ng.p.Array(init=vector[angles]).set_mutation(sigma=_STEP)
        bounded = ng.p.Array(init=vector[~angles], lower=0.0, upper=1.0)
        genes = ng.p.Tuple(bounded, free)
        # Its parameters know this generator of numpy's alone.
        genes.random_state = np.random.RandomState(seed_of(self.rng))
        budget = max(self._left // 2, _BATCH)  # in vectors, most of which cost two
        portfolio = ng.optimizers.Shiwa(genes, budget=budget, num_workers=_BATCH)
        portfolio.suggest((vector[~angles], vector[angles]))
        return portfolio

    def _vector(self, bounded: Array, free: Array) -> Array:
        vector = np.empty(len(self.box))
        vector[self.box.periodic] = free
        vector[~self.box.periodic] = bounded
        return vector
