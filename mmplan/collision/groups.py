"""Runs of things that belong together."""

from __future__ import annotations

from collections.abc import Hashable, Sequence

import numpy as np
import numpy.typing as npt

from mmplan.collision.bounds import Bounds

Indices = npt.NDArray[np.int64]


class Groups:
    """Things in a row, grouped by key; those of one key follow each other."""

    def __init__(self, keys: Sequence[Hashable]) -> None:
        """Group the things whose `keys` (m,) are equal."""
        first = [i for i, key in enumerate(keys) if i == 0 or key != keys[i - 1]]
        self.starts = np.array(first, dtype=np.int64)
        self._sizes = np.diff(np.append(self.starts, len(keys)))
        self.of = np.repeat(np.arange(len(first)), self._sizes)

    def around(self, bounds: Bounds) -> Bounds:
        """The bounds of each group, given those of its members (m, 3)."""
        if len(self.starts) == 0:
            return bounds
        low = np.minimum.reduceat(bounds.centre - bounds.half, self.starts)
        high = np.maximum.reduceat(bounds.centre + bounds.half, self.starts)
        return Bounds((low + high) / 2, (high - low) / 2)

    def any_of(self, mask: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
        """Whether any member is true: (k, m) -> (k, groups)."""
        if len(self.starts) == 0:
            return mask
        return np.logical_or.reduceat(mask, self.starts, axis=1)

    def members(self, group: Indices) -> tuple[Indices, Indices]:
        """All members of groups (k,): which of the k, and the member."""
        sizes = self._sizes[group]
        repeat = np.repeat(np.arange(len(group)), sizes)
        within = np.arange(len(repeat)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        return repeat, self.starts[group][repeat] + within
