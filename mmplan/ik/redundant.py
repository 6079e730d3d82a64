"""Arms with more than six joints: some are held at samples, six are solved for.

The joints that are held are the first ones (a torso lift, the first joint of the arm)
or the last ones, so that what remains is one arm of six joints for all samples. Poses
that no sample solves within the joint limits are tried once more by iteration, with
all joints free.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from mmplan.ik import Solutions
from mmplan.ik.branches import Candidates, Pruning, join, pack, ranked, wound
from mmplan.ik.chain import Chain
from mmplan.ik.numeric import Numeric
from mmplan.ik.polish import polish
from mmplan.ik.poses import Poses, components, each_with_each
from mmplan.ik.six_joints import ClosedForm
from mmplan.shapes import Array

# How many poses times samples are solved at once.
_CHUNK = 1 << 13
# How far (rad) a joint may be beyond its limits before it is polished: so much, and
# so many times the deviation.
_ROUNDING = 1e-10
_LEVERAGE = 20.0


@dataclass(frozen=True, eq=False)
class Redundant:
    """A solver that holds the first `front` joints and all after the next six.

    `held` (s, k - 6) are the values of the joints held, one sample a row. No more than
    `most` solutions of a pose are returned, spread over the samples, and only those
    within the limits. `rescue` is asked for the poses that the samples do not solve.
    """

    chain: Chain
    form: ClosedForm
    front: int
    held: Array
    deviation: float  # how far (m or rad) the form is from the chain
    most: int
    rescue: Numeric
    explanation: str
    complete: bool = field(default=False, init=False)

    def solve(self, T_base_tool: Array) -> Solutions:
        """Solutions for tool poses (n, 4, 4) in the frame of the base."""
        n = len(T_base_tool)
        wanted = components(T_base_tool)
        displacement = components(T_base_tool @ self.chain.T_tool_home)
        size = max(1, _CHUNK // len(self.held))
        parts = []
        for start in range(0, n, size):
            rows = np.arange(start, min(start + size, n))
            found = self._sampled(displacement.take(rows))
            parts.append(Candidates(found.pose + start, found.q))
        found = join(parts, len(self.chain))
        found = polish(self.chain, _thin(found, self.most, n), wanted)
        found = self._inside(found)
        lost = np.ones(n, dtype=np.bool_)
        lost[found.pose] = False
        rescued = self.rescue.candidates(np.flatnonzero(lost), wanted)
        return pack(self.chain, join([found, rescued], len(self.chain)), n)

    def _inside(self, candidates: Candidates) -> Candidates:
        """The candidates of which a winding is within the limits."""
        q = wound(self.chain, candidates.q.T)
        inside = (q >= self.chain.lower) & (q <= self.chain.upper)
        return candidates.take(np.flatnonzero(inside.all(axis=1)))

    def _sampled(self, displacement: Poses) -> Candidates:
        """What the samples give within the limits (nearly), sample by sample."""
        n = displacement.p.shape[1]
        found = self.form.solve(self._displacements(displacement), self._pruning)
        sample, pose = np.divmod(found.pose, n)
        held = self.held[sample].T
        q = np.concatenate([held[: self.front], found.q, held[self.front :]])
        return Candidates(pose, q)

    def _displacements(self, moved: Poses) -> Poses:
        """How the six joints must move the tool, for each sample each pose, (s n)."""
        before, after = self._undone
        if self.front == 0:
            return each_with_each(after.inverse(), moved.inverse()).inverse()
        moved = each_with_each(before, moved)
        if self.front == self.held.shape[1]:
            return moved
        n = moved.p.shape[1] // len(self.held)
        return moved @ after.take(np.repeat(np.arange(len(self.held)), n))

    @cached_property
    def _undone(self) -> tuple[Poses, Poses]:
        """The motions of the joints held, before the six and after, undone, (s,)."""
        held = self.held.T
        k = len(self.chain)
        before = self.chain.part(range(self.front))
        after = self.chain.part(range(self.front + 6, k))
        return (
            _motion(before, held[: self.front]).inverse(),
            _motion(after, held[self.front :]).inverse(),
        )

    @cached_property
    def _pruning(self) -> Pruning:
        six = self.chain.part(range(self.front, self.front + 6))
        margin = _ROUNDING + _LEVERAGE * self.deviation
        return Pruning(six.lower - margin, six.upper + margin)


def _motion(chain: Chain, q: Array) -> Poses:
    """How the joints of a chain at q (k, m) move what stands after them."""
    return replace(chain, T_home=np.eye(4)).forward(q)


def _thin(candidates: Candidates, most: int, n: int) -> Candidates:
    """At most so many of each pose, evenly spread over those in their order."""
    order, rank, counts = ranked(candidates.pose, n)
    total = counts[candidates.pose[order]]
    spread = rank * most // total != (rank - 1) * most // total
    return candidates.take(order[spread | (total <= most)])
