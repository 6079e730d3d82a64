"""Differential evolution on the joint vector, by the library pymoo."""

from __future__ import annotations

from typing import Any

import numpy as np

from mmplan.optimizers.contender import Contender, library, seed_of
from mmplan.optimizers.optimizer import SearchSpace
from mmplan.problem import OptimizerSettings
from mmplan.shapes import Array

_POPULATION = 40


class DifferentialEvolution(Contender):
    """Differential evolution (DE/best/1/bin, the library's default), 40 vectors.

    The first population comes from the annuli. Genes that leave the unit box are
    repaired by the library's bounce back, angles as well: the library has bounds for
    all genes or none.
    """

    def __init__(
        self,
        space: SearchSpace,
        settings: OptimizerSettings,  # noqa: ARG002 (it has none to make)
        rng: np.random.Generator,
    ) -> None:
        """Draw the first population; `settings` are not needed.

        Raises:
            InputError: The library is not installed.
            NoPlanError: There is no room for the base around the object.
        """
        super().__init__(space, rng)
        self._algorithm = self._start()
        self._asked: Any = None

    def next_vectors(self) -> Array:
        """The next generation of trial vectors."""
        self._asked = self._algorithm.ask()
        return np.array(self._asked.get("X"))

    def take_costs(self, vectors: Array, costs: Array) -> None:  # noqa: ARG002
        """Let the better of each vector and its trial survive."""
        self._asked.set("F", costs[:, None])
        self._algorithm.tell(infills=self._asked)

    def _start(self) -> Any:
        name = "differential_evolution"
        module = library(name, "pymoo.algorithms.soo.nonconvex.de", "pymoo")
        problem = library(name, "pymoo.core.problem", "pymoo").Problem
        endless = library(name, "pymoo.core.termination", "pymoo").NoTermination
        algorithm = module.DE(
            pop_size=_POPULATION, sampling=self.box.sample(_POPULATION, self.rng)
        )
        box = problem(n_var=len(self.box), n_obj=1, xl=0.0, xu=1.0)
        algorithm.setup(box, termination=endless(), seed=seed_of(self.rng))
        return algorithm
