"""An explicit list of grasps."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from mmplan.genes import GeneSpace
from mmplan.shapes import Array

# How many of the directions in which grasps differ most become genes.
_DIRECTIONS = 3


@dataclass(frozen=True, eq=False)
class Poses:
    """Grasps from a list, numbered so that near genes mean near grasps.

    Three genes from 0 to 1. The grasps are sorted along the direction in which their
    positions and approaches differ most (the first principal component) and cut into
    slabs of equal numbers, each slab likewise along the second component, and each
    part of it along the third. The genes say slab, part and place in it. So each
    grasp is drawn about as often as any other, and a small mutation, or a crossover
    of two grasps that are near each other, leads to a grasp nearby.
    """

    T_object_tool: Array  # (m, 4, 4), at least one
    qualities: Array | None = None  # (m,), from 0 to 1; 1 for all where not given
    names: tuple[str, ...] = field(default=())

    def __len__(self) -> int:
        """The number of grasps."""
        return len(self.T_object_tool)

    @property
    def genes(self) -> GeneSpace:
        """Slab, part of the slab, place in it."""
        zero = np.zeros(_DIRECTIONS)
        return GeneSpace(zero, zero + 1.0, np.zeros(_DIRECTIONS, np.bool_))

    def number_of(self, genes: Array) -> npt.NDArray[np.int64]:
        """Which grasp of the list each genome (n, 3) means, (n,)."""
        order, first, count = self._table
        k = len(first)
        slab, part = np.minimum((genes[:, :2] * k).astype(np.int64), k - 1).T
        size = count[slab, part]
        place = np.minimum((genes[:, 2] * size).astype(np.int64), size - 1)
        numbers: npt.NDArray[np.int64] = order[first[slab, part] + place]
        return numbers

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4)."""
        return self.T_object_tool[self.number_of(genes)]

    def quality(self, genes: Array) -> Array:
        """The quality of each grasp as the list gives it, (n,)."""
        if self.qualities is None:
            return np.ones(len(genes))
        return self.qualities[self.number_of(genes)]

    @cached_property
    def _table(self) -> tuple[npt.NDArray[np.int64], ...]:
        """The order (m,) of the grasps; begin and size of each part, (k, k)."""
        features = self._features()
        k = max(1, int(np.cbrt(len(self)) + 1e-9))
        parts = [
            np.array_split(slab[np.argsort(features[slab, 1], kind="stable")], k)
            for slab in np.array_split(np.argsort(features[:, 0], kind="stable"), k)
        ]
        sizes = np.array([[len(part) for part in slab] for slab in parts])
        order = np.concatenate(
            [p[np.argsort(features[p, 2], kind="stable")] for s in parts for p in s]
        )
        first = np.cumsum(sizes.ravel()) - sizes.ravel()
        return order, first.reshape(k, k), sizes

    def _features(self) -> Array:
        """The three principal components of positions and approaches, (m, 3)."""
        position = self.T_object_tool[:, :3, 3]
        position = position - position.mean(axis=0)
        size = np.sqrt(np.mean(np.sum(position**2, axis=1)))
        approach = self.T_object_tool[:, :3, 2]
        points = np.hstack([position / (size or 1.0), approach - approach.mean(axis=0)])
        _, _, axes = np.linalg.svd(points.T @ points)
        largest = np.abs(axes).argmax(axis=1)
        signs = np.sign(axes[np.arange(len(axes)), largest])
        projected: Array = points @ (axes * signs[:, None])[:_DIRECTIONS].T
        return projected
