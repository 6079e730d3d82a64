"""Arms with more than six joints: some are held at samples, six are solved for.

The joints that are held are the first ones (a torso lift, the first joint of the arm)
or the last ones, so that what remains is one arm of six joints for all samples. Poses
that no sample solves within the joint limits are tried once more by iteration, with
all joints free.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from mmplan.ik import Solutions
from mmplan.ik.branches import Candidates, Index, Pruning, join, pack, ranked, wound
from mmplan.ik.chain import Chain
from mmplan.ik.held_joints import HeldJoints
from mmplan.ik.numeric import Numeric
from mmplan.ik.polish import polish
from mmplan.ik.poses import Poses, components
from mmplan.ik.six_joints import ClosedForm
from mmplan.shapes import Array

# How many poses times samples are solved at once.
_CHUNK = 1 << 13
# How far (rad) a joint may be beyond its limits before it is polished: so much, and
# so many times the deviation.
_ROUNDING = 1e-10
_LEVERAGE = 20.0


# So many of the samples tell whether a pose has solutions beyond the limits.
_PROBES = 6


@dataclass(frozen=True, eq=False)
class Redundant:
    """A solver that holds the first `front` joints and all after the next six.

    `held` (s, k - 6) are the values of the joints held, one sample a row. No more than
    `most` solutions of a pose are returned, spread over the samples, and only those
    within the limits. Poses that no sample solves so are given to `rescue`; where it
    finds nothing either, one solution beyond the limits is returned, if one is found.
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
        n, k = len(T_base_tool), len(self.chain)
        wanted = components(T_base_tool)
        moved = components(T_base_tool @ self.chain.T_tool_home)
        sampled = _thin(self._sampled(self._samples, moved, self._pruning), self.most)
        inside = self._inside(polish(self.chain, sampled, wanted))
        rescued = self.rescue.candidates(_missing(inside, n), wanted)
        inside = join([inside, rescued], k)
        lost = _missing(inside, n)
        anywhere = Pruning.none(6)
        beyond = _thin(self._sampled(self._probes, moved.take(lost), anywhere), 1)
        beyond = Candidates(lost[beyond.pose], beyond.q)
        beyond = polish(self.chain, beyond, wanted)
        return pack(self.chain, join([inside, beyond], k), n)

    def _inside(self, candidates: Candidates) -> Candidates:
        """The candidates of which a winding is within the limits."""
        q = wound(self.chain, candidates.q.T)
        inside = (q >= self.chain.lower) & (q <= self.chain.upper)
        return candidates.take(np.flatnonzero(inside.all(axis=1)))

    def _sampled(self, held: HeldJoints, moved: Poses, pruning: Pruning) -> Candidates:
        """What samples give for motions of the tool from where it is at 0, (n,)."""
        n = moved.p.shape[1]
        size = max(1, _CHUNK // len(held.values))
        parts = []
        for start in range(0, n, size):
            rows = np.arange(start, min(start + size, n))
            found = held.solve(self.form, moved.take(rows), pruning)
            parts.append(Candidates(rows[found.pose], found.q))
        return join(parts, len(self.chain))

    @cached_property
    def _samples(self) -> HeldJoints:
        return HeldJoints(self.chain, self.front, self.held)

    @cached_property
    def _probes(self) -> HeldJoints:
        rows = np.linspace(0, len(self.held) - 1, _PROBES).astype(np.intp)
        return HeldJoints(self.chain, self.front, self.held[rows])

    @cached_property
    def _pruning(self) -> Pruning:
        six = self.chain.part(range(self.front, self.front + 6))
        margin = _ROUNDING + _LEVERAGE * self.deviation
        return Pruning(six.lower - margin, six.upper + margin)


def _missing(found: Candidates, n: int) -> Index:
    """Which of n poses have no candidate."""
    missing = np.ones(n, dtype=np.bool_)
    missing[found.pose] = False
    return np.flatnonzero(missing)


def _thin(candidates: Candidates, most: int) -> Candidates:
    """At most so many of each pose, evenly spread over those in their order."""
    order, rank, counts = ranked(candidates.pose)
    total = counts[candidates.pose[order]]
    spread = rank * most // total != (rank - 1) * most // total
    return candidates.take(order[spread | (total <= most)])
