"""What a term of the score is."""

from __future__ import annotations

from collections.abc import Callable, Hashable
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from mmplan.scoring.outcome import End
from mmplan.shapes import Array


class Grasped(NamedTuple):
    """Configurations in which the robot holds the object at one end of the task.

    `base` and `grasp` number the rows of equal base placements and of equal grasps, so
    that what depends on one of them alone is computed once.
    """

    end: End
    q: Array  # (n, nq), hand closed
    base: npt.NDArray[np.int64]  # (n,)
    grasp: npt.NDArray[np.int64]  # (n,)
    T_world_tool: Array  # (n, 4, 4), the same for equal grasps

    def take(self, places: npt.NDArray[np.int64]) -> Grasped:
        """Some of them."""
        return Grasped(
            self.end,
            self.q[places],
            self.base[places],
            self.grasp[places],
            self.T_world_tool[places],
        )


class ScoreTerm(Protocol):
    """One term of the score, larger is better."""

    def __call__(self, grasped: Grasped) -> Array:
        """The unweighted value of the term for each configuration, (n,)."""
        ...


class RowCache:
    """Rows of numbers that are computed once for each key."""

    def __init__(self) -> None:
        """Start empty."""
        self._rows: dict[Hashable, Array] = {}

    def rows(
        self,
        keys: list[Hashable],
        compute: Callable[[npt.NDArray[np.int64]], Array],
    ) -> Array:
        """The rows of all keys, (n, d).

        `compute` gets the places in `keys` of those that are new, each key once.
        """
        if not keys:
            return compute(np.empty(0, np.int64))  # (0, d)
        new = {k: i for i, k in enumerate(keys) if k not in self._rows}
        if new:
            computed = compute(np.fromiter(new.values(), np.int64, len(new)))
            self._rows.update(zip(new, computed, strict=True))
        return np.array([self._rows[k] for k in keys])

    def put(self, keys: list[Hashable], rows: Array) -> None:
        """Keep the rows (n, d) of keys that are new."""
        for key, row in zip(keys, rows, strict=True):
            self._rows.setdefault(key, row)


def row_keys(rows: Array) -> list[bytes]:
    """Hashable keys of the rows of an array (n, d)."""
    return [row.tobytes() for row in np.ascontiguousarray(rows)]
