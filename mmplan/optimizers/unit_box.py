"""Joint vectors in a unit box, for optimizers that know of numbers alone."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from mmplan.genes import GeneSpace
from mmplan.optimizers.joint import Triples
from mmplan.optimizers.optimizer import SearchSpace
from mmplan.scoring import End
from mmplan.shapes import Array


class UnitBox:
    """The genes of start base, goal base and grasp in a row, each scaled to [0, 1].

    The bounds are those of the genes: for bases the annulus and offsets of at most
    0.2 m. A periodic gene, an angle, has no bounds: any real number stands for a
    place on its circle, so that an optimizer may go round it either way. It is to keep
    all others within [0, 1]; what lies outside is clipped.
    """

    def __init__(self, space: SearchSpace) -> None:
        """Put the genes of a search space in a row."""
        self._space = space
        blocks = [*(space.bases[end].genes for end in End), space.grasps]
        self._genes = GeneSpace(
            np.concatenate([b.lower for b in blocks]),
            np.concatenate([b.upper for b in blocks]),
            np.concatenate([b.periodic for b in blocks]),
        )
        self._cuts = np.cumsum([len(b) for b in blocks])[:-1]

    def __len__(self) -> int:
        """The number of genes, d."""
        return len(self._genes)

    @property
    def periodic(self) -> npt.NDArray[np.bool_]:
        """Which genes are angles, (d,)."""
        return self._genes.periodic

    def triples(self, vectors: Array) -> Triples:
        """What joint vectors (n, d) stand for."""
        genomes = self._genes.contain(self._genes.lower + vectors * self._genes.range)
        start, goal, grasps = np.split(genomes, self._cuts, axis=1)
        bases = self._space.bases
        return Triples(
            bases[End.START].q_base(start), bases[End.GOAL].q_base(goal), grasps
        )

    def sample(self, n: int, rng: np.random.Generator) -> Array:
        """Joint vectors (n, d): bases drawn from the annuli, clear of collision.

        Raises:
            NoPlanError: There is no room for the base around the object.
        """
        bases = [self._space.bases[end].sample(n, rng) for end in End]
        genomes = np.concatenate([*bases, self._space.grasps.sample(n, rng)], axis=1)
        width = np.where(self._genes.range > 0.0, self._genes.range, 1.0)
        unit: Array = (genomes - self._genes.lower) / width
        return unit
