"""Branches of solutions while they are found: one flat list for all poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mmplan.ik import Solutions
from mmplan.ik.chain import Chain
from mmplan.ik.subproblems import Angles
from mmplan.ik.windings import nearest_winding
from mmplan.shapes import Array

Index = npt.NDArray[np.intp]


class Candidates(NamedTuple):
    """m configurations, each for one of the poses asked for."""

    pose: Index  # (m,), the number of the pose
    q: Array  # (k, m)

    def take(self, index: npt.NDArray[np.intp] | npt.NDArray[np.bool_]) -> Candidates:
        """The candidates of these numbers, or where a mask holds."""
        return Candidates(self.pose[index], self.q[:, index])


def join(parts: Sequence[Candidates], joints: int) -> Candidates:
    """All candidates of some lists, maybe none."""
    empty = Candidates(np.empty(0, np.intp), np.empty((joints, 0)))
    poses, configurations = zip(empty, *parts, strict=True)
    return Candidates(np.concatenate(poses), np.concatenate(configurations, axis=1))


@dataclass(frozen=True, eq=False)
class Pruning:
    """Which values of turning joints are worth following up: those within limits."""

    lower: Array  # (k,)
    upper: Array  # (k,)

    @staticmethod
    def none(joints: int) -> Pruning:
        """Follow up everything."""
        return Pruning(np.full(joints, -np.inf), np.full(joints, np.inf))

    def allows(self, joint: int, angles: Array) -> npt.NDArray[np.bool_]:
        """Whether some winding of the angles of a revolute joint is within limits."""
        lower, upper = self.lower[joint], self.upper[joint]
        if upper - lower >= 2 * np.pi:
            return np.ones(angles.shape, dtype=np.bool_)
        wound = nearest_winding(angles, lower, upper)
        inside: npt.NDArray[np.bool_] = (wound >= lower) & (wound <= upper)
        return inside

    def split(self, joint: int, angles: Angles) -> tuple[Index, Array]:
        """The angles to follow up, (m',), and the number of the case of each."""
        which, case = np.nonzero(angles.exists & self.allows(joint, angles.values))
        return case, angles.values[which, case]


def ranked(pose: Index, n: int = 0) -> tuple[Index, Index, Index]:
    """An order (m,) by pose, each one's rank within its pose, and the counts.

    There are counts for n poses, or for so many as there are.
    """
    order: Index = np.argsort(pose, kind="stable")
    counts: Index = np.bincount(pose, minlength=n)
    first = np.cumsum(counts) - counts
    rank: Index = np.arange(len(pose)) - first[pose[order]]
    return order, rank, counts


def wound(chain: Chain, q: Array) -> Array:
    """Configurations (..., k), turning joints wound nearest to the limits' middle."""
    turning = ~chain.prismatic
    nearest = nearest_winding(q, chain.lower, chain.upper)
    return np.where(turning, nearest, q)


def pack(chain: Chain, candidates: Candidates, n: int) -> Solutions:
    """The solutions of n poses, each joint at its winding nearest the limits' middle.

    There are as many branches as the pose with the most of them has, and at least one.
    """
    order, slot, counts = ranked(candidates.pose, n)
    pose = candidates.pose[order]
    shape = (n, max(1, int(counts.max(initial=0))))
    found = wound(chain, candidates.q.T[order])
    q = np.full((*shape, len(chain)), np.nan)
    q[pose, slot] = found
    exists = np.zeros(shape, dtype=np.bool_)
    exists[pose, slot] = True
    within = exists.copy()
    within[pose, slot] = ((found >= chain.lower) & (found <= chain.upper)).all(axis=1)
    return Solutions(q=q, exists=exists, within=within)
