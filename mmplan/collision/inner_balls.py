"""Balls by which the distance from a body to anything is bounded above."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import coal
import numpy as np

from mmplan.collision.bounds import local_bounds
from mmplan.shapes import Array


class Balls(NamedTuple):
    """Balls that a body holds at least a point of.

    A ball of a radius of 0 or more lies within the body. A negative radius -r says
    that some point of the body is no further than r from the centre. Either way the
    body is no further from a point x than |x - centre| - radius.
    """

    centres: Array  # (k, 3), in the body's frame
    radii: Array  # (k,)


def inner_balls(geometry: coal.CollisionGeometry) -> Balls:
    """A few balls that reach to all sides of a convex body."""
    for kind, balls in _RULES.items():
        if isinstance(geometry, kind):
            return balls(geometry)
    box = local_bounds(geometry)
    return Balls(box.centre[None], np.array([-np.linalg.norm(box.half)]))


def _of_sphere(sphere: coal.Sphere) -> Balls:
    return Balls(np.zeros((1, 3)), np.array([sphere.radius]))


def _of_capsule(capsule: coal.Capsule) -> Balls:
    return _along_z(capsule.halfLength, capsule.radius)


def _of_cylinder(cylinder: coal.Cylinder) -> Balls:
    """Balls along the axis, and points of both rims."""
    radius = min(cylinder.radius, cylinder.halfLength)
    inside = _along_z(cylinder.halfLength - radius, radius)
    angles = np.arange(_RIM) * (2 * np.pi / _RIM)
    circle = cylinder.radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    ends = [
        np.column_stack([circle, np.full(_RIM, z)])
        for z in (-cylinder.halfLength, cylinder.halfLength)
    ]
    return _join(inside, _points(np.concatenate(ends)))


def _of_box(box: coal.Box) -> Balls:
    """Balls along the longest axis, and the corners."""
    half = np.ravel(box.halfSide)
    radius = float(half.min())
    axis = int(np.argmax(half))
    inside = _along_z(float(half[axis]) - radius, radius)
    inside.centres[:, [axis, 2]] = inside.centres[:, [2, axis]]
    signs = np.array(np.meshgrid(*[(-1.0, 1.0)] * 3)).reshape(3, -1).T
    return _join(inside, _points(signs * half))


def _of_hull(hull: coal.ConvexBase) -> Balls:
    """Vertices that are far from each other, and their middle."""
    vertices = np.asarray(hull.points())
    chosen = _spread(vertices, _VERTICES)
    return _points(np.concatenate([chosen, chosen.mean(axis=0)[None]]))


def _along_z(half_length: float, radius: float) -> Balls:
    count = _AXIS if half_length > 0.0 else 1
    centres = np.zeros((count, 3))
    centres[:, 2] = np.linspace(-half_length, half_length, count)
    return Balls(centres, np.full(count, radius))


def _points(points: Array) -> Balls:
    return Balls(points, np.zeros(len(points)))


def _join(first: Balls, second: Balls) -> Balls:
    return Balls(*(np.concatenate(parts) for parts in zip(first, second, strict=True)))


def _spread(points: Array, most: int) -> Array:
    """At most so many of the points, each as far as can be from those before it."""
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    chosen = [int(np.argmax(np.linalg.norm(points - middle, axis=1)))]
    apart = np.full(len(points), np.inf)
    while len(chosen) < min(most, len(points)):
        step = np.linalg.norm(points - points[chosen[-1]], axis=1)
        apart = np.minimum(apart, step)
        chosen.append(int(np.argmax(apart)))
    return points[chosen]


# How many balls along an axis, points of a rim, vertices of a hull.
_AXIS, _RIM, _VERTICES = 3, 4, 8

_RULES: dict[type[coal.CollisionGeometry], Callable[..., Balls]] = {
    coal.Sphere: _of_sphere,
    coal.Capsule: _of_capsule,
    coal.Cylinder: _of_cylinder,
    coal.Box: _of_box,
    coal.ConvexBase: _of_hull,
}
