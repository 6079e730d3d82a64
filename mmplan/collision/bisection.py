"""The order in which to look at the steps of a motion."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mmplan.collision.pairs import Indices


@lru_cache(maxsize=4096)
def coarse_to_fine(steps: int) -> Indices:
    """The steps 1, 2, ..., n as a column (n, 1), by bisection: n comes first.

    Neighbours collide together, so that this order meets an obstacle early.
    """
    index = np.arange(steps)
    bits = max(1, int(steps - 1).bit_length())
    reversed_bits = sum(((index >> b) & 1) << (bits - 1 - b) for b in range(bits))
    order = steps - np.argsort(reversed_bits, kind="stable")[:, None]
    order.setflags(write=False)
    return order
