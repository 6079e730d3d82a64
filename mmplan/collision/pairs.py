"""Pairs of bodies, as arrays."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from mmplan.shapes import Array

Indices: TypeAlias = npt.NDArray[np.int64]
Flags: TypeAlias = npt.NDArray[np.bool_]

# Stands for a pair where something collides for sure, whichever pairs do.
CERTAIN = -1


class Suspects(NamedTuple):
    """Pairs whose bounds overlap: pair `pair[k]` in configuration `row[k]`."""

    row: Indices
    pair: Indices


class Stretch(NamedTuple):
    """A part of a motion in which a pair of bodies may touch; shares of the motion.

    While the whole motion would take a time of 1, their distance changes no faster than
    by `speed` (m) within the stretch.
    """

    pair: int
    start: float
    end: float
    speed: float


def distance_to_keep(allowed_depth: Array | None) -> float:
    """The largest distance (m) that any pair must keep; depths (p,) allowed below 0."""
    if allowed_depth is None:
        return 0.0
    return max(0.0, -float(np.min(allowed_depth, initial=0.0)))
