"""Which pairs of bodies may touch, judged by their bounds, many configurations at once.

Pinocchio's broadphase managers update every body of the scene for every configuration.
Here what stands still is bounded once, in two levels: the bodies of one owner, such as
a rack with its tines, are looked at one by one only where something is near them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision.assembly import Body
from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.kinematics import ForwardKinematics
from mmplan.shapes import Array

Indices = npt.NDArray[np.int64]

# Added to all bounds so that rounding never hides a touch, m.
_PADDING = 1e-6
# Configurations looked at in one go, so that the arrays stay in the cache.
_CHUNK = 256
_NONE = np.zeros(0, dtype=np.int64)


class Suspects(NamedTuple):
    """Pairs whose bounds overlap: pair `pair[k]` in configuration `row[k]`, by row."""

    row: Indices
    pair: Indices


class Broadphase:
    """Finds the pairs of a geometry model whose axis-aligned bounds overlap."""

    def __init__(
        self,
        model: pin.Model,
        geometry: pin.GeometryModel,
        bodies: Sequence[Body],
        pairs: Indices,
    ) -> None:
        """Bound every body; `pairs` (p, 2) are indices into `bodies`."""
        self._kinematics = ForwardKinematics(model)
        paired = set(pairs.ravel().tolist())
        self._moving = [i for i in sorted(paired) if bodies[i].joint != 0]
        self._joints = [bodies[i].joint for i in self._moving]
        self._local, self._placements = _stacked(geometry, self._moving)
        static = sorted(
            (i for i in paired if bodies[i].joint == 0),
            key=lambda i: (bodies[i].owner, i),
        )
        self._static = moved_bounds(*_stacked(geometry, static))
        self._groups = _Groups([bodies[i].owner for i in static], self._static)
        self._pair_ids, self._moving_pairs = _split(self._moving, static, pairs)
        self._watched = self._groups.any_of(self._pair_ids >= 0)  # (moving, groups)

    def suspects(self, q: Array) -> Suspects:
        """The pairs that may touch at configurations q (n, nq)."""
        found = [Suspects(_NONE, _NONE)]
        for start in range(0, len(q), _CHUNK):
            bounds = self.moving_bounds(q[start : start + _CHUNK])
            for row, pair in (self._among_moving(bounds), self._with_static(bounds)):
                found.append(Suspects(row + start, pair))
        row, pair = (np.concatenate(part) for part in zip(*found, strict=True))
        order = np.argsort(row, kind="stable")
        return Suspects(row[order], pair[order])

    def moving_bounds(self, q: Array) -> Bounds:
        """Bounds (n, moving, 3) of the bodies that move with the robot."""
        T = self._kinematics(q)[:, self._joints] @ self._placements
        return moved_bounds(self._local, T)

    def _among_moving(self, bounds: Bounds) -> Suspects:
        first, second, pair = self._moving_pairs
        a = Bounds(*(part[:, first] for part in bounds))
        b = Bounds(*(part[:, second] for part in bounds))
        row, which = np.nonzero(_overlap(a, b))
        return Suspects(row, pair[which])

    def _with_static(self, bounds: Bounds) -> Suspects:
        moving = Bounds(*(part[:, :, None] for part in bounds))
        near = _overlap(moving, self._groups.bounds) & self._watched
        row, body, group = np.nonzero(near)
        repeat, member = self._groups.members(group)
        row, body = row[repeat], body[repeat]
        pair = self._pair_ids[body, member]
        mover = Bounds(*(part[row, body] for part in bounds))
        fixed = Bounds(*(part[member] for part in self._static))
        touching = (pair >= 0) & _overlap(mover, fixed)
        return Suspects(row[touching], pair[touching])


class _Groups:
    """Static bodies by owner; each group is a run of consecutive bodies."""

    def __init__(self, owners: list[str], bounds: Bounds) -> None:
        names = list(dict.fromkeys(owners))
        self._sizes = np.array([owners.count(name) for name in names], dtype=np.int64)
        self._starts = np.concatenate([[0], np.cumsum(self._sizes)[:-1]]).astype(int)
        if names:
            low = np.minimum.reduceat(bounds.centre - bounds.half, self._starts)
            high = np.maximum.reduceat(bounds.centre + bounds.half, self._starts)
        else:
            low = high = np.empty((0, 3))
        self.bounds = Bounds((low + high) / 2, (high - low) / 2)

    def any_of(self, mask: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
        """Whether any member is true: (m, static) -> (m, groups)."""
        if len(self._sizes) == 0:
            return mask
        return np.logical_or.reduceat(mask, self._starts, axis=1)

    def members(self, group: Indices) -> tuple[Indices, Indices]:
        """All members of the groups (k,): which of the k, and the static body."""
        sizes = self._sizes[group]
        repeat = np.repeat(np.arange(len(group)), sizes)
        within = np.arange(len(repeat)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
        return repeat, self._starts[group][repeat] + within


def _overlap(a: Bounds, b: Bounds) -> npt.NDArray[np.bool_]:
    """Whether boxes overlap, broadcast over all but the last axis."""
    a_low, a_high = _corners(a)
    b_low, b_high = _corners(b)
    overlap: npt.NDArray[np.bool_] = a_low[0] <= b_high[0]
    for low, high in (
        (b_low[0], a_high[0]),
        (a_low[1], b_high[1]),
        (b_low[1], a_high[1]),
        (a_low[2], b_high[2]),
        (b_low[2], a_high[2]),
    ):
        overlap &= low <= high
    return overlap


def _corners(bounds: Bounds) -> tuple[Array, Array]:
    """Lower and upper corners with the axis first, contiguous, (3, ...)."""
    low = np.moveaxis(bounds.centre - bounds.half, -1, 0)
    high = np.moveaxis(bounds.centre + bounds.half, -1, 0)
    return np.ascontiguousarray(low), np.ascontiguousarray(high)


def _stacked(geometry: pin.GeometryModel, indices: list[int]) -> tuple[Bounds, Array]:
    """Padded bounds (m, 3) in the bodies' own frames and their placements (m, 4, 4)."""
    objects = [geometry.geometryObjects[i] for i in indices]
    local = [local_bounds(o.geometry) for o in objects]
    bounds = Bounds(
        np.array([b.centre for b in local]).reshape(-1, 3),
        np.array([b.half for b in local]).reshape(-1, 3) + _PADDING,
    )
    placements = np.array([o.placement.homogeneous for o in objects])
    return bounds, placements.reshape(-1, 4, 4)


def _split(
    moving: list[int], static: list[int], pairs: Indices
) -> tuple[Indices, tuple[Indices, Indices, Indices]]:
    """Pair ids of moving with static bodies, -1 for none, and pairs of moving ones."""
    row = {body: k for k, body in enumerate(moving)}
    column = {body: k for k, body in enumerate(static)}
    ids = np.full((len(moving), len(static)), -1, dtype=np.int64)
    among = []
    for k, (i, j) in enumerate(pairs.tolist()):
        if i in row and j in row:
            among.append((row[i], row[j], k))
        elif i in row:
            ids[row[i], column[j]] = k
        else:
            ids[row[j], column[i]] = k
    first, second, pair = np.array(among, dtype=np.int64).reshape(-1, 3).T
    return ids, (first, second, pair)
