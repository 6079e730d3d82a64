"""Arms of six joints whose axes 2, 3 and 4 are parallel and whose axes 5 and 6 meet.

So are the arms of Universal Robots, and many others. Joints 2 to 4 move in a plane and
turn by the sum of their angles, which plays the first joint of a wrist.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mmplan.ik.branches import Candidates, Pruning
from mmplan.ik.poses import Poses
from mmplan.ik.rotation import along, dot, rotate, turn_terms
from mmplan.ik.subproblems import subproblem_1, subproblem_3, subproblem_4
from mmplan.ik.wrist import Wrist
from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class ParallelAxes:
    """All solutions of an arm with three parallel axes.

    `points` and `axes` are (6, 3); axes 2 to 4 are equal up to sign, and the points of
    the last two axes are the one where these meet.
    """

    axes: Array
    points: Array
    wrist: Wrist  # about axes 2, 5 and 6
    slack: float  # m

    def solve(self, displacement: Poses, pruning: Pruning) -> Candidates:
        """The joints (6, m) whose motion from 0 moves the tool as given."""
        R, p = displacement
        p1, centre = self.points[0][:, None], self.points[5][:, None]
        from_1 = along(self.points[5], R) + p - p1
        normal = self.axes[1][:, None]
        height = along(self.axes[1], centre - p1)
        first = subproblem_4(-self.axes[0], from_1, normal, height, self.slack)
        case, q1 = pruning.split(0, first)
        seen = p1 + rotate(-self.axes[0], q1, from_1[:, case])
        images = rotate(-self.axes[0], q1, self.wrist.images(R)[:, :, case])
        found = self.wrist.solve(
            images, pruning, lambda aligned: self._easy(seen[:, aligned]), self.slack
        )
        case, q1 = case[found.case], q1[found.case]
        more, q234 = self._plane(seen[:, found.case], found.first, pruning)
        rest = np.array([found.middle, found.last])[:, more]
        return Candidates(case[more], np.concatenate([q1[None, more], q234, rest]))

    def _plane(
        self, centre: Array, turn: Array, pruning: Pruning
    ) -> tuple[np.ndarray, Array]:
        """Joints 2 to 4 (3, m) that place the centre (3, n) and turn it by (n,)."""
        _, p2, p3, p4, _, c = self.points[:, :, None]
        second, third, fourth = self.axes[1:4]
        elbow = centre - rotate(second, turn, c - p4) - p2
        bend = subproblem_3(third, p4 - p3, p2 - p3, dot(elbow, elbow), self.slack)
        case, q3 = pruning.split(2, bend)
        bent = p3 - p2 + rotate(third, q3, p4 - p3)
        q2 = subproblem_1(second, bent, elbow[:, case])
        q4 = (turn[case] - q2 - (second @ third) * q3) * (second @ fourth)
        keep = pruning.allows(1, q2) & pruning.allows(3, q4)
        return case[keep], np.array([q2, q3, q4])[:, keep]

    def _easy(self, centre: Array) -> Array:
        """Sums of the angles of joints 2 to 4 for which the centre is in reach, (m,).

        Those with the elbow most nearly at a right angle.
        """
        _, p2, p3, p4, _, c = self.points[:, :, None]
        second = self.axes[1]
        side = along(second, p4 - p2) ** 2  # along the axes
        right = side + _across(second, p3 - p2) + _across(second, p4 - p3)
        turns = subproblem_3(second, c - p4, centre - p2, right, self.slack)
        first: Array = turns.values[0]
        return first


def _across(axis: Array, vector: Array) -> Array:
    """The squared length (1,) of a vector (3, 1) across an axis."""
    return turn_terms(axis, vector, vector)[1]
