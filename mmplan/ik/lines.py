"""How the axes of joints lie to each other: parallel, or meeting in a point.

A URDF gives angles and offsets in a few digits, so that axes are meant to meet or to
be parallel that do so nearly. What is nearly so is taken as meant, and the deviation
reported.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from mmplan.shapes import Array

# Axes that differ from parallel (rad), or miss each other (m), by less are meant to.
TOLERANCE = 1e-4


class Meeting(NamedTuple):
    """Where axes meet, (3,), and how far (m) the farthest of them passes by."""

    point: Array
    deviation: float


def parallel(first: Array, second: Array) -> float | None:
    """The angle (rad) between two axes (3,) that are parallel, either way."""
    angle = float(np.linalg.norm(np.cross(first, second)))
    return angle if angle < TOLERANCE else None


def meeting(axes: Sequence[Array], points: Sequence[Array]) -> Meeting | None:
    """Where lines meet, if they do in one point: unit vectors and points, (3,) each.

    Lines of which two successive ones are parallel do not count as meeting.
    """
    if any(parallel(a, b) is not None for a, b in pairwise(axes)):
        return None
    across = [np.eye(3) - np.outer(axis, axis) for axis in axes]
    total = sum(A @ p for A, p in zip(across, points, strict=True))
    point = np.linalg.solve(np.sum(across, axis=0), total)
    misses = [A @ (point - p) for A, p in zip(across, points, strict=True)]
    deviation = max(float(np.linalg.norm(miss)) for miss in misses)
    return Meeting(point, deviation) if deviation < TOLERANCE else None
