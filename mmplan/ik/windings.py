"""Windings: joint values that differ by whole turns and place the robot alike."""

from __future__ import annotations

from itertools import product

import numpy as np

from mmplan.shapes import Array

_TURN = 2 * np.pi


def nearest_winding(q: Array, lower: Array, upper: Array) -> Array:
    """Each revolute joint of q (..., k) at its winding nearest the middle of limits.

    If any winding of a joint lies within `lower` and `upper` (k,), this one does. The
    middle of a joint without limits (-inf and inf) is 0.
    """
    limited = np.isfinite(upper)
    middle = 0.5 * (np.where(limited, lower, 0.0) + np.where(limited, upper, 0.0))
    return q - _TURN * np.rint((q - middle) / _TURN)


def windings(q: Array, lower: Array, upper: Array) -> Array:
    """All windings (m, k) within limits of one configuration (k,) of revolute joints.

    The one nearest the middle of the limits comes first. A joint without limits is
    at its winding nearest 0 alone, as others are no different. A prismatic joint
    whose range is below 6 m is left as it is.
    """
    nearest = nearest_winding(q, lower, upper)
    turns = [
        _TURN * np.arange(np.ceil((low - x) / _TURN), np.floor((high - x) / _TURN) + 1)
        if np.isfinite(high)
        else np.zeros(1)
        for x, low, high in zip(nearest, lower, upper, strict=True)
    ]
    offsets = np.array(list(product(*turns)), dtype=np.float64).reshape(-1, len(q))
    return nearest + offsets[np.argsort(np.abs(offsets).sum(axis=1), kind="stable")]
