"""Answers to a planner in compiled code, from its own coordinates on."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from mmplan.collision import kernels
from mmplan.collision.pairs import CERTAIN
from mmplan.collision.planner_space import PlannerSpace
from mmplan.shapes import Array

if TYPE_CHECKING:
    from mmplan.collision.compiled_broadphase import CompiledBroadphase

# Whether any of some finds collides, numbers of configurations and pairs, if the
# configurations (nq,) are those that a function gives for their numbers.
Judge: TypeAlias = Callable[[Iterable[tuple[int, int]], Callable[[int], Array]], bool]


class CompiledSpace:
    """Tells which points and edges of a planner's space are free.

    Bounds settle nine of ten questions in a fraction of the time that Python takes to
    put them in configurations; what they leave open is for a judge.
    """

    def __init__(
        self, broadphase: CompiledBroadphase, space: PlannerSpace, judge: Judge
    ) -> None:
        """Answer with a broadphase's bounds, and a judge's verdicts."""
        followers = np.array(space.followers, dtype=np.float64).reshape(-1, 4)
        self._broadphase, self._judge = broadphase, judge
        self._places, self._rows, self._followers = space.places, space.rows, followers
        self._resolution = space.resolution
        self._row = np.empty((1, len(space.q_still)))
        self._q, self._dq = np.empty((2, len(space.q_still)))

    def state_free(self, point: list[float]) -> bool:
        """Whether a point (k,) is free."""
        found = kernels.check_state(
            np.array(point),
            self._places,
            self._rows,
            self._followers,
            self._row,
            *self._broadphase.known,
        )
        if found <= 0:
            return bool(found != CERTAIN)
        if not self._broadphase.had_room(found):
            return self.state_free(point)
        finds = [(row, pair) for row, pair, _ in self._broadphase.deepest_first(found)]
        return not self._judge(finds, lambda row: self._row[row])

    def edge_free(self, ends: list[float]) -> bool:
        """Whether all steps of an edge are free; both ends, (2 k,)."""
        q, dq = self._q, self._dq
        found = kernels.check_edge(
            np.array(ends),
            self._places,
            self._rows,
            self._followers,
            self._resolution,
            q,
            dq,
            *self._broadphase.known,
        )
        if found <= 0:
            return bool(found != CERTAIN)
        if not self._broadphase.had_room(found):
            return self.edge_free(ends)
        finds = [(k, pair) for pair, k, _ in self._broadphase.deepest_first(found)]
        steps = self.steps
        return not self._judge(finds, lambda k: q + (k / steps) * dq)

    @property
    def steps(self) -> int:
        """Into how many steps the last edge was cut."""
        return int(self._broadphase.known[1][kernels.STEPS])
