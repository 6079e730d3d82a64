"""The broadphase in compiled loops, where numba is installed.

It looks at oriented boxes, one configuration after the other. For one motion at a time
it takes a fraction of what `Broadphase` does and leaves fewer pairs to coal; large
batches of configurations are as quick there. The answers are the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain

import numpy as np
import pinocchio as pin

from mmplan.collision import kernels
from mmplan.collision.assembly import Body
from mmplan.collision.bounds import Bounds, local_bounds
from mmplan.collision.clear_cells import ClearCells
from mmplan.collision.compiled_space import CompiledSpace, Judge
from mmplan.collision.cores import BALLS, core_of
from mmplan.collision.levers import body_levers, pair_levers
from mmplan.collision.pairs import (
    CERTAIN,
    Indices,
    Stretch,
    distance_to_keep,
)
from mmplan.collision.planner_space import PlannerSpace
from mmplan.collision.requests import PROVABLE
from mmplan.kinematics import ForwardKinematics, motion_axes
from mmplan.shapes import Array

# Added to all bounds so that rounding hides no touch, nor what cannot be proven, m.
_PADDING = PROVABLE
# Configurations looked at in one go.
_CHUNK = 256
# Boxes apart by less are left to coal, m.
_SMALLEST = 0.002
# Overlaps deeper than allowed by this are deep enough not to ask coal, m.
_SURE = 1e-4


class CompiledBroadphase:
    """Finds the pairs of a geometry model whose oriented bounds overlap, on motions."""

    def __init__(
        self,
        model: pin.Model,
        geometry: pin.GeometryModel,
        bodies: Sequence[Body],
        pairs: Indices,
        allowed_depth: Array,
    ) -> None:
        """Bound every body; `pairs` (p, 2) are indices into `bodies`.

        Pairs may overlap by `allowed_depth` (p,), m; below 0 it is a distance to keep.
        """
        paired = sorted(set(pairs.ravel().tolist()))
        moving = [i for i in paired if bodies[i].joint != 0]
        static = [i for i in paired if bodies[i].joint == 0]
        sizes = kernels.Sizes(
            model.njoints - 1, model.nq, len(moving), len(static), len(pairs), BALLS
        )
        numbers, integers = kernels.needed(sizes)
        self._numbers, self._integers = np.zeros(numbers), np.zeros(integers, np.int64)
        self._integers[: len(sizes)] = sizes
        self._tables = kernels.tables(self._numbers, self._integers)
        _fill_with_joints(self._tables, model)
        _fill_with_bodies(self._tables, geometry, moving, static, allowed_depth)
        self._tables.own[:] = body_levers(model, geometry, moving)
        self._tables.levers[:] = pair_levers(model, geometry, pairs)
        self._tables.joint[:] = [bodies[i].joint for i in moving]
        self._tables.pairs[:] = _table(moving, static, pairs)
        self._movers = {
            k: (mover, 1.0 if bodies[pairs[k, 0]].joint == 0 else -1.0)
            for k, mover, _, kind in self._tables.pairs.tolist()
            if kind == kernels.STATIC
        }
        self._clear = np.empty((0, 1, 1), dtype=np.bool_)
        self._make_room(1024)

    def _make_room(self, finds: int) -> None:
        """Room for so many finds, with which what kernels are given begins anew."""
        found = np.empty((finds, 3), dtype=np.int64)
        depth = np.empty((finds, 2))
        self.known = (self._numbers, self._integers, self._clear, found, depth)

    def likeliest(self, q: Array) -> Iterable[tuple[int, int]]:
        """Configuration and pair of each that may touch, likely ones first.

        For whom one hit among the configurations (n, nq) is enough: `CERTAIN` is the
        only pair where something collides for sure.
        """
        if len(q) <= _CHUNK:
            return self._likeliest(q, 0)
        starts = range(0, len(q), _CHUNK)
        return chain.from_iterable(
            self._likeliest(q[start : start + _CHUNK], start) for start in starts
        )

    def on_steps(self, q: Array, dq: Array, steps: int) -> list[tuple[int, int]]:
        """Step and pair of each that may touch on the way, likely ones first.

        At q + k / steps · dq (nq,), k = 1, ..., steps. `CERTAIN` as in `likeliest`.
        """
        count = self._follow(q, dq, steps)
        return [(k, pair) for pair, k, _ in self.deepest_first(count)]

    def on_the_way(self, q: Array, dq: Array) -> list[Stretch]:
        """Where pairs may touch on the way from q (nq,) to q + dq.

        Of pairs that are not in the list nothing touches anywhere on the way. `CERTAIN`
        as in `likeliest`.
        """
        count = self._follow(q, dq, 0)
        if count == CERTAIN:
            return [Stretch(CERTAIN, 0.0, 1.0, 0.0)]
        found, depth = self.known[-2:]
        speeds = depth[:count, 1].tolist()
        return [
            Stretch(pair, first / kernels.PARTS, last / kernels.PARTS, speed)
            for (pair, first, last), speed in zip(
                found[:count].tolist(), speeds, strict=True
            )
        ]

    def free_times(
        self, pair: int, q: Array, dq: Array, normal: Array, gap: float, speed: float
    ) -> tuple[float, float]:
        """How long a convex pair stays apart before and after q (nq,) on a way.

        Shares of the way from q to q + dq, for a pair that has a `gap` (m) along a
        normal (3,) from its first body to the second, and comes nearer to each other
        no faster than by `speed` (m). Where one of them stands still it counts in which
        direction the other goes: one that slides along a shelf is free for long.
        """
        if pair not in self._movers:
            return gap / speed, gap / speed
        mover, sign = self._movers[pair]
        times: tuple[float, float] = kernels.find_free_time(
            q, dq, mover, sign * normal, gap, speed, *self.known[:2]
        )
        return times

    def in_space(self, space: PlannerSpace, judge: Judge) -> CompiledSpace:
        """Answers in a planner's coordinates; the judge tells which finds collide."""
        return CompiledSpace(self, space, judge)

    def learn(self, pair: int, known: ClearCells) -> None:
        """Leave a pair of moving bodies out wherever it is known to be apart."""
        count = len(self._clear)
        self._tables.cells[count] = known.cells
        clear = self._clear if count else np.empty((0, *known.clear.shape), np.bool_)
        self._clear = np.concatenate([clear, known.clear[None]])
        pairs = self._tables.pairs
        pairs[pairs[:, 0] == pair, 3] = count
        self._make_room(len(self.known[-1]))

    def _likeliest(self, q: Array, first: int) -> list[tuple[int, int]]:
        """The same as `likeliest` for a few configurations, the first of which is."""
        count = kernels.find_suspects(q, *self.known)
        if not self.had_room(count):
            return self._likeliest(q, first)
        return [(row + first, pair) for row, pair, _ in self.deepest_first(count)]

    def _follow(self, q: Array, dq: Array, steps: int) -> int:
        """How much `kernels.search_motion` finds and leaves in the room for it."""
        count: int = kernels.search_motion(q, dq, steps, _SMALLEST, *self.known)
        if not self.had_room(count):
            return self._follow(q, dq, steps)
        return count

    def deepest_first(self, count: int) -> list[list[int]]:
        """The finds of a kernel that returned a count, most overlap of boxes first."""
        if count == CERTAIN:
            return [[CERTAIN] * 3]
        if count == 0:
            return []
        found, depth = self.known[-2:]
        found = found[:count]
        if count > 1:
            found = found[depth[:count, 0].argsort()[::-1]]
        finds: list[list[int]] = found.tolist()
        return finds

    def had_room(self, count: int) -> bool:
        """Whether that many finds fitted in; if not, there is room now."""
        if count <= len(self.known[-1]):
            return True
        self._make_room(2 * count)
        return False


