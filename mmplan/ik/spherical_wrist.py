"""Arms of six joints whose last three axes meet in one point, the wrist's centre.

The first three joints place that centre, by one of four ways, each for a pair of axes
that meet or are parallel; the last three turn the tool (D. L. Pieper, "The kinematics
of manipulators under computer control", Stanford, 1968).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from mmplan.ik.branches import Candidates, Index, Pruning
from mmplan.ik.poses import Poses
from mmplan.ik.rotation import along, dot, rotate
from mmplan.ik.subproblems import (
    AnglePairs,
    subproblem_1,
    subproblem_2,
    subproblem_3,
    subproblem_4,
)
from mmplan.ik.wrist import Wrist
from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class Shoulder:
    """The first three joints and the point that they place.

    `axes` and `points` are (3, 3), one joint a row. Where two axes meet, their points
    are the one where they do.
    """

    axes: Array
    points: Array
    centre: Array  # (3,), where the wrist's centre is with all joints at 0
    slack: float  # m, how far the centre may be missed by


# From the shoulder and places of the centre (3, n): the number of the place of each
# solution, (m,), and the first three joints, (3, m).
Placing: TypeAlias = Callable[[Shoulder, Array, Pruning], tuple[Index, Array]]


@dataclass(frozen=True, eq=False)
class SphericalWrist:
    """All solutions of an arm with a spherical wrist."""

    shoulder: Shoulder
    placing: Placing
    wrist: Wrist
    idle: float  # rad, joint 4 where it and joint 6 turn about one axis

    def solve(self, displacement: Poses, pruning: Pruning) -> Candidates:
        """The joints (6, m) whose motion from 0 moves the tool as given."""
        R, p = displacement
        centre = along(self.shoulder.centre, R) + p
        case, q = self.placing(self.shoulder, centre, pruning)
        images = self.wrist.images(R)[:, :, case]
        for axis, angle in zip(self.shoulder.axes, q, strict=True):
            images = rotate(-axis, angle, images)
        found = self.wrist.solve(
            images,
            pruning,
            lambda aligned: np.full(len(aligned), self.idle),
            self.shoulder.slack,
        )
        keep = pruning.allows(3, found.first)
        turns = np.array([found.first, found.middle, found.last])
        joints = np.concatenate([q[:, found.case], turns])
        return Candidates(case[found.case], joints).take(keep)


def place_parallel_23(
    shoulder: Shoulder, centre: Array, pruning: Pruning
) -> tuple[Index, Array]:
    """Axes 2 and 3 parallel: they keep the centre's height along them."""
    axes, (p1, p2, p3) = shoulder.axes, shoulder.points[:, :, None]
    c, slack = shoulder.centre[:, None], shoulder.slack
    from_1 = centre - p1
    height = along(axes[1], c - p1)
    first = subproblem_4(-axes[0], from_1, axes[1][:, None], height, slack)
    case, q1 = pruning.split(0, first)
    seen = p1 + rotate(-axes[0], q1, from_1[:, case]) - p2
    third = subproblem_3(axes[2], c - p3, p2 - p3, dot(seen, seen), slack)
    more, q3 = pruning.split(2, third)
    case, q1, seen = case[more], q1[more], seen[:, more]
    bent = p3 - p2 + rotate(axes[2], q3, c - p3)
    q2 = subproblem_1(axes[1], bent, seen)
    keep = pruning.allows(1, q2)
    return case[keep], np.array([q1, q2, q3])[:, keep]


def place_parallel_12(
    shoulder: Shoulder, centre: Array, pruning: Pruning
) -> tuple[Index, Array]:
    """Axes 1 and 2 parallel: only joint 3 changes the centre's height along them."""
    axes, (p1, p2, p3) = shoulder.axes, shoulder.points[:, :, None]
    c, slack = shoulder.centre[:, None], shoulder.slack
    height = along(axes[0], centre - p3)
    third = subproblem_4(axes[2], c - p3, axes[0][:, None], height, slack)
    case, q3 = pruning.split(2, third)
    bent = p3 + rotate(axes[2], q3, c - p3) - p2
    wanted = (centre - p1)[:, case]
    second = subproblem_3(axes[1], bent, p1 - p2, dot(wanted, wanted), slack)
    more, q2 = pruning.split(1, second)
    case, q3 = case[more], q3[more]
    start = p2 - p1 + rotate(axes[1], q2, bent[:, more])
    q1 = subproblem_1(axes[0], start, wanted[:, more])
    keep = pruning.allows(0, q1)
    return case[keep], np.array([q1, q2, q3])[:, keep]


def place_meeting_12(
    shoulder: Shoulder, centre: Array, pruning: Pruning
) -> tuple[Index, Array]:
    """Axes 1 and 2 meet: only joint 3 changes the centre's distance from there."""
    axes, (p1, _, p3) = shoulder.axes, shoulder.points[:, :, None]
    c, slack = shoulder.centre[:, None], shoulder.slack
    wanted = centre - p1
    third = subproblem_3(axes[2], c - p3, p1 - p3, dot(wanted, wanted), slack)
    case, q3 = pruning.split(2, third)
    bent = p3 - p1 + rotate(axes[2], q3, c - p3)
    pairs = subproblem_2(-axes[0], wanted[:, case], axes[1], bent, slack)
    more, q1, q2 = _split_pair(pruning, 0, 1, pairs)
    return case[more], np.array([q1, q2, q3[more]])


def place_meeting_23(
    shoulder: Shoulder, centre: Array, pruning: Pruning
) -> tuple[Index, Array]:
    """Axes 2 and 3 meet: only joint 1 changes the centre's distance from there."""
    axes, (p1, p2, _) = shoulder.axes, shoulder.points[:, :, None]
    arm, slack = shoulder.centre[:, None] - p2, shoulder.slack
    from_1 = centre - p1
    first = subproblem_3(-axes[0], from_1, p2 - p1, dot(arm, arm), slack)
    case, q1 = pruning.split(0, first)
    seen = p1 + rotate(-axes[0], q1, from_1[:, case]) - p2
    pairs = subproblem_2(-axes[1], seen, axes[2], arm, slack)
    more, q2, q3 = _split_pair(pruning, 1, 2, pairs)
    return case[more], np.array([q1[more], q2, q3])


def _split_pair(
    pruning: Pruning, first: int, second: int, pairs: AnglePairs
) -> tuple[Index, Array, Array]:
    """The pairs of angles of two joints to follow up, and the case of each."""
    exists = pairs.exists & pruning.allows(second, pairs.second)
    allowed = exists & pruning.allows(first, pairs.first)
    which, case = np.nonzero(allowed)
    return case, pairs.first[which, case], pairs.second[which, case]
