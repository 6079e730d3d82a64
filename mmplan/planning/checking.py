"""Checks of whole paths against a world, at a resolution in metres."""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from mmplan.planning.sweep import sweep_of
from mmplan.planning.world import PlanningWorld
from mmplan.shapes import Array, read_only


class PathChecker:
    """Checks edges and paths of one world, and counts what it checked.

    An edge is a straight line between two configurations. It is checked at so many
    configurations that no point of the robot, nor of what it carries, moves more than
    `resolution` (m) from one to the next.
    """

    def __init__(self, world: PlanningWorld, resolution: float) -> None:
        """Compute the lever arms of the robot as it is in this world."""
        self.world = world
        self.resolution = resolution
        self.sweep = sweep_of(world)
        self.states = 0
        self.edges = 0

    def states_free(self, q: Array) -> bool:
        """Whether all of the configurations (n, nq) are free of collision."""
        self.states += len(q)
        return not self.world.any_collision(q)

    def first_hit(self, q: Array) -> int | None:
        """The first of the configurations (n, nq) in collision, None if none is."""
        if self.states_free(q):
            return None
        return int(np.argmax(self.world.in_collision(q)))

    def edge_free(self, q_from: Array, q_to: Array) -> bool:
        """Whether an edge is free of collision, its first end taken as checked."""
        dq = q_to - q_from
        self.edges += 1
        return self.states_free(q_from + coarse_to_fine(int(self.steps(dq))) * dq)

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
        steps = np.ceil(self.sweep.distance(dq) / self.resolution)
        return np.maximum(steps, 1).astype(np.int64)


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


@lru_cache(maxsize=4096)
def coarse_to_fine(steps: int) -> Array:
    """The fractions 1/steps, 2/steps, ..., 1 as a column, by bisection: 1 comes first.

    Neighbours collide together, so that this order meets an obstacle early.
    """
    index = np.arange(steps)
    bits = max(1, int(steps - 1).bit_length())
    reversed_bits = sum(((index >> b) & 1) << (bits - 1 - b) for b in range(bits))
    order = np.argsort(reversed_bits, kind="stable")
    return read_only(1.0 - order[:, None] / steps)
