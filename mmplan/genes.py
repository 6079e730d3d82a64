"""Boxes of genes: where they are drawn from, mutated within and kept inside."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class GeneSpace:
    """Bounds of d genes; a periodic gene wraps around where others stop."""

    lower: Array  # (d,)
    upper: Array  # (d,)
    periodic: npt.NDArray[np.bool_]  # (d,)

    def __len__(self) -> int:
        """The number of genes."""
        return len(self.lower)

    @property
    def range(self) -> Array:
        """The width of each gene's interval, (d,)."""
        return self.upper - self.lower

    def sample(self, n: int, rng: np.random.Generator) -> Array:
        """Genomes (n, d), uniform within the bounds."""
        return rng.uniform(self.lower, self.upper, (n, len(self)))

    def contain(self, genomes: Array) -> Array:
        """The genomes (n, d) with each gene wrapped or clipped into its bounds."""
        width = np.where(self.range > 0.0, self.range, 1.0)
        wrapped = self.lower + np.mod(genomes - self.lower, width)
        clipped = np.clip(genomes, self.lower, self.upper)
        return np.where(self.periodic, wrapped, clipped)

    def apart(self, a: Array, b: Array) -> Array:
        """How far genomes (..., d) are apart, as shares of the ranges, (..., d).

        The short way round for a periodic gene; 0 for a gene that cannot vary.
        """
        width = np.where(self.range > 0.0, self.range, np.inf)
        share = np.abs(a - b) / width
        return np.where(self.periodic, np.minimum(share, 1.0 - share), share)
