"""Canonical subproblems: angles of one or two turns that place points as asked.

Each is solved for m cases at once. Vectors are arrays (3, m), or (3, 1) where they are
the same for all cases; axes are unit vectors (3,). Where a subproblem has no solution
the angle of the nearest miss comes back, and where its two solutions are one, or any
angle solves it, only the first exists.

The numbers are those of A. J. Elias and J. T. Wen, "IK-Geo: Unified robot inverse
kinematics using subproblem decomposition", Mechanism and Machine Theory 209, 2025.
The first three are those of B. Paden and W. Kahan; see R. M. Murray, Z. Li, S. S.
Sastry, "A Mathematical Introduction to Robotic Manipulation", 1994, section 3.3.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.ik.rotation import along, dot, turn_terms
from mmplan.shapes import Array

# Two solutions nearer to each other than this (rad) are one.
_SAME = 1e-6
# Lengths (m, m^2 or none) below which a vector has no direction.
_NO_LENGTH = 1e-10


class Angles(NamedTuple):
    """Two solutions for each of m cases; both arrays are (2, m)."""

    values: Array  # rad
    exists: npt.NDArray[np.bool_]


class AnglePairs(NamedTuple):
    """Two solutions of two angles for each of m cases; all arrays are (2, m)."""

    first: Array  # rad
    second: Array  # rad
    exists: npt.NDArray[np.bool_]


def subproblem_1(axis: Array, start: Array, end: Array) -> Array:
    """The angle (m,) about the axis that turns `start` nearest to `end`."""
    angle: Array = np.arctan2(*turn_terms(axis, start, end))
    return angle


def subproblem_2(
    axis_1: Array, start_1: Array, axis_2: Array, start_2: Array, slack: float
) -> AnglePairs:
    """Turns of two vectors of one length about two axes that bring them together.

    The axes must not be parallel. `slack` is how far (m) the cones that the vectors
    describe may stay apart.
    """
    mixed = float(axis_1 @ axis_2)
    divisor = 1.0 - mixed**2
    height_1, height_2 = along(axis_1, start_1), along(axis_2, start_2)
    a = (height_1 - mixed * height_2) / divisor
    b = (height_2 - mixed * height_1) / divisor
    in_plane = np.multiply.outer(axis_1, a) + np.multiply.outer(axis_2, b)
    length2 = dot(start_1, start_1)
    across2 = length2 - dot(in_plane, in_plane)
    across = np.sqrt(np.maximum(across2, 0.0) / divisor)
    normal = np.multiply.outer(np.cross(axis_1, axis_2), across)
    length = np.sqrt(length2)
    exists = across2 >= -slack * (length + slack)
    first, second = [], []
    for meeting in (in_plane + normal, in_plane - normal):
        first.append(subproblem_1(axis_1, start_1, meeting))
        second.append(subproblem_1(axis_2, start_2, meeting))
    apart = across > _SAME * length
    return AnglePairs(
        np.array(first), np.array(second), np.array([exists, exists & apart])
    )


def subproblem_3(
    axis: Array, start: Array, centre: Array, distance2: Array, slack: float
) -> Angles:
    """Turns about the axis that bring `start` to a squared distance of `centre`."""
    reach = dot(start, start) + dot(centre, centre)
    return subproblem_4(axis, start, centre, 0.5 * (reach - distance2), slack)


def subproblem_4(
    axis: Array, start: Array, normal: Array, height: Array, slack: float
) -> Angles:
    """Turns about the axis that bring `start` to a height along `normal`.

    `slack` is how far (m times the length of `normal`) the height may be missed by.
    """
    sine, cosine = turn_terms(axis, start, normal)
    radius = np.sqrt(sine * sine + cosine * cosine)
    wanted = height - along(axis, start) * along(axis, normal)
    free = radius < _NO_LENGTH
    ratio = wanted / np.where(free, 1.0, radius)
    spread = np.where(free, 0.0, np.arccos(np.clip(ratio, -1.0, 1.0)))
    exists = np.abs(wanted) <= radius + slack
    apart = (spread > _SAME) & (spread < np.pi - _SAME)
    middle = np.where(free, 0.0, np.arctan2(sine, cosine))
    return Angles(
        np.array([middle + spread, middle - spread]),
        np.array([exists, exists & apart]),
    )
