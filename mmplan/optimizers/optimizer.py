"""What an optimizer is: it asks for scores and is told them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from mmplan.genes import GeneSpace
from mmplan.optimizers.archive import Archive, Triple
from mmplan.optimizers.bases import Placements
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End
from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class SearchSpace:
    """Where an optimizer searches: bases at both ends, grasps."""

    bases: dict[End, Placements]
    grasps: GeneSpace


class Queries(NamedTuple):
    """n evaluations of Score(q_base, grasp) that an optimizer wants."""

    end: npt.NDArray[np.int8]  # (n,) of End
    q_base: Array  # (n, base joints)
    grasps: Array  # (n, grasp genes)

    def head(self, n: int) -> Queries:
        """The first n of them."""
        return Queries(self.end[:n], self.q_base[:n], self.grasps[:n])

    def take(self, which: npt.NDArray[np.bool_ | np.int64]) -> Queries:
        """Some of them, by a mask (n,) or by their places."""
        return Queries(self.end[which], self.q_base[which], self.grasps[which])


class Optimizer(Protocol):
    """An optimizer of start base, goal base and grasp."""

    @property
    def cycles(self) -> float | None:
        """How many cycles it has gone through, where it works in cycles."""
        ...

    def ask(self, limit: int) -> Queries:
        """The next evaluations, at least one and at most `limit`."""
        ...

    def tell(self, totals: Array) -> None:
        """Take the scores (n,) of all that was asked for last."""
        ...

    def candidates(self, archive: Archive, most: int) -> list[Triple]:
        """At most `most` distinct joint candidates, best first."""
        ...


class OptimizerFactory(Protocol):
    """Makes an optimizer; an optimizer's class is one."""

    def __call__(
        self,
        space: SearchSpace,
        settings: OptimizerSettings,
        rng: np.random.Generator,
    ) -> Optimizer:
        """A fresh optimizer of a search space."""
        ...
