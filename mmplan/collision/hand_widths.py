"""How wide an object is between the fingers of a hand, however wide that is."""

from __future__ import annotations

import numpy as np

from mmplan.collision.fingers import Fingers, ObjectSolids
from mmplan.collision.hand_size import hand_size
from mmplan.collision.pads import Placed
from mmplan.collision.solids import Solid
from mmplan.robot import Robot
from mmplan.shapes import Array

_CONTACT = 1e-4  # m
_MAX_STEPS = 60


def hand_widths(robot: Robot, solids: tuple[Solid, ...], T_object_tool: Array) -> Array:
    """The widths (n,), m, that an object has for the pads at tool poses (n, 4, 4).

    As if the fingers, as they are in the opened hand, came from far away on both sides
    along the tool's y until they touch. NaN where one of them misses the object.
    """
    thing, fingers = ObjectSolids(solids), Fingers(robot)
    hand = np.tile(robot.hand_open, (len(T_object_tool), 1))
    widths = np.full(len(T_object_tool), hand_size(robot).opening)
    for drive in fingers.drives:
        for finger in drive.fingers.values():
            placed = fingers.placed(T_object_tool, hand, finger)
            bodies = np.mean([T[:, :3, 3] for _, T in placed], axis=0)
            across = T_object_tool[:, :3, 1]
            side = np.einsum("ni,ni->n", bodies - T_object_tool[:, :3, 3], across)
            outward = np.where(side >= 0.0, 1.0, -1.0)[:, None] * across
            widths += _way_out(thing, placed, outward)
    return widths


def _way_out(thing: ObjectSolids, placed: Placed, outward: Array) -> Array:
    """How far out (n,), m, of where it is a finger touches; negative: farther in."""
    start = 2.0 * thing.half_diagonal + _reach(placed)
    way = np.full(len(outward), start)
    found = np.full(len(outward), np.nan)
    moving = np.arange(len(outward))
    for _ in range(_MAX_STEPS):
        nearest = np.full(len(moving), np.inf)
        for geometry, T in placed:
            moved = T[moving].copy()
            moved[:, :3, 3] += way[moving, None] * outward[moving]
            nearest = np.minimum(nearest, thing.nearest(geometry, moved))
        near = nearest <= _CONTACT
        found[moving[near]] = way[moving[near]]
        moving = moving[~near]
        way[moving] -= nearest[~near]
        moving = moving[way[moving] > -start]
        if len(moving) == 0:
            break
    return found


def _reach(placed: Placed) -> float:
    """How far from the object's origin the finger is at most."""
    return float(max(np.linalg.norm(T[:, :3, 3], axis=1).max() for _, T in placed))
