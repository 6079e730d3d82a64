"""Checks of whole paths against a world, at a resolution in metres."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from mmplan.collision import ROUNDING, PlannerSpace, coarse_to_fine
from mmplan.planning.sweep import sweep_of
from mmplan.planning.world import PlanningWorld, QuickAnswers, moving_part
from mmplan.shapes import Array

# How many times longer steps are where continuous checks have the last word.
COARSER = 8.0


class PathChecker:
    """Checks edges and paths of one world, and counts what it checked.

    An edge is a straight line between two configurations. It is checked at so many
    configurations that no point of the robot, nor of what it carries, moves more than
    `resolution` (m) from one to the next; with `continuous` collisions between them are
    found as well.
    """

    def __init__(
        self, world: PlanningWorld, resolution: float, *, continuous: bool = False
    ) -> None:
        """Compute the lever arms of the robot as it is in this world.

        Raises:
            ValueError: if motions of this world cannot be checked continuously.
        """
        self.world = world
        self._moving = moving_part(world)
        if continuous and self._moving is None:
            raise ValueError("this world is checked at single configurations only")
        self.continuous = continuous
        self.resolution = resolution
        self.sweep = sweep_of(world)
        self.states = 0
        self.edges = 0

    def coarser(self) -> PathChecker:
        """One that is quick, for paths that are going to be proven afterwards."""
        return PathChecker(self.world, COARSER * self.resolution)

    def in_space(self, space: PlannerSpace) -> QuickAnswers | None:
        """Quick answers in a planner's coordinates, where the world has such by now."""
        if self._moving is None or self._moving is not self.world:
            return None
        return self._moving.in_space(space)

    def states_free(self, q: Array) -> bool:
        """Whether all of the configurations (n, nq) are free of collision."""
        self.states += len(q)
        return not self.world.any_collision(q)

    def first_hit(self, q: Array) -> int | None:
        """The first of the configurations (n, nq) in collision, None if none is."""
        if self.states_free(q):
            return None
        return int(np.argmax(self.world.in_collision(q)))

    def edge_free(
        self, q_from: Array, q_to: Array, *, likely_free: bool = False
    ) -> bool:
        """Whether an edge is free of collision, its first end taken as checked.

        If it is `likely_free`, as where a coarser checker found it so, that is told
        sooner.
        """
        dq = q_to - q_from
        self.edges += 1
        if self._moving is not None and self.continuous:
            if self._moving is not self.world and not self._steps_free(q_from, dq):
                return False
            return not self._moving.motion_collides(q_from, dq, likely_free=likely_free)
        return self._steps_free(q_from, dq)

    def _steps_free(self, q: Array, dq: Array) -> bool:
        """Whether all steps from q (nq,) to q + dq are free."""
        steps = self.sweep.farthest(dq) / self.resolution
        steps = max(1, math.ceil(steps - ROUNDING))
        if self._moving is not None and self._moving is self.world:
            self.states += steps
            return not self._moving.steps_collide(q, dq, steps)
        return self.states_free(q + coarse_to_fine(steps) / steps * dq)

    def path_free(self, path: Array) -> bool:
        """Whether a polyline (n, nq) is free, its first point taken as checked."""
        edges = pairwise(path)
        return all(self.edge_free(q_from, q_to) for q_from, q_to in edges)

    def first_blocked_edge(self, path: Array) -> tuple[int, Array] | None:
        """The first edge of a polyline (n, nq) that collides, and where it does (nq,).

        Here the first point is checked too, as a part of the first edge.
        """
        dq = np.diff(path, axis=0)
        edge, fraction = even_fractions(self.steps(dq))
        q = np.vstack([path[:1], path[edge] + fraction[:, None] * dq[edge]])
        hit = self.first_hit(q)
        return None if hit is None else (int(edge[max(hit - 1, 0)]), q[hit])

    def steps(self, dq: Array) -> npt.NDArray[np.int64]:
        """Into how many steps joint moves (..., nq) must be cut, (...,), at least 1."""
        steps = self.sweep.distance(dq) / self.resolution
        return np.maximum(np.ceil(steps - ROUNDING), 1).astype(np.int64)


def even_fractions(
    counts: npt.NDArray[np.int64],
) -> tuple[npt.NDArray[np.int64], Array]:
    """Pieces cut evenly: for `counts` (n,) of parts, the parts' ends.

    Returns:
        piece: The piece of each part, (sum of counts,).
        fraction: Where on its piece each part ends, in (0, 1], (sum of counts,).
    """
    piece = np.repeat(np.arange(len(counts)), counts)
    first = np.repeat(np.cumsum(counts) - counts, counts)
    fraction: Array = (np.arange(len(piece)) - first + 1) / counts[piece]
    return piece, fraction
