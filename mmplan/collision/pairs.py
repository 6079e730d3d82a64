"""Pairs of bodies, as arrays."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

Indices: TypeAlias = npt.NDArray[np.int64]
Flags: TypeAlias = npt.NDArray[np.bool_]


class Suspects(NamedTuple):
    """Pairs whose bounds overlap: pair `pair[k]` in configuration `row[k]`."""

    row: Indices
    pair: Indices


class Stretch(NamedTuple):
    """A part of a motion in which a pair of bodies may touch; shares of the motion."""

    pair: int
    start: float
    end: float
