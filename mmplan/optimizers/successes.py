"""What has scored at one end, and draws of grasps and bases that profit by it."""

from __future__ import annotations

import numpy as np

from mmplan.genes import GeneSpace
from mmplan.optimizers.bases import BASE_SCALES, Placements
from mmplan.optimizers.optimizer import Queries
from mmplan.shapes import Array

_NEAR_GRASPS = 0.25  # share of grasps drawn near those that have scored
_NEAR_BASES = 0.5  # share of bases drawn near those that have scored
_GRASP_STEP = 0.1  # share of the range
_BASE_STEP = 0.1  # m, of headings as `BASE_SCALES` has it
_REDRAWS = 4
_MOST = 512  # latest successes that are remembered


class Successes:
    """Pairs of base and grasp above 0 at one end."""

    def __init__(
        self, placements: Placements, genes: GeneSpace, rng: np.random.Generator
    ) -> None:
        """Start with none."""
        self._placements = placements
        self._genes = genes
        self._rng = rng
        self._tries = 0
        self._hits = 0
        self._q_base = np.empty((0, placements.joints))
        self._grasps = np.empty((0, len(genes)))

    @property
    def rate(self) -> float:
        """The share of evaluations that scored; a half before there are any."""
        return (self._hits + 1) / (self._tries + 2)

    def add(self, queries: Queries, totals: Array) -> None:
        """Remember those of n evaluations that scored."""
        good = totals > 0.0
        self._tries += len(totals)
        self._hits += int(good.sum())
        self._q_base = np.concatenate([self._q_base, queries.q_base[good]])[-_MOST:]
        self._grasps = np.concatenate([self._grasps, queries.grasps[good]])[-_MOST:]

    def grasps(self, n: int) -> Array:
        """Grasps (n, d) from all of their bounds, some near successful ones."""
        drawn = self._genes.sample(n, self._rng)
        if len(self._grasps) == 0:
            return drawn
        known = self._grasps[self._rng.integers(len(self._grasps), size=n)]
        step = _GRASP_STEP * self._genes.range * self._rng.normal(size=drawn.shape)
        near = self._rng.random(n) < _NEAR_GRASPS
        return np.where(near[:, None], self._genes.contain(known + step), drawn)

    def bases(self, grasps: Array, m: int) -> Array:
        """M bases for each grasp (n, d), (n, m, b), some near those of like grasps."""
        n = len(grasps)
        drawn = self._placements.q_base(self._placements.sample(n * m, self._rng))
        drawn = drawn.reshape(n, m, self._placements.joints)
        if len(self._grasps) < m:
            return drawn
        apart = self._genes.apart(grasps[:, None], self._grasps[None])
        unlike = np.linalg.norm(apart, axis=2)
        unlike += _GRASP_STEP * self._rng.random(unlike.shape)
        like = np.argpartition(unlike, m - 1, axis=1)[:, :m]
        origin = self._q_base[like]
        scales = BASE_SCALES[: self._placements.joints]
        step = _BASE_STEP * scales * self._rng.normal(size=origin.shape)
        near = self._rng.random((n, m)) < _NEAR_BASES
        return np.where(near[..., None], self.contained(origin + step, origin), drawn)

    def contained(self, wanted: Array, origin: Array) -> Array:
        """Bases (..., b) within bounds and free of collision, near those wanted.

        One that collides is drawn nearer to its origin, which is free, time and again.
        """
        shape, n = wanted.shape, int(np.prod(wanted.shape[:-1]))
        target, start = wanted.reshape(n, shape[-1]), origin.reshape(n, shape[-1])
        result, left = start.copy(), np.arange(len(start))
        for k in range(_REDRAWS):
            part = target[left] - start[left]
            new = self._placements.nearest(start[left] + part * 0.5**k)
            good = self._placements.is_free(new)
            result[left[good]] = new[good]
            left = left[~good]
            if len(left) == 0:
                break
        return result.reshape(shape)
