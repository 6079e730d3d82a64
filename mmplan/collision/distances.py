"""Distances of the robot's links to the nearest obstacle, for many configurations."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.collision.requests import make_exact
from mmplan.collision.world import CollisionWorld
from mmplan.kinematics import ForwardKinematics
from mmplan.shapes import Array

Indices = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]


class LinkDistances:
    """The distance d_l from each link to the nearest obstacle (paper, eq. 2).

    Obstacles are all bodies of the world that do not move with the robot, but for the
    ground where a link of the base is concerned; an object that is left out of the
    world, as the one being carried is, counts as none.

    Bounds of all pairs are computed at once; coal is asked only for the pairs whose
    bounds do not already say that another obstacle is nearer.
    """

    def __init__(self, world: CollisionWorld) -> None:
        """Prepare the distances in a world; later changes of it are not seen."""
        bodies = world.bodies
        self._model = world.model
        self._kinematics = ForwardKinematics(world.model)
        self._geometry = world.geometry.clone()
        self._robot_bodies = [i for i, b in enumerate(bodies) if b.kind in _ROBOT]
        obstacles = [i for i, b in enumerate(bodies) if b.kind in OBSTACLES]
        owners = [bodies[i].owner for i in self._robot_bodies]
        self.links: tuple[str, ...] = tuple(dict.fromkeys(owners))
        self._link_of_body = np.array([self.links.index(o) for o in owners])
        self._pair = _add_pairs(self._geometry, bodies, self._robot_bodies, obstacles)
        self._data = self._model.createData()
        self._geometry_data = self._geometry.createData()
        make_exact(self._geometry_data)
        self._body_bounds = _stack(self._geometry, self._robot_bodies)
        self._obstacle_bounds = moved_bounds(
            _stack(self._geometry, obstacles), _placements(self._geometry, obstacles)
        )
        self._body_joint = np.array([bodies[i].joint for i in self._robot_bodies])
        self._body_placement = _placements(self._geometry, self._robot_bodies)

    def __call__(
        self,
        q: Array,
        links: Indices,
        needed: Mask | None = None,
        most: Array | None = None,
    ) -> Array:
        """Distances (n, len(links)) in metres at q (n, nq) of some of `self.links`.

        A link that overlaps an obstacle has a distance of 0 or less. Without any
        obstacle distances are infinite. Only those are computed that are `needed`
        (n, len(links)), all by default; the others are infinite. Where it is known what
        the distances are at `most` (n, len(links)) there is less to look at.
        """
        distances = np.full((len(q), len(links)), np.inf)
        needed = np.isinf(distances) if needed is None else needed
        most = distances if most is None else most
        for start in range(0, len(q), _CHUNK):
            chunk = slice(start, start + _CHUNK)
            T, place = self._kinematics(q[chunk]), self._placing(q[chunk])
            wanted = _Wanted(links, needed[chunk], most[chunk])
            distances[chunk] = self._measure(T, place, wanted)
        return distances

    def at(self, T_world_joint: Array, links: Indices) -> Array:
        """Distances (n, len(links)), from poses (n, njoints, 4, 4) of the joints."""
        nothing = np.full((len(T_world_joint), len(links)), np.inf)
        moving = np.unique(self._body_joint[np.isin(self._link_of_body, links)])
        place = self._placing_joints(T_world_joint, moving.tolist())
        wanted = _Wanted(links, np.isinf(nothing), nothing)
        return self._measure(T_world_joint, place, wanted)

    def _measure(
        self, T: Array, place: Callable[[int], None], wanted: _Wanted
    ) -> Array:
        """The distances (n, links) that are needed, infinite elsewhere, row by row."""
        links, needed, most = wanted
        bodies = np.flatnonzero(np.isin(self._link_of_body, links))
        column = np.searchsorted(links, self._link_of_body[bodies])
        row, which = np.nonzero(needed[:, column])
        gaps, pairs, stops = self._suspects(
            T, row, bodies[which], most[row, column[which]]
        )
        distances = np.full(needed.shape, np.inf)
        start, placed = 0, -1
        places = zip(row.tolist(), column[which].tolist(), stops, strict=True)
        for i, j, stop in places:
            if i != placed:
                place(i)
                placed = i
            nearest = float(distances[i, j])
            for k in range(start, stop):
                if gaps[k] >= nearest:
                    break
                nearest = min(nearest, self._distance(pairs[k]))
            distances[i, j] = nearest
            start = stop
        return distances

    def _suspects(
        self, T: Array, row: Indices, bodies: Indices, most: Array
    ) -> tuple[list[float], list[int], list[int]]:
        """The obstacles that may be nearest to bodies (k,), no further than `most`.

        Body `bodies[k]` is moved by its joint's pose in row `row[k]` of T. For all
        pairs body by body, by rising lower bounds of their distances: these bounds, the
        pairs' ids, and where the pairs of each body end.
        """
        moving = T[row, self._body_joint[bodies]] @ self._body_placement[bodies]
        local = Bounds(*(part[bodies] for part in self._body_bounds))
        moved = moved_bounds(local, moving)
        gaps = Bounds(*(part[:, None] for part in moved)).gap(self._obstacle_bounds)
        near = (gaps <= most[:, None]) & (self._pair[bodies] >= 0)
        body, obstacle = np.nonzero(near)
        gap = gaps[body, obstacle]
        if len(gap) < _DENSE * near.size:
            # In the axes of the body its own bounds fit, and more pairs are apart.
            other = Bounds(*(part[obstacle] for part in self._obstacle_bounds))
            turned = moved_bounds(other, np.linalg.inv(moving)[body])
            own = Bounds(*(part[body] for part in local))
            gap = np.maximum(gap, own.gap(turned))
        order = np.lexsort((gap, body))
        stops = np.cumsum(np.bincount(body, minlength=len(bodies)))
        pairs = self._pair[bodies[body], obstacle]
        return gap[order].tolist(), pairs[order].tolist(), stops.tolist()

    def _placing(self, q: Array) -> Callable[[int], None]:
        """What puts all bodies where they are at a row of q (n, nq)."""
        geometry, data = self._geometry, self._geometry_data

        def place(row: int) -> None:
            pin.updateGeometryPlacements(
                self._model, self._data, geometry, data, q[row]
            )

        return place

    def _placing_joints(
        self, T_world_joint: Array, joints: list[int]
    ) -> Callable[[int], None]:
        """What puts the bodies of some joints where these are in a row."""
        geometry, data = self._geometry, self._geometry_data

        def place(row: int) -> None:
            for joint in joints:
                self._data.oMi[joint] = pin.SE3(T_world_joint[row, joint])
            pin.updateGeometryPlacements(self._model, self._data, geometry, data)

        return place

    def _distance(self, pair: int) -> float:
        result = pin.computeDistance(self._geometry, self._geometry_data, pair)
        return float(result.min_distance)


class _Wanted(NamedTuple):
    """Which distances of some links are needed, and what they are at most."""

    links: Indices
    needed: Mask  # (n, links)
    most: Array  # (n, links), m


# Configurations bounded in one go, so that the arrays stay in the cache.
_CHUNK = 128
# The share of pairs up to which it pays to bound distances once more.
_DENSE = 0.2
_ROBOT = ("base", "arm", "finger")
OBSTACLES = ("ground", "obstacle", "standing")


def _add_pairs(
    geometry: pin.GeometryModel,
    bodies: Sequence[tuple[str, str, int]],
    robot_bodies: list[int],
    obstacles: list[int],
) -> npt.NDArray[np.int64]:
    """Make the pairs of robot and obstacles the only ones; their ids or -1."""
    geometry.removeAllCollisionPairs()
    ids = np.full((len(robot_bodies), len(obstacles)), -1)
    for row, i in enumerate(robot_bodies):
        for column, j in enumerate(obstacles):
            if (bodies[i][1], bodies[j][1]) != ("base", "ground"):
                ids[row, column] = len(geometry.collisionPairs)
                geometry.addCollisionPair(pin.CollisionPair(i, j))
    return ids


def _stack(geometry: pin.GeometryModel, indices: list[int]) -> Bounds:
    bounds = [local_bounds(geometry.geometryObjects[i].geometry) for i in indices]
    return Bounds(
        np.array([b.centre for b in bounds]).reshape(-1, 3),
        np.array([b.half for b in bounds]).reshape(-1, 3),
    )


def _placements(geometry: pin.GeometryModel, indices: list[int]) -> Array:
    poses = [geometry.geometryObjects[i].placement.homogeneous for i in indices]
    return np.array(poses).reshape(-1, 4, 4)
