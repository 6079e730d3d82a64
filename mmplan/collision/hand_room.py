"""Where there is room for an opened hand around a mesh."""

from __future__ import annotations

import coal
import numpy as np
import numpy.typing as npt

from mmplan.collision.bounds import local_bounds
from mmplan.collision.fingers import Finger, Fingers
from mmplan.collision.hand_size import hands_open_by
from mmplan.collision.requests import collision_request
from mmplan.collision.separation import transform
from mmplan.kinematics import joint_placements
from mmplan.robot import Robot
from mmplan.shapes import Array

# What is left free on both sides together between an object and fingers around it, m.
_SPARE = 0.004


class HandRoom:
    """The palm and the fingers of a robot's hand, against the surface of a mesh."""

    def __init__(self, robot: Robot) -> None:
        """Find the bodies of the hand."""
        self._robot = robot
        self._fingers = Fingers(robot)
        palm = (
            body
            for body in robot.geometry.geometryObjects
            if body.parentJoint == robot.tool_joint
        )
        self.palm = Finger(tuple(palm))

    def is_free(
        self, surface: coal.BVHModelBase, T_object_tool: Array, widths: Array
    ) -> npt.NDArray[np.bool_]:
        """Whether the hand meets nothing on things of some widths (n,), m, (n,).

        At tool poses (n, 4, 4): the palm, and the fingers opened a little wider than
        the thing.
        """
        free = np.ones(len(T_object_tool), np.bool_)
        around = hands_open_by(self._robot, widths + _SPARE)
        fingers = [f for drive in self._fingers.drives for f in drive.fingers.values()]
        for part in (self.palm, *fingers):
            rows = np.flatnonzero(free)
            placed = self._fingers.placed(T_object_tool[rows], around[rows], part)
            for geometry, T in placed:
                free[rows] &= ~_hits(surface, geometry, T)
        return free

    def signature(self) -> bytes:
        """What the hand is, for the names of caches."""
        robot = self._robot
        T = joint_placements(robot.model, robot.q_neutral[None])[0]
        T_tool_world = np.linalg.inv(T[robot.tool_joint] @ robot.T_joint_tool)
        parts = [robot.hand_open.tobytes(), robot.hand_closed.tobytes()]
        for body in robot.geometry.geometryObjects:
            if robot.tool_joint in robot.model.supports[body.parentJoint]:
                pose = T_tool_world @ T[body.parentJoint] @ body.placement.homogeneous
                box = local_bounds(body.geometry)
                volume = np.array([body.geometry.computeVolume()])
                numbers = (np.round(pose, 9), box.centre, box.half, volume)
                parts += [part.tobytes() for part in numbers]
        return b"".join(parts)


def _hits(
    surface: coal.BVHModelBase, geometry: coal.CollisionGeometry, T: Array
) -> npt.NDArray[np.bool_]:
    """Whether a geometry at poses (n, 4, 4) meets the surface, (n,)."""
    hits = np.zeros(len(T), np.bool_)
    for i, pose in enumerate(T):
        result = coal.CollisionResult()
        coal.collide(geometry, transform(pose), surface, _ORIGIN, _REQUEST, result)
        hits[i] = result.isCollision()
    return hits


_ORIGIN = transform(np.eye(4))
_REQUEST = collision_request(0.0)
