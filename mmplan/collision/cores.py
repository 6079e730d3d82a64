"""What certainly lies within convex bodies: a box in each, and balls along it.

Where what is within one body is deep in what is within another, so are the bodies: that
takes no exact check.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import coal
import numpy as np

from mmplan.collision.bounds import Bounds, local_bounds
from mmplan.collision.inner_balls import inner_balls
from mmplan.shapes import Array, read_only

# With how many balls a body is filled, and in how many places along each axis the
# best one is searched.
BALLS = 5
_PLACES = 9
# Of how many hulls this is remembered: a robot's come again with every world.
_REMEMBERED = 256
# The radius of balls, and the size of boxes, that are not there.
_NONE = -np.inf


class Core(NamedTuple):
    """What is within a body, in its frame."""

    box: Bounds  # along the axes of the frame; -inf large where none is known
    balls: Array  # (`BALLS`, 4), centres and radii, these -inf where there is none


def core_of(geometry: coal.CollisionGeometry) -> Core:
    """The core of a body; that of a hull has the proportions of the box about it."""
    if isinstance(geometry, coal.ConvexBase):
        corners = np.ascontiguousarray(geometry.points(), dtype=np.float64)
        return _core_of_hull(corners.tobytes())
    return Core(_box(geometry), _balls(geometry))


def _box(geometry: coal.CollisionGeometry) -> Bounds:
    if isinstance(geometry, coal.Box):
        return local_bounds(geometry)
    half = np.full(3, _NONE)
    if isinstance(geometry, coal.Sphere):
        half = np.full(3, geometry.radius / np.sqrt(3.0))
    if isinstance(geometry, coal.Cylinder | coal.Capsule):
        side = geometry.radius / np.sqrt(2.0)
        half = np.array([side, side, geometry.halfLength])
    return Bounds(np.zeros(3), half)


def _balls(geometry: coal.CollisionGeometry) -> Array:
    """Balls of one size from one end of a body to the other, (`BALLS`, 4)."""
    centres, radii = inner_balls(geometry)
    radius = float(radii[0]) if radii[0] > 0.0 else _NONE
    along = np.linspace(centres[0], centres[-1], BALLS)
    return np.column_stack([along, np.full(BALLS, radius)])


@lru_cache(maxsize=_REMEMBERED)
def _core_of_hull(corners: bytes) -> Core:
    from scipy.spatial import ConvexHull

    points = np.frombuffer(corners).reshape(-1, 3)
    planes = ConvexHull(points).equations  # (f, 4): all points have n·x + d <= 0
    low, high = points.min(axis=0), points.max(axis=0)
    about = Bounds((low + high) / 2, (high - low) / 2)
    places = _grid(about)
    depth = -(places @ planes[:, :3].T + planes[:, 3]).max(axis=1)
    found = np.column_stack([places, depth])
    return Core(_box_in(planes, about, found), read_only(_in_slices(about, found)))


def _grid(about: Bounds) -> Array:
    """Places within a box, (n, 3), those in the middle first."""
    shares = (2.0 * np.arange(_PLACES) + 1.0) / _PLACES - 1.0
    shares = shares[np.argsort(np.abs(shares), kind="stable")]
    grid = np.stack(np.meshgrid(shares, shares, shares, indexing="ij"), axis=-1)
    places: Array = about.centre + grid.reshape(-1, 3) * about.half
    return places


def _box_in(planes: Array, about: Bounds, found: Array) -> Bounds:
    """The box about a hull made small around the place that is deepest within."""
    centre = found[np.argmax(found[:, 3]), :3]
    room = -(planes[:, :3] @ centre + planes[:, 3])
    share = float((room / (np.abs(planes[:, :3]) @ about.half)).min())
    return Bounds(centre, share * about.half if share > 0.0 else np.full(3, _NONE))


def _in_slices(about: Bounds, found: Array) -> Array:
    """The largest of balls (n, 4) in each slice across the longest side."""
    axis = int(np.argmax(about.half))
    along = (found[:, axis] - about.centre[axis]) / about.half[axis]  # -1 to 1
    slice_ = np.floor((along + 1.0) / 2.0 * BALLS)
    balls = [found[slice_ == k] for k in range(BALLS)]
    best = np.array([b[np.argmax(b[:, 3])] for b in balls])
    best[best[:, 3] <= 0.0, 3] = _NONE
    return best
