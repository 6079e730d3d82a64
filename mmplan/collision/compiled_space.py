"""Answers to a planner in compiled code, from its own coordinates to the verdict."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mmplan.collision import kernels
from mmplan.collision.pairs import CERTAIN
from mmplan.collision.planner_space import PlannerSpace

if TYPE_CHECKING:
    from mmplan.collision.compiled_broadphase import CompiledBroadphase

_VERDICTS = {0: True, CERTAIN: False}


class CompiledSpace:
    """Tells at once which points and edges are free where bounds settle that.

    With None it leaves the others to who asks coal. Nine of ten questions are settled,
    in a fraction of the time that Python takes to put them in configurations.
    """

    def __init__(self, broadphase: CompiledBroadphase, space: PlannerSpace) -> None:
        """Answer with a broadphase's bounds."""
        followers = np.array(space.followers, dtype=np.float64).reshape(-1, 4)
        self._broadphase = broadphase
        self._places, self._rows, self._followers = space.places, space.rows, followers
        self._resolution = space.resolution

    def state_free(self, point: list[float]) -> bool | None:
        """Whether a point (k,) is free, if that is settled."""
        found = kernels.check_state(
            np.array(point),
            self._places,
            self._rows,
            self._followers,
            *self._broadphase.known,
        )
        return _VERDICTS.get(found)

    def edge_free(self, ends: list[float]) -> bool | None:
        """Whether all steps of an edge are free, if settled; both ends, (2 k,)."""
        found = kernels.check_edge(
            np.array(ends),
            self._places,
            self._rows,
            self._followers,
            self._resolution,
            *self._broadphase.known,
        )
        return _VERDICTS.get(found)

    @property
    def steps(self) -> int:
        """Into how many steps the last edge was cut."""
        return int(self._broadphase.known[1][kernels.STEPS])
