"""Evenly spread values without chance."""

from __future__ import annotations

import numpy as np

from mmplan.shapes import Array


def lattice(count: int, dimensions: int) -> Array:
    """Points (count, dimensions) in the open unit cube, more evenly spread than chance.

    The additive recurrence of the generalized golden ratio (M. Roberts, "The
    unreasonable effectiveness of quasirandom sequences", 2018).
    """
    ratio = 2.0
    for _ in range(64):
        ratio = (1 + ratio) ** (1 / (dimensions + 1))
    strides = ratio ** -np.arange(1, dimensions + 1)
    points: Array = (0.5 + np.outer(np.arange(count), strides)) % 1.0
    return points
