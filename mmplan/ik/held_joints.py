"""Joints of an arm held at samples, such that the six others are solved for."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from mmplan.ik.branches import Candidates, Pruning
from mmplan.ik.chain import Chain
from mmplan.ik.poses import Poses, each_with_each
from mmplan.ik.six_joints import ClosedForm
from mmplan.shapes import Array


@dataclass(frozen=True, eq=False)
class HeldJoints:
    """The first `front` joints of a chain, and all after the next six, held at samples.

    `values` (s, k - 6) are one sample a row.
    """

    chain: Chain
    front: int
    values: Array

    def solve(self, form: ClosedForm, moved: Poses, pruning: Pruning) -> Candidates:
        """All joints (k, m) that move the tool so from where it is at 0, (n,)."""
        n = moved.p.shape[1]
        found = form.solve(self._left_for_six(moved), pruning)
        sample, pose = np.divmod(found.pose, n)
        held = self.values[sample].T
        q = np.concatenate([held[: self.front], found.q, held[self.front :]])
        return Candidates(pose, q)

    def _left_for_six(self, moved: Poses) -> Poses:
        """How the six joints must move the tool, each sample for all poses, (s n)."""
        before, after = self._undone
        if self.front == 0:
            return each_with_each(after.inverse(), moved.inverse()).inverse()
        left = each_with_each(before, moved)
        s, back = self.values.shape[0], self.values.shape[1] - self.front
        if back == 0:
            return left
        return left @ after.take(np.repeat(np.arange(s), moved.p.shape[1]))

    @cached_property
    def _undone(self) -> tuple[Poses, Poses]:
        """The motions of the joints held, before the six and after, undone, (s,)."""
        held = self.values.T
        before = self.chain.part(range(self.front))
        after = self.chain.part(range(self.front + 6, len(self.chain)))
        return (
            _motion(before, held[: self.front]).inverse(),
            _motion(after, held[self.front :]).inverse(),
        )


def _motion(chain: Chain, q: Array) -> Poses:
    """How the joints of a chain at q (k, m) move what stands after them."""
    return replace(chain, T_home=np.eye(4)).forward(q)
