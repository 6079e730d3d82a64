"""Closing the hand on an object until the fingers touch it."""

from __future__ import annotations

from typing import NamedTuple

import coal
import numpy as np
import numpy.typing as npt
import pinocchio as pin

from mmplan.collision.bounds import Bounds, local_bounds, moved_bounds
from mmplan.collision.separation import signed_distance, transform
from mmplan.collision.solids import Solid
from mmplan.kinematics import ForwardKinematics, joint_placements, motion_axis
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
        self._transforms = [transform(T) for T in placements]
        self._kinematics = ForwardKinematics(robot.model)
        names = robot.hand.names
        self._fingers = [_bodies_moved_by(robot, name) for name in names]
        self._top_speeds = [
            _top_speed(robot, name, bodies)
            for name, bodies in zip(names, self._fingers, strict=True)
        ]

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
        """Move one finger of n hands to contact, `hand` in place; which touch, (n,)."""
        stop = self._robot.hand_closed[finger]
        direction = np.sign(stop - self._robot.hand_open[finger])
        touching = np.zeros(len(hand), dtype=np.bool_)
        moving = np.arange(len(hand))
        for _ in range(_MAX_STEPS):
            distance = self._distances(T_object_tool[moving], hand[moving], finger)
            near = distance <= CONTACT_DISTANCE
            touching[moving[near]] = distance[near] > 0.0
            ahead = (distance - CONTACT_DISTANCE / 2) / self._top_speeds[finger]
            missed = ~near & (ahead >= np.abs(stop - hand[moving, finger]))
            hand[moving[missed], finger] = stop
            on = ~near & ~missed
            moving, ahead = moving[on], ahead[on]
            hand[moving, finger] += direction * ahead
            if len(moving) == 0:
                break
        return touching

    def _distances(self, T_object_tool: Array, hand: Array, finger: int) -> Array:
        """Distances (n,) of one finger to the object."""
        robot = self._robot
        q = np.tile(robot.q_neutral, (len(hand), 1))
        q[:, robot.hand.indices] = hand
        T_world_joint = self._kinematics(q)
        T_tool_world = np.linalg.inv(
            T_world_joint[:, robot.tool_joint] @ robot.T_joint_tool
        )
        distance = np.full(len(hand), np.inf)
        for body in self._fingers[finger]:
            T = T_world_joint[:, body.parentJoint] @ body.placement.homogeneous
            T_object_body = T_object_tool @ T_tool_world @ T
            distance = np.minimum(distance, self._nearest(body.geometry, T_object_body))
        return distance

    def _nearest(self, geometry: coal.CollisionGeometry, T: Array) -> Array:
        """Distances (n,) of a geometry at poses (n, 4, 4) to the object."""
        bounds = moved_bounds(local_bounds(geometry), T)
        gaps = Bounds(*(part[:, None] for part in bounds)).gap(self._bounds)
        nearest = np.full(len(T), np.inf)
        for i, order in enumerate(np.argsort(gaps, axis=1)):
            pose = transform(T[i])
            for j in order:
                if gaps[i, j] >= nearest[i]:
                    break
                other, T_other = self._solids[j].geometry, self._transforms[j]
                distance = signed_distance(geometry, pose, other, T_other)
                nearest[i] = min(nearest[i], distance)
        return nearest


def _bodies_moved_by(robot: Robot, name: str) -> list[pin.GeometryObject]:
    """The collision bodies that a joint moves."""
    joint = robot.model.getJointId(name)
    return [
        body
        for body in robot.geometry.geometryObjects
        if joint in robot.model.supports[body.parentJoint]
    ]


def _top_speed(robot: Robot, name: str, bodies: list[pin.GeometryObject]) -> float:
    """The most that any point of the bodies moves per unit of a joint, m."""
    joint = robot.model.getJointId(name)
    linear, angular = np.split(motion_axis(robot.model, joint), 2)
    if not angular.any():
        return float(np.linalg.norm(linear))
    T_world_joint = joint_placements(robot.model, robot.q_neutral[None])[0]
    levers = []
    for body in bodies:
        box = local_bounds(body.geometry)
        centre = T_world_joint[body.parentJoint] @ body.placement.homogeneous
        offset = (
            centre[:3, :3] @ box.centre + centre[:3, 3] - T_world_joint[joint][:3, 3]
        )
        levers.append(np.linalg.norm(offset) + np.linalg.norm(box.half))
    return float(max(levers))
