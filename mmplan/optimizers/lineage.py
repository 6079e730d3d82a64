"""A joint candidate under refinement, and how far and which way its steps go."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.optimizers.archive import Triple
from mmplan.optimizers.bases import BASE_SCALES
from mmplan.scoring import End
from mmplan.shapes import Array

# First steps: of the bases in m (of their headings as `BASE_SCALES` has it), of grasp
# genes in shares of their ranges.
_BASE_STEP = 0.15
_GRASP_STEP = 0.12
_LEARNING = 0.15
_GROWTH, _SHRINKAGE = 1.35, 0.94
_CONVERGED = 0.01


@dataclass(eq=False)
class Lineage:
    """The best triple of one line of descent with its distribution of steps.

    Steps are normal; their covariance (d, d) is learned from those that succeeded, as
    in the (1+1)-CMA-ES (Igel, Suttorp and Hansen 2006), in the order start base, goal
    base, grasp. `scale` grows with success and shrinks without.
    """

    triple: Triple
    covariance: Array
    scale: float = 1.0

    @classmethod
    def of(cls, triple: Triple) -> Lineage:
        """A line that begins at a triple."""
        bases = [_BASE_STEP * BASE_SCALES[: len(q)] for q in triple.q_base]
        deviations = np.concatenate([*bases, [_GRASP_STEP] * len(triple.grasp)])
        return cls(triple, np.diag(np.square(deviations)))

    @property
    def converged(self) -> bool:
        """Whether steps have become too small to matter."""
        return self.scale < _CONVERGED

    def grasp_step(self, rng: np.random.Generator) -> Array:
        """A step of the grasp, (genes,), in shares of the ranges."""
        grasp = self._grasp
        root = np.linalg.cholesky(self.covariance[grasp, grasp])
        return self.scale * (root @ rng.normal(size=len(root)))

    def base_steps(
        self, end: End, grasp_step: Array, n: int, rng: np.random.Generator
    ) -> Array:
        """Steps of one base, (n, base joints), m and rad, given that of the grasp."""
        base, grasp, C = self._base(end), self._grasp, self.covariance
        gain = np.linalg.solve(C[grasp, grasp], C[grasp, base]).T
        root = np.linalg.cholesky(C[base, base] - gain @ C[grasp, base])
        spread: Array = self.scale * rng.normal(size=(n, len(root))) @ root.T
        return gain @ grasp_step + spread

    def succeed(self, triple: Triple, step: Array) -> None:
        """Go on from a better triple, which a step (d,) led to."""
        z = step / self.scale
        self.covariance = (1.0 - _LEARNING) * self.covariance
        self.covariance += _LEARNING * np.outer(z, z)
        self.triple = triple
        self.scale = min(1.0, self.scale * _GROWTH)

    def fail(self) -> None:
        """Make smaller steps."""
        self.scale *= _SHRINKAGE

    def _base(self, end: End) -> slice:
        first = len(self.triple.q_base[End.START]) if end == End.GOAL else 0
        return slice(first, first + len(self.triple.q_base[end]))

    @property
    def _grasp(self) -> slice:
        return slice(len(self.covariance) - len(self.triple.grasp), None)
