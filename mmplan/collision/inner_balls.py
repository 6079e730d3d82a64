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
    """A few balls that reach far into a convex body's ends."""
    for kind, balls in _RULES.items():
        if isinstance(geometry, kind):
            return balls(geometry)
    box = local_bounds(geometry)
    return Balls(box.centre[None], np.array([-np.linalg.norm(box.half)]))


def _of_sphere(sphere: coal.Sphere) -> Balls:
    return Balls(np.zeros((1, 3)), np.array([sphere.radius]))


def _of_capsule(capsule: coal.Capsule) -> Balls:
    return _along(2, capsule.halfLength, capsule.radius)


def _of_cylinder(cylinder: coal.Cylinder) -> Balls:
    radius = min(cylinder.radius, cylinder.halfLength)
    return _along(2, cylinder.halfLength - radius, radius)


def _of_box(box: coal.Box) -> Balls:
    half = np.ravel(box.halfSide)
    radius, axis = float(half.min()), int(np.argmax(half))
    return _along(axis, float(half[axis]) - radius, radius)


def _of_hull(hull: coal.ConvexBase) -> Balls:
    """Vertices that are far from each other, and their middle."""
    chosen = _spread(np.asarray(hull.points()), _VERTICES)
    centres = np.concatenate([chosen, chosen.mean(axis=0)[None]])
    return Balls(centres, np.zeros(len(centres)))


def _along(axis: int, half_length: float, radius: float) -> Balls:
    """A ball at either end of a line, or the only one there is."""
    ends = [-half_length, half_length] if half_length > 0.0 else [0.0]
    centres = np.zeros((len(ends), 3))
    centres[:, axis] = ends
    return Balls(centres, np.full(len(ends), radius))


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


# How many vertices of a hull.
_VERTICES = 5

_RULES: dict[type[coal.CollisionGeometry], Callable[..., Balls]] = {
    coal.Sphere: _of_sphere,
    coal.Capsule: _of_capsule,
    coal.Cylinder: _of_cylinder,
    coal.Box: _of_box,
    coal.ConvexBase: _of_hull,
}
