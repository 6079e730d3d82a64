"""Distances of the robot's links to the nearest obstacle, for many configurations."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.collision.requests import make_exact
from mmplan.collision.world import CollisionWorld
from mmplan.kinematics import ForwardKinematics
from mmplan.shapes import Array


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
        obstacles = [i for i, b in enumerate(bodies) if b.kind in _OBSTACLE]
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
        self._body_joint = [bodies[i].joint for i in self._robot_bodies]
        self._body_placement = _placements(self._geometry, self._robot_bodies)

    def __call__(self, q: Array, links: npt.NDArray[np.int64]) -> Array:
        """Distances (n, len(links)) in metres at q (n, nq) of some of `self.links`.

        A link that overlaps an obstacle has a distance of 0 or less. Without any
        obstacle distances are infinite.
        """
        bodies = np.flatnonzero(np.isin(self._link_of_body, links))
        column = np.searchsorted(links, self._link_of_body[bodies]).tolist()
        distances = np.full((len(q), len(links)), np.inf)
        for start in range(0, len(q), _CHUNK):
            chunk = slice(start, start + _CHUNK)
            gaps = self._gaps(q[chunk], bodies)  # (chunk, bodies, obstacles)
            order = np.argsort(gaps, axis=2)
            gaps = np.take_along_axis(gaps, order, axis=2)
            pairs = np.take_along_axis(self._pair[None, bodies], order, axis=2)
            for row, found in enumerate(distances[chunk]):
                self._place(q[start + row])
                for body, link in enumerate(column):
                    nearest = self._nearest(
                        gaps[row, body], pairs[row, body], found[link]
                    )
                    found[link] = nearest
        return distances

    def _gaps(self, q: Array, bodies: npt.NDArray[np.int64]) -> Array:
        """Lower bounds (n, bodies, obstacles) of distances, infinite for no pair."""
        joints = [self._body_joint[b] for b in bodies]
        T = self._kinematics(q)[:, joints] @ self._body_placement[bodies]
        local = Bounds(*(part[bodies] for part in self._body_bounds))
        moved = moved_bounds(local, T)
        gaps = Bounds(*(part[:, :, None] for part in moved)).gap(self._obstacle_bounds)
        return np.where(self._pair[bodies] >= 0, gaps, np.inf)

    def _place(self, q: Array) -> None:
        pin.updateGeometryPlacements(
            self._model, self._data, self._geometry, self._geometry_data, q
        )

    def _nearest(
        self, gaps: Array, pairs: npt.NDArray[np.int64], nearest: float
    ) -> float:
        """The least of `nearest` and the exact distances of pairs, by rising bounds."""
        for start in range(0, len(gaps), _FEW):
            few = slice(start, start + _FEW)
            for gap, pair in zip(gaps[few].tolist(), pairs[few].tolist(), strict=True):
                if gap >= nearest:
                    return nearest
                result = pin.computeDistance(self._geometry, self._geometry_data, pair)
                nearest = min(nearest, result.min_distance)
        return nearest


# Configurations bounded in one go, so that the arrays stay in the cache.
_CHUNK = 128
# Pairs looked at in one go; seldom do more matter.
_FEW = 8
_ROBOT = ("base", "arm", "finger")
_OBSTACLE = ("ground", "obstacle", "standing")


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