def _fill_with_joints(tables: kernels.Tables, model: pin.Model) -> None:
    kinematics = ForwardKinematics(model)
    tables.basis[:], tables.tree[:] = kinematics.basis, kinematics.tree
    tables.axes[:] = _axes(model)
    tables.T[0] = np.eye(3, 4)


def _fill_with_bodies(
    tables: kernels.Tables,
    geometry: pin.GeometryModel,
    moving: list[int],
    static: list[int],
    allowed_depth: Array,
) -> None:
    padding = _PADDING + distance_to_keep(allowed_depth)
    tables.moving[:] = _boxes(geometry, moving, padding)
    tables.static[:] = _boxes(geometry, static, _PADDING)
    tables.upright[:] = _upright(tables.static)
    tables.balls[:] = _balls(geometry, moving)
    tables.cores[:] = _cores(geometry, static)
    tables.surely[:] = allowed_depth + _SURE


def _axes(model: pin.Model) -> Array:
    """The axis of each joint in its frame, and 1 if it turns, else 0, (joints, 4)."""
    angular = motion_axes(model)[1:, 3:]
    return np.column_stack([angular, np.any(angular != 0.0, axis=1)])


def _upright(boxes: Array) -> Array:
    """The corners of the upright boxes about boxes (n, 4, 4), (n, 6)."""
    reach = (np.abs(boxes[:, :3, :3]) @ boxes[:, 3, :3, None])[..., 0]
    return np.hstack([boxes[:, :3, 3] - reach, boxes[:, :3, 3] + reach])


