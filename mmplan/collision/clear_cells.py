"""Where pairs of the robot's own bodies are apart, as tables.

The pose of one link relative to another depends on the joints between them alone.
Where these are no more than two, their values are cut into cells, and it is found out
once for each cell whether the pair stays apart anywhere in it: it does if its distance
in the middle is more than the joints can carry the bodies from there. Such cells need
no further look at these bodies, whatever else the robot does.
"""

from __future__ import annotations

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import pinocchio as pin

from mmplan.collision.levers import pair_levers
from mmplan.collision.pairs import Flags
from mmplan.collision.requests import PROVABLE, make_exact
from mmplan.robot import Robot
from mmplan.shapes import Array

# Cells for the values of a joint: neighbouring links mostly turn against each other.
_CELLS = 48


class ClearCells(NamedTuple):
    """One pair's table.

    `cells` (6,) are the places of both joints in q, then for each the lowest value and
    the width of a cell; `clear` (k, k) says in which cells the pair is apart.
    """

    cells: Array
    clear: Flags


# The tables made so far; they hold in every world.
_MADE: WeakKeyDictionary[Robot, dict[tuple[int, int], ClearCells]] = WeakKeyDictionary()


def clear_cells_made(robot: Robot) -> dict[tuple[int, int], ClearCells]:
    """The tables that were made for pairs of a robot's bodies."""
    return _MADE.setdefault(robot, {})


def clear_cells(robot: Robot, first: int, second: int) -> ClearCells | None:
    """The table of two bodies of a robot's geometry; None if too many joints count."""
    made = clear_cells_made(robot)
    if (first, second) not in made:
        table = _make(robot, first, second)
        if table is None:
            return None
        made[first, second] = table
    return made[first, second]


def _make(robot: Robot, first: int, second: int) -> ClearCells | None:
    model, bodies = robot.model, robot.geometry.geometryObjects
    pair = np.array([[first, second]])
    lever = pair_levers(model, robot.geometry, pair)[0]
    joints = np.flatnonzero(lever)
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    if not 1 <= len(joints) <= 2 or not np.isfinite(upper - lower)[joints].all():
        return None
    a, b = int(joints[0]), int(joints[-1])
    widths = (upper - lower) / _CELLS
    geometry = pin.GeometryModel()
    for body in (first, second):
        geometry.addGeometryObject(bodies[body])
    geometry.addCollisionPair(pin.CollisionPair(0, 1))
    distances = _distances(model, geometry, a, b)
    reach = float(lever[joints] @ widths[joints]) / 2.0
    cells = np.array([a, b, lower[a], widths[a], lower[b], widths[b]])
    return ClearCells(cells, distances > reach + PROVABLE)


def _distances(model: pin.Model, geometry: pin.GeometryModel, a: int, b: int) -> Array:
    """The distances of a geometry's one pair in the middles of all cells, (k, k)."""
    lower, upper = model.lowerPositionLimit, model.upperPositionLimit
    middles = (np.arange(_CELLS) + 0.5) / _CELLS
    data, geometry_data = model.createData(), geometry.createData()
    make_exact(geometry_data)
    q = pin.neutral(model)
    distances = np.empty((_CELLS, _CELLS))
    for i, x in enumerate(lower[a] + middles * (upper[a] - lower[a])):
        for j, y in enumerate(lower[b] + middles * (upper[b] - lower[b])):
            q[a], q[b] = x, y  # the same joint twice where there is but one
            pin.updateGeometryPlacements(model, data, geometry, geometry_data, q)
            found = pin.computeDistance(geometry, geometry_data, 0)
            distances[i, j] = found.min_distance
    return distances
