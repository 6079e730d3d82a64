"""What the adapters to libraries of optimizers share."""

from __future__ import annotations

import importlib
from abc import abstractmethod
from typing import Any

import numpy as np

from mmplan.exceptions import InputError
from mmplan.optimizers.joint import JointSearch, Triples, joint_values
from mmplan.optimizers.optimizer import SearchSpace
from mmplan.optimizers.unit_box import UnitBox
from mmplan.shapes import Array


class Contender(JointSearch):
    """A joint search by a library that minimizes one number over a unit box.

    A subclass proposes vectors and is told their costs: the negative `joint_values`.
    """

    def __init__(self, space: SearchSpace, rng: np.random.Generator) -> None:
        """Begin with the box of a search space."""
        super().__init__(space)
        self.box = UnitBox(space)
        self.rng = rng
        self._vectors: Array = np.empty((0, len(self.box)))

    @abstractmethod
    def next_vectors(self) -> Array:
        """The next joint vectors (n, d)."""

    @abstractmethod
    def take_costs(self, vectors: Array, costs: Array) -> None:
        """Take the costs (n,) of the vectors (n, d) given last."""

    def propose(self, most: int) -> Triples:  # noqa: ARG002 (a library's batch is whole)
        """The triples of the next vectors."""
        self._vectors = self.next_vectors()
        return self.box.triples(self._vectors)

    def learn(self, scores: Array) -> None:
        """Hand on the costs."""
        self.take_costs(self._vectors, -joint_values(scores))


def library(optimizer: str, module: str, package: str) -> Any:
    """The module of a library that only one optimizer needs.

    Raises:
        InputError: It is not installed.
    """
    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        if error.name is None or module.split(".")[0] != error.name.split(".")[0]:
            raise
        raise InputError(
            f"optimizer {optimizer!r} needs {package}: pip install 'mmplan[contenders]'"
        ) from error


def seed_of(rng: np.random.Generator) -> int:
    """A seed for a library, drawn from the random numbers that were passed in."""
    return int(rng.integers(1, 2**31))
