"""The broadphase in compiled loops, where numba is installed.

It looks at oriented boxes, one configuration after the other. For one motion at a time
it takes a fraction of what `Broadphase` does and leaves fewer pairs to coal; large
batches of configurations are as quick there. The answers are the same.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pinocchio as pin

from mmplan.collision import kernels
from mmplan.collision.assembly import Body
from mmplan.collision.bounds import local_bounds
from mmplan.collision.clear_cells import ClearCells
from mmplan.collision.levers import pair_levers
from mmplan.collision.pairs import Flags, Indices, Stretch
from mmplan.collision.requests import PROVABLE
from mmplan.kinematics import ForwardKinematics
from mmplan.shapes import Array

# Added to all bounds so that rounding hides no touch, nor what cannot be proven, m.
_PADDING = PROVABLE
# Configurations looked at in one go.
_CHUNK = 256
# Boxes apart by less are left to coal, m.
_SMALLEST = 0.002


class CompiledBroadphase:
    """Finds the pairs of a geometry model whose oriented bounds overlap, on motions."""

    def __init__(
        self,
        model: pin.Model,
        geometry: pin.GeometryModel,
        bodies: Sequence[Body],
        pairs: Indices,
        margin: float = 0.0,
    ) -> None:
        """Bound every body; `pairs` (p, 2) are indices into `bodies`.

        Bodies nearer than `margin` (m) count as touching.
        """
        kinematics = ForwardKinematics(model)
        self._tree, self._basis = kinematics.tree, kinematics.basis
        paired = sorted(set(pairs.ravel().tolist()))
        moving = [i for i in paired if bodies[i].joint != 0]
        static = [i for i in paired if bodies[i].joint == 0]
        self._joint = np.array([bodies[i].joint for i in moving], dtype=np.int64)
        self._moving = _boxes(geometry, moving, _PADDING + margin)
        self._static = _boxes(geometry, static, _PADDING)
        self._pairs = _table(moving, static, pairs)  # in the order of `pairs`
        self.levers = pair_levers(model, geometry, pairs)
        self._cells = np.empty((0, 6))
        self._clear = np.empty((0, 1, 1), dtype=np.bool_)
        self._lists = np.empty(len(pairs) * (kernels.HALVINGS + 2), dtype=np.int64)
        self._found = np.empty((1024, 3), dtype=np.int64)
        self._depth = np.empty(1024)

    @property
    def _bodies(self) -> tuple[Indices, Array, Array, Indices, Array, Flags]:
        """Arguments that all kernels share."""
        return (
            self._joint,
            self._moving,
            self._static,
            self._pairs,
            self._cells,
            self._clear,
        )

    @property
    def _room(self) -> tuple[Indices, Array]:
        return self._found, self._depth

    def likeliest(self, q: Array) -> Iterator[tuple[int, int]]:
        """Configuration and pair of each that may touch, likely ones first.

        For whom one hit among the configurations (n, nq) is enough.
        """
        q = np.ascontiguousarray(q)
        for start in range(0, len(q), _CHUNK):
            found, depth = self._find(q[start : start + _CHUNK])
            for row, pair, _ in _deepest_first(found, depth):
                yield row + start, pair

    def on_steps(self, q: Array, dq: Array, steps: int) -> list[tuple[int, int]]:
        """Step and pair of each that may touch on the way, likely ones first.

        At q + k / steps · dq (nq,), k = 1, ..., steps.
        """
        found, depth = self._follow(q, dq, steps)
        return [(k, pair) for pair, k, _ in _deepest_first(found, depth)]

    def on_the_way(self, q: Array, dq: Array) -> list[Stretch]:
        """Where pairs may touch on the way from q (nq,) to q + dq, likely ones first.

        Of pairs that are not in the list nothing touches anywhere on the way.
        """
        found, depth = self._follow(q, dq, 0)
        return [
            Stretch(pair, first / kernels.PARTS, last / kernels.PARTS)
            for pair, first, last in _deepest_first(found, depth)
        ]

    def learn(self, pair: int, known: ClearCells) -> None:
        """Leave a pair of moving bodies out wherever it is known to be apart."""
        count = len(self._cells)
        self._cells = np.vstack([self._cells, known.cells])
        clear = self._clear if count else np.empty((0, *known.clear.shape), np.bool_)
        self._clear = np.concatenate([clear, known.clear[None]])
        self._pairs[self._pairs[:, 0] == pair, 3] = count

    def _find(self, q: Array) -> tuple[Indices, Array]:
        """Row, pair and nothing (k, 3), and overlaps (k,), by row."""
        while True:
            count = kernels.find_suspects(
                q, self._tree, self._basis, *self._bodies, *self._room
            )
            if self._had_room(count):
                return self._found[:count].copy(), self._depth[:count]

    def _follow(self, q: Array, dq: Array, steps: int) -> tuple[Indices, Array]:
        """What `kernels.search_motion` finds (k, 3), and overlaps (k,)."""
        while True:
            count = kernels.search_motion(
                q,
                dq,
                steps,
                _SMALLEST,
                self._tree,
                self._basis,
                self.levers,
                self._lists,
                *self._bodies,
                *self._room,
            )
            if self._had_room(count):
                return self._found[:count], self._depth[:count]

    def _had_room(self, count: int) -> bool:
        """Whether that many finds fitted in; if not, there is room now."""
        if count <= len(self._depth):
            return True
        self._found = np.empty((2 * count, 3), dtype=np.int64)
        self._depth = np.empty(2 * count)
        return False


def _deepest_first(found: Indices, depth: Array) -> list[list[int]]:
    """Finds (k, 3) as lists, those whose boxes overlap the most first."""
    if not len(depth):
        return []
    order = depth.argsort()[::-1]
    finds: list[list[int]] = found[order].tolist()
    return finds


def _boxes(geometry: pin.GeometryModel, indices: list[int], padding: float) -> Array:
    """Boxes about bodies in the frames of their joints, (m, 4, 4); see `kernels`."""
    boxes = np.empty((len(indices), 4, 4))
    for box, index in zip(boxes, indices, strict=True):
        body = geometry.geometryObjects[index]
        centre, half = local_bounds(body.geometry)
        box[:3] = body.placement.homogeneous[:3]
        box[:3, 3] += box[:3, :3] @ centre
        box[3, :3] = half + padding
        box[3, 3] = np.linalg.norm(box[3, :3])
    return boxes


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
