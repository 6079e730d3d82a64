"""Base placements as genes: polar coordinates about the object, plus offsets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mmplan.exceptions import NoPlanError
from mmplan.genes import GeneSpace
from mmplan.shapes import Array

# The genes for offsets in x and y stay within this (paper, section IV.B), m.
OFFSET = 0.2
_MAX_DRAWS = 1000


@dataclass(frozen=True)
class BasePlacements:
    """The base placements about an object at one end of the task.

    Four genes: distance (m) from the object's centre of mass, between the base's
    radius and the reach of the stretched arm; direction (rad); offsets in x and y (m)
    of at most 0.2 either way, by which later generations improve (paper, IV.B).
    """

    centre: tuple[float, float]  # the object's centre of mass, x and y in the world
    inner: float  # the base's radius, m
    outer: float  # the reach, m
    is_free: Callable[[Array], npt.NDArray[np.bool_]]  # of q_base (n, 2)

    @property
    def genes(self) -> GeneSpace:
        """The bounds of the four genes."""
        return GeneSpace(
            np.array([self.inner, -np.pi, -OFFSET, -OFFSET]),
            np.array([self.outer, np.pi, OFFSET, OFFSET]),
            np.array([False, True, False, False]),
        )

    def q_base(self, genes: Array) -> Array:
        """The base joints (n, 2) that genes (n, 4) stand for."""
        distance, angle, dx, dy = genes.T
        x = self.centre[0] + distance * np.cos(angle) + dx
        y = self.centre[1] + distance * np.sin(angle) + dy
        return np.stack([x, y], axis=1)

    def nearest(self, q_base: Array) -> Array:
        """Base joints (n, 2) that genes can stand for, near those given.

        The polar coordinates go as far as their bounds allow, the offsets do the rest.
        """
        away = q_base - np.array(self.centre)
        distance = np.linalg.norm(away, axis=1)
        genes = np.zeros((len(q_base), 4))
        genes[:, 0] = np.clip(distance, self.inner, self.outer)
        genes[:, 1] = np.arctan2(away[:, 1], away[:, 0])
        offset = q_base - self.q_base(genes)
        genes[:, 2:] = np.clip(offset, -OFFSET, OFFSET)
        return self.q_base(genes)

    def sample(self, n: int, rng: np.random.Generator) -> Array:
        """Genes (n, 4) uniform over the annulus, offsets 0, base free of collision.

        Raises:
            NoPlanError: The base is in collision nearly everywhere in the annulus.
        """
        found = np.empty((0, 4))
        for _ in range(_MAX_DRAWS):
            drawn = np.zeros((2 * n, 4))
            area = rng.uniform(self.inner**2, self.outer**2, 2 * n)
            drawn[:, 0] = np.sqrt(area)
            drawn[:, 1] = rng.uniform(-np.pi, np.pi, 2 * n)
            found = np.concatenate([found, drawn[self.is_free(self.q_base(drawn))]])
            if len(found) >= n:
                return found[:n]
        x, y = self.centre
        raise NoPlanError(
            f"there is no room for the base within reach of ({x:.3f}, {y:.3f}): "
            f"{2 * n * _MAX_DRAWS} placements {self.inner:.2f} m to {self.outer:.2f} m "
            "away were in collision or out of bounds"
        )