def _boxes(geometry: pin.GeometryModel, indices: list[int], padding: float) -> Array:
    """Boxes about bodies in the frames of their joints, (m, 4, 4); see `kernels`."""
    bodies = [geometry.geometryObjects[i] for i in indices]
    bounds = [local_bounds(body.geometry) for body in bodies]
    padded = [Bounds(b.centre, b.half + padding) for b in bounds]
    return _placed(bodies, padded)


def _cores(geometry: pin.GeometryModel, indices: list[int]) -> Array:
    """Boxes within bodies in the frames of their joints, (m, 4, 4)."""
    bodies = [geometry.geometryObjects[i] for i in indices]
    return _placed(bodies, [core_of(body.geometry).box for body in bodies])


def _placed(bodies: list[pin.GeometryObject], bounds: list[Bounds]) -> Array:
    """Boxes in the frames of bodies, in those of their joints, (m, 4, 4)."""
    boxes = np.empty((len(bodies), 4, 4))
    for box, body, (centre, half) in zip(boxes, bodies, bounds, strict=True):
        box[:3] = body.placement.homogeneous[:3]
        box[:3, 3] += box[:3, :3] @ centre
        box[3, :3] = half
        box[3, 3] = np.linalg.norm(half)
    return boxes


def _balls(geometry: pin.GeometryModel, indices: list[int]) -> Array:
    """Balls within bodies, in the frames of the boxes about these, (m, b, 4)."""
    balls = np.empty((len(indices), BALLS, 4))
    for row, index in zip(balls, indices, strict=True):
        body = geometry.geometryObjects[index].geometry
        row[:] = core_of(body).balls
        row[:, :3] -= local_bounds(body).centre
    return balls


def _table(moving: list[int], static: list[int], pairs: Indices) -> Indices:
    """What `kernels` needs to know of the pairs, (p, 4), in the order of these."""
    place = {body: k for bodies in (moving, static) for k, body in enumerate(bodies)}
    still = set(static)
    table = [
        (k, place[j], place[i], kernels.STATIC)
        if i in still
        else (k, place[i], place[j], kernels.STATIC if j in still else kernels.MOVING)
        for k, (i, j) in enumerate(pairs.tolist())
    ]
    return np.array(table, dtype=np.int64).reshape(-1, 4)
