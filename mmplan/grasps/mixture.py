"""Several families of one object as one: which family is one more gene."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mmplan.genes import GeneSpace
from mmplan.grasps.family import GraspFamily
from mmplan.shapes import Array


@dataclass(frozen=True)
class Mixture:
    """The first gene picks the family, the others are its genes, scaled to [0, 1].

    A family with fewer genes than the longest leaves the last ones unused. Crossover
    of two members of one family exchanges like genes for like, as without a mixture.
    A child of two families belongs to one of them and takes the scaled genes of the
    other for its own: always a valid grasp, in effect a mutation, and less than that
    where the families are alike, since all put their genes in the same order: first
    where on the object, then from which direction, then the rest. One population thus
    holds all families, and those that do not serve the task die out of it.
    """

    families: tuple[GraspFamily, ...]

    @property
    def genes(self) -> GeneSpace:
        """The family's number and the scaled genes."""
        longest = max(len(f.genes) for f in self.families)
        upper = np.concatenate([[float(len(self.families))], np.ones(longest)])
        return GeneSpace(np.zeros(longest + 1), upper, np.zeros(longest + 1, np.bool_))

    def family_of(self, genes: Array) -> npt.NDArray[np.int64]:
        """Which family each genome (n, d) belongs to, (n,)."""
        last = len(self.families) - 1
        return np.minimum(genes[:, 0].astype(np.int64), last)

    def tool_poses(self, genes: Array) -> Array:
        """The poses T_object_tool (n, 4, 4)."""
        poses = np.empty((len(genes), 4, 4))
        for rows, family, own in self._by_family(genes):
            poses[rows] = family.tool_poses(own)
        return poses

    def quality(self, genes: Array) -> Array:
        """The quality of each grasp as its family rates it, (n,)."""
        quality = np.empty(len(genes))
        for rows, family, own in self._by_family(genes):
            quality[rows] = family.quality(own)
        return quality

    def _by_family(
        self, genes: Array
    ) -> list[tuple[npt.NDArray[np.bool_], GraspFamily, Array]]:
        """For each family the rows that belong to it and their genes in its bounds."""
        which = self.family_of(genes)
        parts = []
        for number, family in enumerate(self.families):
            rows = which == number
            space = family.genes
            unit = genes[rows, 1 : 1 + len(space)]
            parts.append((rows, family, space.lower + unit * space.range))
        return parts
