"""Boolean collision checks of many configurations at once."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision.assembly import Assembly
from mmplan.collision.broadphase import Broadphase, Suspects
from mmplan.collision.requests import make_exact
from mmplan.shapes import Array


class Checker:
    """Checks the pairs of one geometry model: bounds in numpy, what is left in coal.

    Pinocchio's functions do not see later changes of a geometry model, so a checker is
    made once the model is final.
    """

    def __init__(self, model: pin.Model, assembly: Assembly) -> None:
        """Prepare the checks."""
        self._model = model
        self._geometry = assembly.geometry
        self._data = model.createData()
        self._geometry_data = self._geometry.createData()
        make_exact(self._geometry_data, assembly.allowed_depth)
        joints = {assembly.bodies[i].joint for i in assembly.pairs.ravel().tolist()}
        self._moving = sorted(joints - {0})
        margin = max(0.0, -float(np.min(assembly.allowed_depth, initial=0.0)))
        self._broadphase = Broadphase(
            model, self._geometry, assembly.bodies, assembly.pairs, margin
        )

    def in_collision(self, q: Array) -> npt.NDArray[np.bool_]:
        """Which of the configurations (n, nq) are in collision, (n,)."""
        hits = np.zeros(len(q), dtype=np.bool_)
        for found in self._broadphase.suspects(q):
            for row, pairs in _by_row(found, hits):
                self._place(q[row])
                hits[row] = any(map(self._collides, pairs))
        return hits

    def in_collision_at(self, T_world_joint: Array) -> npt.NDArray[np.bool_]:
        """The same from the poses (n, njoints, 4, 4) of the joints that are checked."""
        hits = np.zeros(len(T_world_joint), dtype=np.bool_)
        for found in self._broadphase.suspects_at(T_world_joint):
            for row, pairs in _by_row(found, hits):
                self._place_joints(T_world_joint[row])
                hits[row] = any(map(self._collides, pairs))
        return hits

    def any_collision(self, q: Array) -> bool:
        """Whether any of the configurations (n, nq) is in collision."""
        return any(self._collides(pair) for _, pair in self._suspects(q))

    def overlaps(self, q: Array) -> Iterator[tuple[int, float]]:
        """Pairs that collide at q (nq,): index and depth (m)."""
        for _, pair in self._suspects(np.asarray(q)[None]):
            if self._collides(pair):
                found = pin.computeDistance(self._geometry, self._geometry_data, pair)
                yield pair, max(0.0, -float(found.min_distance))

    def _suspects(self, q: Array) -> Iterator[tuple[int, int]]:
        """Configuration and pair, with the bodies placed in that configuration."""
        placed = -1
        for rows, pairs in self._broadphase.suspects(q, hasty=True):
            for row, pair in zip(rows.tolist(), pairs.tolist(), strict=True):
                if row != placed:
                    self._place(q[row])
                    placed = row
                yield row, pair

    def _place(self, q: Array) -> None:
        pin.updateGeometryPlacements(
            self._model, self._data, self._geometry, self._geometry_data, q
        )

    def _place_joints(self, T_world_joint: Array) -> None:
        for joint in self._moving:
            self._data.oMi[joint] = pin.SE3(T_world_joint[joint])
        pin.updateGeometryPlacements(
            self._model, self._data, self._geometry, self._geometry_data
        )

    def _collides(self, pair: int) -> bool:
        return bool(pin.computeCollision(self._geometry, self._geometry_data, pair))


def _by_row(
    found: Suspects, hits: npt.NDArray[np.bool_]
) -> Iterator[tuple[int, list[int]]]:
    """Rows that are not hit yet, each with its pairs."""
    left = ~hits[found.row]
    rows, pairs = found.row[left], found.pair[left].tolist()
    start = np.flatnonzero(np.diff(rows, prepend=-1))
    ends = np.append(start, len(rows))[1:].tolist()
    for row, i, j in zip(rows[start].tolist(), start.tolist(), ends, strict=True):
        yield row, pairs[i:j]
