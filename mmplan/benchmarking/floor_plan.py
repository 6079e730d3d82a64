"""What a picture of base placements needs of a problem: footprints, start and goal."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np

from mmplan.collision import CollisionWorld, local_bounds
from mmplan.problem import Problem
from mmplan.shapes import Array

_CORNERS = np.array(list(product((-1.0, 1.0), repeat=3)))  # (8, 3)


def floor_plan(problem: Problem) -> dict[str, Any]:
    """Plain values in metres, in the world's x and y.

    `bodies` are boxes around the obstacles' bodies: `owner`, `kind` (obstacle or
    ground), `corners` (8, 2) and `heights`, the lowest and the highest z. `start` and
    `goal` are where the first task's object stands and goes; `radius` is the base's.
    """
    world = CollisionWorld.of_problem(problem)
    task = problem.tasks[0]
    bodies = [
        _footprint(world, i)
        for i, body in enumerate(world.bodies)
        if body.kind in ("obstacle", "ground")
    ]
    return {
        "bodies": bodies,
        "start": problem.object(task.object).T_world_object[:2, 3].tolist(),
        "goal": task.T_world_goal[:2, 3].tolist(),
        "radius": problem.robot.base_radius,
    }


def _footprint(world: CollisionWorld, index: int) -> dict[str, Any]:
    geometry = world.geometry.geometryObjects[index]
    box = local_bounds(geometry.geometry)
    T: Array = geometry.placement.homogeneous
    corners = (box.centre + _CORNERS * box.half) @ T[:3, :3].T + T[:3, 3]
    body = world.bodies[index]
    return {
        "owner": body.owner,
        "kind": body.kind,
        "corners": corners[:, :2].tolist(),
        "heights": [float(corners[:, 2].min()), float(corners[:, 2].max())],
    }
