"""Random sampling: the paper's baseline (section V)."""

from __future__ import annotations

import numpy as np

from mmplan.optimizers.archive import Archive, Triple, distinct
from mmplan.optimizers.optimizer import Queries, SearchSpace
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End
from mmplan.shapes import Array

_BATCH = 256


class RandomSampling:
    """Triples of start base, goal base and grasp, drawn independently.

    Bases come from the same annuli as co-evolution's first populations and grasps from
    the same bounds. A triple costs one evaluation where its start fails and two
    otherwise.
    """

    cycles = None

    def __init__(
        self,
        space: SearchSpace,
        settings: OptimizerSettings,  # noqa: ARG002 (it has none to make)
        rng: np.random.Generator,
    ) -> None:
        """Start with nothing drawn; `settings` are not needed."""
        self._space = space
        self._rng = rng
        self._starts: Queries | None = None  # asked for, not yet told
        self._goals: list[Queries] = []  # to ask for: goals of feasible starts
        self._drawn_goals: Array = np.empty((0, 2))

    def ask(self, limit: int) -> Queries:
        """The goals of the triples whose start is feasible, else starts of new ones."""
        if self._goals:
            self._starts = None
            return self._goals.pop().head(limit)
        n = min(_BATCH, limit)
        start, goal = (self._space.bases[end] for end in End)
        self._drawn_goals = goal.q_base(goal.sample(n, self._rng))
        self._starts = Queries(
            np.full(n, End.START, np.int8),
            start.q_base(start.sample(n, self._rng)),
            self._space.grasps.sample(n, self._rng),
        )
        return self._starts

    def tell(self, totals: Array) -> None:
        """Remember which starts are feasible."""
        if self._starts is None:
            return
        good = totals > 0.0
        if good.any():
            n = int(good.sum())
            self._goals.append(
                Queries(
                    np.full(n, End.GOAL, np.int8),
                    self._drawn_goals[good],
                    self._starts.grasps[good],
                )
            )

    def candidates(self, archive: Archive, most: int) -> list[Triple]:
        """The best triples drawn; both ends are feasible."""
        return distinct(archive.triples(), self._space.grasps, most)
