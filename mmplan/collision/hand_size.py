"""Measuring a robot's hand on its collision bodies."""

from __future__ import annotations

import coal
import numpy as np
import pinocchio as pin

from mmplan.collision.bounds import local_bounds, moved_bounds
from mmplan.collision.separation import signed_distance, transform
from mmplan.grasps.hand import HandSize
from mmplan.kinematics import joint_placements
from mmplan.robot import Robot
from mmplan.shapes import Array

_PROBE = 1e-4  # m, radius of the ball that stands for the tool frame's origin
_INTERPOLATED = 9
_NO_PALM = 0.1  # m, reach of a hand that has no bodies but fingers


def hand_size(robot: Robot) -> HandSize:
    """The measures of the robot's hand, opened.

    Fingers count to the side of the tool frame on which their middle lies.
    """
    bodies = _bodies_in_tool(robot, robot.hand_open)
    fingers = [b for b in bodies if robot.kind_of(b[0]) == "finger"]
    palm = [
        _distance(b)
        for b in bodies
        if robot.kind_of(b[0]) == "arm" and b[0].parentJoint == robot.tool_joint
    ]
    return HandSize(
        opening=_opening(fingers),
        reach=min(palm, default=_NO_PALM),
        width=max((_extent(b) for b in fingers), default=0.0),
    )


def hands_open_by(robot: Robot, openings: Array) -> Array:
    """The hand's joints (n, hand joints) at which it is open by given lengths (n,), m.

    The joints go evenly from open to closed; in between the opening is interpolated.
    """
    shares = np.linspace(0.0, 1.0, _INTERPOLATED)
    hands = robot.hand_closed + shares[:, None] * (robot.hand_open - robot.hand_closed)
    measured = []
    for hand in hands:
        bodies = _bodies_in_tool(robot, hand)
        measured.append(
            _opening([b for b in bodies if robot.kind_of(b[0]) == "finger"])
        )
    share = np.interp(openings, np.maximum.accumulate(measured), shares)
    stroke = robot.hand_open - robot.hand_closed
    found: Array = robot.hand_closed + share[:, None] * stroke
    return found


def _opening(fingers: list[tuple[pin.GeometryObject, Array]]) -> float:
    """How far apart the fingers on the two sides of the tool frame are."""
    sides = [
        [_distance(b) for b in fingers if _middle(b)[1] * side > 0.0]
        for side in (1.0, -1.0)
    ]
    return sum(min(side, default=0.0) for side in sides)


def _bodies_in_tool(
    robot: Robot, hand: Array
) -> list[tuple[pin.GeometryObject, Array]]:
    """All bodies with their poses (4, 4) in the tool frame."""
    q = robot.q_neutral.copy()
    q[robot.hand.indices] = hand
    T_world_joint = joint_placements(robot.model, q[None])[0]
    T_tool_world = np.linalg.inv(T_world_joint[robot.tool_joint] @ robot.T_joint_tool)
    return [
        (b, T_tool_world @ T_world_joint[b.parentJoint] @ b.placement.homogeneous)
        for b in robot.geometry.geometryObjects
    ]


def _middle(body: tuple[pin.GeometryObject, Array]) -> Array:
    geometry, T_tool_body = body
    box = local_bounds(geometry.geometry)
    return T_tool_body[:3, :3] @ box.centre + T_tool_body[:3, 3]


def _distance(body: tuple[pin.GeometryObject, Array]) -> float:
    """From the tool frame's origin to a body, 0 inside."""
    geometry, T_tool_body = body
    origin = transform(np.eye(4))
    gap = signed_distance(
        coal.Sphere(_PROBE), origin, geometry.geometry, transform(T_tool_body)
    )
    return max(gap + _PROBE, 0.0)


def _extent(body: tuple[pin.GeometryObject, Array]) -> float:
    """How far a body reaches along the tool's x."""
    geometry, T_tool_body = body
    return float(
        2.0 * moved_bounds(local_bounds(geometry.geometry), T_tool_body).half[0]
    )
