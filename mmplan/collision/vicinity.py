"""How far the robot's links are from the nearest obstacle at most, by lookup."""

from __future__ import annotations

import coal
import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision.distances import OBSTACLES
from mmplan.collision.inner_balls import inner_balls
from mmplan.collision.requests import SCORE_TOLERANCE, distance_request
from mmplan.collision.separation import transform
from mmplan.collision.world import CollisionWorld
from mmplan.shapes import Array

Indices = npt.NDArray[np.int64]


class Vicinity:
    """Points of the nearest obstacle, remembered for the nodes of a grid.

    The distance from a point x to any point of an obstacle bounds the distance from x
    to the nearest obstacle above, and bounds it well if that obstacle is the nearest
    one to a node of the grid beside x. The grid is laid around the points that are
    asked for first; its nodes are looked at when they are first needed. Beyond the grid
    its outermost nodes serve.
    """

    def __init__(self, geometry: pin.GeometryModel, obstacles: list[int]) -> None:
        """Prepare for the bodies `obstacles` of a geometry model, which stand still."""
        self._objects = [_collision_object(geometry, i) for i in obstacles]
        self._tree = coal.DynamicAABBTreeCollisionManager()
        for item in self._objects:
            self._tree.registerObject(item)
        self._tree.setup()
        self._ask = coal.DistanceCallBackDefault()
        self._ask.data.request = distance_request(SCORE_TOLERANCE)
        self._probe = coal.CollisionObject(coal.Sphere(_PROBE))
        self._origin: Array | None = None
        self._row = np.full(_NODES**3, -1, dtype=np.int64)
        self._nearest = np.empty((0, 3))

    def distances(self, points: Array) -> Array:
        """Upper bounds (n,) of the distances from points (n, 3), in m."""
        if not self._objects or len(points) == 0:
            return np.full(len(points), np.inf)
        if self._origin is None:
            self._origin = np.mean(points, axis=0) - _SPACING * _NODES / 2
        place = np.rint((points - self._origin) / _SPACING).astype(np.int64)
        np.clip(place, 0, _NODES - 1, out=place)
        node = (place[:, 0] * _NODES + place[:, 1]) * _NODES + place[:, 2]
        row = self._row[node]
        if np.any(row < 0):
            self._look_at(np.unique(node[row < 0]), self._origin)
            row = self._row[node]
        away = points - self._nearest[row]
        away *= away
        distances: Array = np.sqrt(away[:, 0] + away[:, 1] + away[:, 2])
        return distances + _SLACK

    def _look_at(self, nodes: Indices, origin: Array) -> None:
        known = len(self._nearest)
        places = np.stack(np.unravel_index(nodes, (_NODES,) * 3), axis=1)
        found = [self._nearest_point(x) for x in origin + _SPACING * places]
        self._nearest = np.concatenate([self._nearest, np.array(found)])
        self._row[nodes] = np.arange(known, len(self._nearest))

    def _nearest_point(self, x: Array) -> Array:
        """A point of the obstacle nearest to x (3,); x itself inside of one."""
        self._probe.setTranslation(x)
        self._probe.computeAABB()
        self._ask.data.clear()
        self._tree.distance(self._probe, self._ask)
        result = self._ask.data.result
        if result.min_distance <= 0.0:
            return x
        # Which of the two points is the obstacle's depends on the tree.
        points = result.getNearestPoint1(), result.getNearestPoint2()
        nearest: Array = max(points, key=lambda point: float(abs(point - x).sum()))
        return nearest


class LinkBounds:
    """Upper bounds of the distances from links to the nearest obstacle."""

    def __init__(self, world: CollisionWorld, links: tuple[str, ...]) -> None:
        """Prepare for some of the links of a world's robot."""
        geometry, bodies = world.geometry, world.bodies
        obstacles = [i for i, b in enumerate(bodies) if b.kind in OBSTACLES]
        self._vicinity = Vicinity(geometry, obstacles)
        joints, centres, radii, owners = [], [], [], []
        for link, joint, body in sorted(
            (links.index(b.owner), b.joint, i)
            for i, b in enumerate(bodies)
            if b.owner in links
        ):
            item = geometry.geometryObjects[body]
            balls, T = inner_balls(item.geometry), item.placement.homogeneous
            centres.append(balls.centres @ T[:3, :3].T + T[:3, 3])
            radii.append(balls.radii)
            owners += [link] * len(balls.radii)
            joints += [joint] * len(balls.radii)
        self._centres, self._radii = np.concatenate(centres), np.concatenate(radii)
        self._joints = np.array(joints)
        self._starts = np.searchsorted(owners, np.arange(len(links)))

    def __call__(self, T_world_joint: Array) -> Array:
        """Upper bounds (n, links) in m at the poses (n, njoints, 4, 4) of all joints.

        Infinite where there is no obstacle.
        """
        points = np.empty((len(T_world_joint), len(self._centres), 3))
        for joint in np.unique(self._joints):
            T, which = T_world_joint[:, joint], self._joints == joint
            moved = T[:, :3, :3] @ self._centres[which].T + T[:, :3, 3:]
            points[:, which] = moved.transpose(0, 2, 1)
        apart = self._vicinity.distances(points.reshape(-1, 3))
        apart = apart.reshape(points.shape[:2]) - self._radii
        bounds: Array = np.minimum.reduceat(apart, self._starts, axis=1)
        return np.maximum(bounds, 0.0)


def _collision_object(geometry: pin.GeometryModel, i: int) -> coal.CollisionObject:
    item = geometry.geometryObjects[i]
    return coal.CollisionObject(item.geometry, transform(item.placement.homogeneous))


# The grid: nodes along each axis, and the distance between neighbours, m.
_NODES, _SPACING = 48, 0.12
# The radius of the ball that stands for a node, m, and what makes up for it and for
# the tolerance of exact distances.
_PROBE, _SLACK = 1e-9, 1e-5
