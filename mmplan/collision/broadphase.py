"""Which pairs of bodies may touch, judged by their bounds, many configurations at once.

Pinocchio's broadphase managers update every body of the scene for every configuration.
Here what stands still is bounded once, and bodies are looked at by owner first: the
tines of a rack, or the pieces of a glass, one by one only where something is near.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mmplan.collision.assembly import Body
from mmplan.collision.bisection import coarse_to_fine
from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.collision.groups import Groups
from mmplan.collision.levers import pair_levers
from mmplan.collision.pairs import (
    Flags,
    Indices,
    Stretch,
    Suspects,
    distance_to_keep,
)
from mmplan.collision.requests import PROVABLE
from mmplan.kinematics import ForwardKinematics
from mmplan.shapes import Array

# Added to all bounds so that rounding never hides a touch, m.
_PADDING = 1e-6
# Configurations looked at in one go: few at first where a hit among them may be enough,
# and not so many that the arrays leave the cache.
_FIRST_CHUNK, _LAST_CHUNK = 16, 256
# So few owners of bodies that stand still are compared with each link at once.
_FEW_OWNERS = 32
# Motions are cut into stretches on whose halves bodies move no farther than this, m.
_REACH = 0.01


class _SelfPairs(NamedTuple):
    """Pairs of moving bodies, by the links that they belong to."""

    by_links: Groups
    first_link: Indices  # of each group
    second_link: Indices
    first: Indices  # moving bodies, of each pair
    second: Indices
    pair: Indices  # its id


class Broadphase:
    """Finds the pairs of a geometry model whose axis-aligned bounds overlap."""

    def __init__(
        self,
        model: pin.Model,
        geometry: pin.GeometryModel,
        bodies: Sequence[Body],
        pairs: Indices,
        allowed_depth: Array | None = None,
    ) -> None:
        """Bound every body; `pairs` (p, 2) are indices into `bodies`.

        Pairs may overlap by `allowed_depth` (p,), m; below 0 it is a distance to keep.
        """
        margin = distance_to_keep(allowed_depth)
        self._kinematics = ForwardKinematics(model)
        self._model, self._geometry, self._pairs = model, geometry, pairs
        paired = sorted(
            set(pairs.ravel().tolist()), key=lambda i: _group_key(bodies[i])
        )
        moving = [i for i in paired if bodies[i].joint != 0]
        static = [i for i in paired if bodies[i].joint == 0]
        self._bodies = _in_joints(geometry, moving, _PADDING + margin)
        self._joints = np.array([bodies[i].joint for i in moving], dtype=np.int64)
        self._links = Groups([_group_key(bodies[i]) for i in moving])
        self._link_bounds = self._links.around(self._bodies)
        self._link_joints = self._joints[self._links.starts]
        self._static = _in_joints(geometry, static, _PADDING)
        self._owners = Groups([_group_key(bodies[i]) for i in static])
        self._owner_bounds = self._owners.around(self._static)
        self._pair_ids = _pair_ids(moving, static, pairs)
        watched = self._owners.any_of(self._pair_ids >= 0)
        self._watched = self._links.any_of(watched.T).T  # (links, owners)
        self._self_pairs = _self_pairs(moving, pairs, self._links)

    @cached_property
    def _levers(self) -> Array:
        """How far joints carry the bodies of each pair to each other, (pairs, nq)."""
        return pair_levers(self._model, self._geometry, self._pairs)

    def suspects(self, q: Array) -> Iterator[Suspects]:
        """The pairs that may touch at configurations q (n, nq), in batches by row."""
        return self._batches(q, _LAST_CHUNK)

    def likeliest(self, q: Array) -> Iterator[tuple[int, int]]:
        """Configuration and pair of each that may touch.

        For whom one hit is enough: it begins with few configurations of all (n, nq).
        """
        for rows, pairs in self._batches(q, _FIRST_CHUNK):
            yield from zip(rows.tolist(), pairs.tolist(), strict=True)

    def suspects_at(self, T_world_joint: Array) -> Iterator[Suspects]:
        """The same as `suspects`, from poses (n, njoints, 4, 4) of all joints."""
        return self._of_poses(T_world_joint, 0.0)

    def on_steps(self, q: Array, dq: Array, steps: int) -> Iterator[tuple[int, int]]:
        """Step and pair of each that may touch on the way.

        At q + k / steps · dq (nq,), k = 1, ..., steps.
        """
        order = coarse_to_fine(steps)
        for row, pair in self.likeliest(q + order / steps * dq):
            yield int(order[row, 0]), pair

    def free_times(
        self,
        pair: int,  # noqa: ARG002 (what the compiled one goes by)
        q: Array,  # noqa: ARG002
        dq: Array,  # noqa: ARG002
        normal: Array,  # noqa: ARG002
        gap: float,
        speed: float,
    ) -> tuple[float, float]:
        """How long a pair stays apart, going by its speed alone."""
        return gap / speed, gap / speed

    def on_the_way(self, q: Array, dq: Array) -> list[Stretch]:
        """Where pairs may touch on the way from q (nq,) to q + dq.

        Of pairs that are not in the list nothing touches anywhere on the way.
        """
        ways = self._levers @ np.abs(dq)
        way = float(np.max(ways, initial=0.0))
        steps = max(1, int(np.ceil(way / (2.0 * _REACH))))
        middles = q + (np.arange(steps)[:, None] + 0.5) / steps * dq
        reach = way / (2.0 * steps) + PROVABLE
        found = self._of_poses(self._kinematics(middles), reach)
        return [
            Stretch(pair, row / steps, (row + 1) / steps, float(ways[pair]))
            for rows, pairs in found
            for row, pair in zip(rows.tolist(), pairs.tolist(), strict=True)
        ]

    def _batches(self, q: Array, size: int) -> Iterator[Suspects]:
        start = 0
        while start < len(q):
            T = self._kinematics(q[start : start + size])
            for row, pair in self.suspects_at(T):
                yield Suspects(row + start, pair)
            start, size = start + size, min(4 * size, _LAST_CHUNK)

    def _of_poses(self, T: Array, reach: float) -> Iterator[Suspects]:
        """Pairs whose bounds come within a reach (m) of each other."""
        links = moved_bounds(self._link_bounds, T[:, self._link_joints])
        links = Bounds(links.centre, links.half + reach)
        yield self._with_static(T, links, reach)
        yield self._among_moving(T, links, reach)

    def _with_static(self, T: Array, links: Bounds, reach: float) -> Suspects:
        """Link against owner, then body against owner, then body against body."""
        row, link, owner = self._near_owners(links)
        repeat, body = self._links.members(link)
        row, owner = row[repeat], owner[repeat]
        bounds = self._bounds(T, row, body, reach)
        close = _overlap(bounds, _taken(self._owner_bounds, owner))
        row, body, owner = row[close], body[close], owner[close]
        bounds = _taken(bounds, close)
        repeat, other = self._owners.members(owner)
        pair = self._pair_ids[body[repeat], other]
        touching = _overlap(_taken(bounds, repeat), _taken(self._static, other))
        touching &= pair >= 0
        return Suspects(row[repeat][touching], pair[touching])

    def _near_owners(self, links: Bounds) -> tuple[Indices, Indices, Indices]:
        """Rows, links and owners whose bounds overlap.

        Of many owners most are far from the whole robot, and looked at once a row.
        """
        owners = self._owner_bounds
        if len(owners.centre) <= _FEW_OWNERS:
            row, link, owner = np.nonzero(
                _overlap(_each(links), owners) & self._watched
            )
            return row, link, owner
        low, high = links.centre - links.half, links.centre + links.half
        low, high = low.min(axis=1, keepdims=True), high.max(axis=1, keepdims=True)
        robot = Bounds((low + high) / 2, (high - low) / 2)
        row, owner = np.nonzero(_overlap(robot, owners))
        there = Bounds(owners.centre[owner, None], owners.half[owner, None])
        near = _overlap(_taken(links, row), there) & self._watched.T[owner]
        which, link = np.nonzero(near)
        return row[which], link, owner[which]

    def _among_moving(self, T: Array, links: Bounds, reach: float) -> Suspects:
        """Link against link, then body against body."""
        pairs = self._self_pairs
        first, second = (
            Bounds(links.centre[:, which], links.half[:, which])
            for which in (pairs.first_link, pairs.second_link)
        )
        row, both = np.nonzero(_overlap(first, second))
        repeat, which = pairs.by_links.members(both)
        row = row[repeat]
        one = self._bounds(T, row, pairs.first[which], reach)
        other = self._bounds(T, row, pairs.second[which], reach)
        touching = _overlap(one, other)
        return Suspects(row[touching], pairs.pair[which[touching]])

    def _bounds(self, T: Array, row: Indices, body: Indices, reach: float) -> Bounds:
        """Bounds (k, 3) of moving bodies, grown by a reach, each where it is."""
        at = moved_bounds(_taken(self._bodies, body), T[row, self._joints[body]])
        return Bounds(at.centre, at.half + reach)


def _group_key(body: Body) -> tuple[str, int]:
    return body.owner, body.joint


def _each(bounds: Bounds) -> Bounds:
    """Bounds (n, m, 3) ready to be compared with each of others, (n, m, 1, 3)."""
    return Bounds(bounds.centre[:, :, None], bounds.half[:, :, None])


def _taken(bounds: Bounds, which: Indices | Flags) -> Bounds:
    return Bounds(bounds.centre[which], bounds.half[which])


def _overlap(a: Bounds, b: Bounds) -> Flags:
    """Whether boxes overlap, broadcast over all but the last axis."""
    x, y, z = (
        np.abs(a.centre[..., axis] - b.centre[..., axis])
        <= a.half[..., axis] + b.half[..., axis]
        for axis in range(3)
    )
    overlap: Flags = x & y & z
    return overlap


def _in_joints(
    geometry: pin.GeometryModel, indices: list[int], padding: float
) -> Bounds:
    """Padded bounds (m, 3) of bodies in the frames of the joints that move them."""
    objects = [geometry.geometryObjects[i] for i in indices]
    local = [local_bounds(o.geometry) for o in objects]
    centre = np.array([b.centre for b in local]).reshape(-1, 3)
    half = np.array([b.half for b in local]).reshape(-1, 3)
    placements = np.array([o.placement.homogeneous for o in objects])
    bounds = moved_bounds(Bounds(centre, half), placements.reshape(-1, 4, 4))
    return Bounds(bounds.centre, bounds.half + padding)


def _pair_ids(moving: list[int], static: list[int], pairs: Indices) -> Indices:
    """Pair ids of moving with static bodies, (moving, static), -1 for none."""
    row = {body: k for k, body in enumerate(moving)}
    column = {body: k for k, body in enumerate(static)}
    ids = np.full((len(moving), len(static)), -1, dtype=np.int64)
    for k, (i, j) in enumerate(pairs.tolist()):
        if i in row and j in column:
            ids[row[i], column[j]] = k
        elif j in row and i in column:
            ids[row[j], column[i]] = k
    return ids


def _self_pairs(moving: list[int], pairs: Indices, links: Groups) -> _SelfPairs:
    """The pairs of moving bodies, sorted by the links that they belong to."""
    row = {body: k for k, body in enumerate(moving)}
    among = sorted(
        (int(links.of[row[i]]), int(links.of[row[j]]), row[i], row[j], k)
        for k, (i, j) in enumerate(pairs.tolist())
        if i in row and j in row
    )
    table = np.array(among, dtype=np.int64).reshape(-1, 5)
    by_links = Groups([tuple(r) for r in table[:, :2].tolist()])
    first_link, second_link = table[by_links.starts, :2].T
    return _SelfPairs(by_links, first_link, second_link, *table[:, 2:].T)
