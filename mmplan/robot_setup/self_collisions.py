"""Collisions and distances among a robot's own links, pair by pair."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision import Body, make_exact
from mmplan.collision.broadphase import Broadphase
from mmplan.robot import Robot
from mmplan.shapes import Array

LinkPair: TypeAlias = tuple[str, str]
Mask: TypeAlias = npt.NDArray[np.bool_]


class SelfCollisions:
    """All pairs of links that move against each other, checked or not by the robot.

    `pairs` names them, links in the order in which the robot has them.
    """

    def __init__(self, robot: Robot) -> None:
        """Prepare the checks."""
        self._model = robot.model
        self._geometry = robot.geometry.clone()
        self._geometry.removeAllCollisionPairs()
        bodies = [
            Body(robot.link_of(g), robot.kind_of(g), int(g.parentJoint))
            for g in self._geometry.geometryObjects
        ]
        self._ids: dict[LinkPair, list[int]] = {}  # of pairs of bodies
        self._joints = {body.owner: body.joint for body in bodies}
        links = list(dict.fromkeys(body.owner for body in bodies))
        between: list[tuple[int, int]] = []
        for i, j in combinations(range(len(bodies)), 2):
            if bodies[i].joint != bodies[j].joint:
                first, second = sorted(
                    (bodies[k].owner for k in (i, j)), key=links.index
                )
                self._ids.setdefault((first, second), []).append(len(between))
                between.append((i, j))
                self._geometry.addCollisionPair(pin.CollisionPair(i, j))
        self.pairs: tuple[LinkPair, ...] = tuple(self._ids)
        self._pair_of = np.empty(len(between), dtype=np.int64)
        for k, ids in enumerate(self._ids.values()):
            self._pair_of[ids] = k
        self._data = self._model.createData()
        self._geometry_data = self._geometry.createData()
        make_exact(self._geometry_data)
        ends = np.array(between, dtype=np.int64).reshape(-1, 2)
        self._broadphase = Broadphase(self._model, self._geometry, bodies, ends)

    def overlaps(self, q: Array, asked: Mask | None = None) -> Mask:
        """Which pairs overlap at configurations q (n, nq): (n, pairs).

        Pairs that are not `asked` for (pairs,) are left out and False.
        """
        found = np.zeros((len(q), len(self.pairs)), dtype=np.bool_)
        placed = -1
        for rows, ids in self._broadphase.suspects(q):
            for row, pair in zip(rows.tolist(), ids.tolist(), strict=True):
                links = self._pair_of[pair]
                if found[row, links] or not (asked is None or asked[links]):
                    continue
                if row != placed:
                    self._place(q[row])
                    placed = row
                found[row, links] = pin.computeCollision(
                    self._geometry, self._geometry_data, pair
                )
        return found

    def distance(self, q: Array, pair: LinkPair) -> float:
        """The distance (m) of two links at q (nq,); negative for an overlap's depth."""
        self._place(q)
        return min(
            float(
                pin.computeDistance(self._geometry, self._geometry_data, i).min_distance
            )
            for i in self._ids[pair]
        )

    def joints_between(self, pair: LinkPair) -> list[int]:
        """The places in q of the joints that move two links against each other."""
        first, second = (set(self._model.supports[self._joints[link]]) for link in pair)
        return [int(self._model.joints[joint].idx_q) for joint in first ^ second]

    def any_of(self, q: Array, pairs: Sequence[LinkPair]) -> Mask:
        """Whether any of the pairs overlaps at q (n, nq), (n,)."""
        chosen = set(pairs)
        asked = np.array([pair in chosen for pair in self.pairs], dtype=np.bool_)
        return np.asarray(self.overlaps(q, asked).any(axis=1))

    def _place(self, q: Array) -> None:
        pin.updateGeometryPlacements(
            self._model, self._data, self._geometry, self._geometry_data, q
        )
