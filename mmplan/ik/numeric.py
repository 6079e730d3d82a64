"""Inverse kinematics by iteration, for arms that have no closed form.

Levenberg's and Marquardt's method with the damping of T. Sugihara, "Solvability-
unconcerned inverse kinematics by the Levenberg-Marquardt method", IEEE Transactions on
Robotics 27(5), 2011: it grows with the squared miss. It starts from the configurations
of a fixed table whose poses are nearest to the one asked for, and stays within the
joint limits. It cannot prove that a pose is out of reach.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt

from mmplan.ik import Solutions
from mmplan.ik.branches import Candidates, Index, pack
from mmplan.ik.chain import Chain
from mmplan.ik.polish import REACHED, damped_steps, distinct, misses
from mmplan.ik.poses import Poses, components
from mmplan.ik.sampling import lattice
from mmplan.shapes import Array

# A pose missed by less (m and rad) is not improved further.
_EXACT = 1e-11
# A miss that does not shrink to this part in `patience` steps, again and again, will
# not vanish.
_HOPELESS = 0.5
# Damping relative to the squared miss, at first.
_DAMPING = 1e-2
# How many poses are compared with the table at once.
_CHUNK = 512


@dataclass(frozen=True, eq=False)
class Numeric:
    """A solver for any arm. It reports poses that it reaches exactly, and no others.

    `seeds` starts are made for each pose, out of `table` configurations; at most
    `steps` steps from each, given up where `patience` steps gain little. Solutions
    nearer to each other than `apart` (rad or m, in every joint) count as one.
    """

    chain: Chain
    seeds: int
    table: int
    steps: int
    patience: int
    apart: float
    explanation: str
    complete: bool = field(default=False, init=False)

    def solve(self, T_base_tool: Array) -> Solutions:
        """The solutions found for tool poses (n, 4, 4) in the frame of the base."""
        wanted = components(T_base_tool)
        pose = np.flatnonzero(np.isfinite(T_base_tool).all(axis=(1, 2)))
        return pack(self.chain, self.candidates(pose, wanted), len(T_base_tool))

    def candidates(self, pose: Index, wanted: Poses) -> Candidates:
        """The solutions found for the poses of these numbers."""
        starts = Candidates(
            np.repeat(pose, self.seeds), self._starts(wanted.take(pose))
        )
        found = descend(self.chain, starts, wanted, self.steps, self.patience)
        return distinct(self.chain, found, self.apart)

    def _starts(self, wanted: Poses) -> Array:
        """The configurations of the table nearest to each of n poses, (k, n seeds)."""
        n = wanted.p.shape[1]
        chunks = np.split(np.arange(n), range(_CHUNK, n, _CHUNK))
        features = [_features(wanted.take(rows)) for rows in chunks]
        near = [_nearest(self._features, some, self.seeds) for some in features]
        return self._table[:, np.concatenate(near).ravel()]

    @cached_property
    def _table(self) -> Array:
        """Configurations (k, table), spread evenly within the limits."""
        lower, upper = (end[:, None] for end in self.chain.ranges)
        spread = lattice(self.table, len(self.chain)).T
        table: Array = lower + (upper - lower) * spread
        return table

    @cached_property
    def _features(self) -> Array:
        return _features(self.chain.forward(self._table))


def descend(
    chain: Chain, starts: Candidates, wanted: Poses, steps: int, patience: int
) -> Candidates:
    """The candidates within limits that reach their poses, each from its start."""
    lower, upper = chain.lower[:, None], chain.upper[:, None]
    target = wanted.take(starts.pose)
    q = starts.q.copy()
    poses, J = chain.jacobian(q)
    miss = misses(poses, target)
    size = np.sqrt((miss**2).sum(axis=0))
    first, damping = size.copy(), np.full(len(size), _DAMPING)
    rows = np.arange(len(size))
    for step in range(steps):
        rows = rows[_promising(size[rows], first[rows], step, patience)]
        if rows.size == 0:
            break
        now = q[:, rows]
        free = _free(J[:, :, rows], miss[:, rows], now <= lower, now >= upper)
        scale = size[rows] ** 2 * damping[rows]
        moved = now + damped_steps(J[:, :, rows] * free, miss[:, rows], scale)
        moved = np.clip(moved, lower, upper)
        poses, J_new = chain.jacobian(moved)
        miss_new = misses(poses, target.take(rows))
        size_new = np.sqrt((miss_new**2).sum(axis=0))
        better = size_new < size[rows]
        damping[rows] *= np.where(better, 0.5, 10.0)
        taken = rows[better]
        q[:, taken], size[taken] = moved[:, better], size_new[better]
        miss[:, taken], J[:, :, taken] = miss_new[:, better], J_new[:, :, better]
    return Candidates(starts.pose, q).take(size <= REACHED)


def _promising(
    size: Array, first: Array, step: int, patience: int
) -> npt.NDArray[np.bool_]:
    """Which misses (m,) are worth another step, from what they were at first."""
    going: npt.NDArray[np.bool_] = size > _EXACT
    if step and step % patience == 0:
        going &= size < first * _HOPELESS ** (step // patience)
    return going


def _free(
    J: Array,
    miss: Array,
    at_lower: npt.NDArray[np.bool_],
    at_upper: npt.NDArray[np.bool_],
) -> npt.NDArray[np.bool_]:
    """Which joints (k, m) are not pressed against a limit by the miss."""
    pull = np.einsum("ikm,im->km", J, miss)
    free: npt.NDArray[np.bool_] = ~((at_lower & (pull < 0)) | (at_upper & (pull > 0)))
    return free


def _features(poses: Poses) -> Array:
    """Numbers (n, 12) whose distance is that of poses: position and two axes, (m)."""
    return np.concatenate([poses.p, 0.5 * poses.R.reshape(9, -1)]).T


def _nearest(table: Array, features: Array, count: int) -> Index:
    """The rows of the table nearest to each row of features, (n, count)."""
    distance2 = (table**2).sum(axis=1) - 2 * (features @ table.T)
    near: Index = np.argpartition(distance2, count - 1, axis=1)[:, :count]
    return near
