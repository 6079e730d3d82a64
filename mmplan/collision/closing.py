"""Closing the hand on an object until the fingers touch it."""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.collision.solids import Solid
from mmplan.kinematics import joint_placements
from mmplan.robot import Robot
from mmplan.shapes import Array

# A finger stops when it is this near to the object, m; it never overlaps it.
CONTACT_DISTANCE = 1e-4
# How far the fingers open beyond contact before grasping, as a share of their stroke.
OPENING_SHARE = 0.2
_MAX_STEPS = 60


class Closings(NamedTuple):
    """The hand on n grasps: joint values before and after it closes.

    `touches` says whether every finger touches, having been clear when fully open.
    """

    opened: Array  # (n, hand joints)
    closed: Array  # (n, hand joints)
    touches: npt.NDArray[np.bool_]  # (n,)


class HandCloser:
    """Closes each finger of a robot's hand on one object by conservative advancement.

    A finger moves by its distance to the object over the greatest speed of its points,
    so that it stops at contact without ever passing it.
    """

    def __init__(self, robot: Robot, solids: tuple[Solid, ...]) -> None:
        """Prepare for an object made of `solids`."""
        self._robot = robot
        self._solids = solids
        placements = np.array([s.placement for s in solids])
        local = [local_bounds(s.geometry) for s in solids]
        stacked = Bounds(*(np.array(part) for part in zip(*local, strict=True)))
        self._bounds = moved_bounds(stacked, placements)
        self._transforms = [_transform(T) for T in placements]

    def close(self, T_object_tool: Array) -> Closings:
        """Close the hand at tool poses (n, 4, 4) in the object's frame."""
        robot = self._robot
        n = len(T_object_tool)
        closed = np.tile(robot.hand_open, (n, 1))
        touches = np.ones(n, dtype=np.bool_)
        for finger in range(len(robot.hand)):
            touches &= self._advance(T_object_tool, closed, finger)
        stroke = robot.hand_closed - robot.hand_open
        past = OPENING_SHARE * np.abs(stroke)
        opened = closed - np.sign(stroke) * np.minimum(
            past, np.abs(closed - robot.hand_open)
        )
        return Closings(opened, closed, touches)

    def _advance(
        self, T_object_tool: Array, hand: Array, finger: int
    ) -> npt.NDArray[np.bool_]:
        """Move one finger of all hands (n, h) to contact, in place; who touches, (n,)."""
        stop = self._robot.hand_closed[finger]
        direction = np.sign(stop - self._robot.hand_open[finger])
        touching = np.zeros(len(hand), dtype=np.bool_)
        moving = np.ones(len(hand), dtype=np.bool_)
        for step in range(_MAX_STEPS):
            rows = np.flatnonzero(moving)
            if len(rows) == 0:
                break
            distance, reach = self._distances(T_object_tool[rows], hand[rows], finger)
            near = distance <= CONTACT_DISTANCE
            touching[rows] = near & ((step > 0) | (distance > 0.0))
            ahead = np.where(near, 0.0, (distance - CONTACT_DISTANCE / 2) / reach)
            at_stop = np.abs(stop - hand[rows, finger]) <= ahead
            hand[rows, finger] += direction * np.where(at_stop, 0.0, ahead)
            hand[rows[at_stop], finger] = np.where(
                near[at_stop], hand[rows[at_stop], finger], stop
            )
            moving[rows] = ~near & ~at_stop
        return touching

    def _distances(
        self, T_object_tool: Array, hand: Array, finger: int
    ) -> tuple[Array, Array]:
        """Distances (n,) of one finger to the object and its points' top speeds (n,)."""
        robot = self._robot
        joint = robot.model.getJointId(robot.hand.names[finger])
        q = np.tile(pin.neutral(robot.model), (len(hand), 1))
        q[:, robot.hand.indices] = hand
        placements = joint_placements(robot.model, q)
        T_tool_world = np.linalg.inv(placements[:, robot.tool_joint] @ robot.T_joint_tool)
        T_object_joint = T_object_tool @ T_tool_world @ placements[:, joint]
        distance = np.full(len(hand), np.inf)
        reach = 0.0
        for body in robot.geometry.geometryObjects:
            if joint in robot.model.supports[body.parentJoint]:
                T = T_object_joint @ body.placement.homogeneous
                distance = np.minimum(distance, self._nearest(body.geometry, T))
                reach = max(reach, _top_speed(robot.model, joint, body))
        return distance, np.full(len(hand), reach)

    def _nearest(self, geometry: coal.CollisionGeometry, T: Array) -> Array:
        """Distances (n,) of a geometry at poses (n, 4, 4) to the object."""
        bounds = moved_bounds(local_bounds(geometry), T)
        gaps = Bounds(*(part[:, None] for part in bounds)).gap(self._bounds)
        nearest = np.full(len(T), np.inf)
        request = coal.DistanceRequest()
        for i, order in enumerate(np.argsort(gaps, axis=1)):
            pose = _transform(T[i])
            for j in order:
                if gaps[i, j] >= nearest[i]:
                    break
                distance = coal.distance(
                    geometry,
                    pose,
                    self._solids[j].geometry,
                    self._transforms[j],
                    request,
                    coal.DistanceResult(),
                )
                nearest[i] = min(nearest[i], distance)
        return nearest


def _top_speed(model: pin.Model, joint: int, body: pin.GeometryObject) -> float:
    """The most that any point of a finger's body moves per unit of its joint."""
    if model.joints[joint].shortname().startswith(("JointModelP", "JointModelHelical")):
        return 1.0
    box = local_bounds(body.geometry)
    lever = float(np.linalg.norm(body.placement.translation) + np.linalg.norm(box.half))
    return lever + float(np.linalg.norm(box.centre))


def _transform(T: Array) -> coal.Transform3s:
    return coal.Transform3s(T[:3, :3], T[:3, 3])
