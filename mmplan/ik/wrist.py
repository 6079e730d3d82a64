"""The last three turns of an arm, from the rotation that is left for them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mmplan.ik.branches import Index, Pruning
from mmplan.ik.rotation import along, rotate, turn_terms
from mmplan.ik.subproblems import Angles, subproblem_1, subproblem_4
from mmplan.shapes import Array

# Axes whose cosine is below this are perpendicular.
_PERPENDICULAR = 1e-12
# Below this sine of the angle between the first and last axes they are one.
_ALIGNED = 1e-10


class WristAngles(NamedTuple):
    """Solutions (m,) and the number of the case of each."""

    case: Index
    first: Array
    middle: Array
    last: Array


@dataclass(frozen=True, eq=False)
class Wrist:
    """Three turns about fixed axes (3,) that make up a given rotation.

    The last two are joints 5 and 6 of an arm.

    Where the first and last axes are one only the sum of their angles matters: the
    first stands at an idle angle, and the last takes the rest.
    """

    first: Array
    middle: Array
    last: Array

    @property
    def across(self) -> Array:
        """A unit vector (3,) perpendicular to the last axis."""
        helper = np.eye(3)[np.argmin(np.abs(self.last))]
        vector = np.cross(self.last, helper)
        across: Array = vector / np.linalg.norm(vector)
        return across

    def images(self, R: Array) -> Array:
        """Where rotations (3, 3, m), columns first, take last and across, (3, 2, m)."""
        parts = np.stack([self.last, self.across])
        images: Array = np.tensordot(parts, R, 1).swapaxes(0, 1)
        return images

    def solve(
        self,
        images: Array,
        pruning: Pruning,
        idle: Callable[[Index], Array],
        slack: float,
    ) -> WristAngles:
        """The angles for m rotations R, given `images` (3, 2, m): of last and across.

        `idle` tells idle angles, rad, for cases of these numbers.
        """
        case, middle = pruning.split(4, self._middle(images[:, 0], slack))
        last, across = images[:, 0, case], images[:, 1, case]
        turned = rotate(self.middle, middle, self.last[:, None])
        first = subproblem_1(self.first, turned, last)
        aligned = np.flatnonzero(self._sine(last) < _ALIGNED)
        first[aligned] = idle(case[aligned])
        rest = rotate(-self.first, first, np.stack([last, across], axis=1))
        # Anew from what is left, which is exact where the first angle is not: near
        # the alignment of the axes the cosine of the middle one says little.
        middle = subproblem_1(self.middle, self.last[:, None], rest[:, 0])
        rest = rotate(-self.middle, middle, rest[:, 1])
        angle = subproblem_1(self.last, self.across[:, None], rest)
        keep = pruning.allows(5, angle)
        return WristAngles(case[keep], first[keep], middle[keep], angle[keep])

    def _middle(self, last: Array, slack: float) -> Angles:
        """The middle angles, which tilt the last axis against the first as asked."""
        height = along(self.first, last)
        angles = subproblem_4(
            self.middle, self.last[:, None], self.first[:, None], height, slack
        )
        cosines = self.middle @ np.array([self.first, self.last]).T
        if np.abs(cosines).max() > _PERPENDICULAR:
            return angles
        # With perpendicular axes the sine is known as well as the cosine.
        sine = self._sine(last)
        spread = np.arctan2(sine, height)
        sine_0 = self.first @ np.cross(self.middle, self.last)
        zero = np.arctan2(sine_0, self.first @ self.last)
        exists = angles.exists[0]
        return Angles(
            np.array([zero + spread, zero - spread]),
            np.array([exists, exists & (sine > _ALIGNED)]),
        )

    def _sine(self, last: Array) -> Array:
        """The sine (m,) of the angle between the first axis and the images."""
        _, square = turn_terms(self.first, last, last)
        sine: Array = np.sqrt(np.maximum(square, 0.0))
        return sine
