"""Where the fingers of a hand are, open and closed, in the tool frame."""

from __future__ import annotations

from itertools import product

import numpy as np

from mmplan.collision import local_bounds
from mmplan.kinematics import joint_placements
from mmplan.robot import Robot
from mmplan.shapes import Array

_SIGNS = np.array(list(product((-1.0, 1.0), repeat=3)))


def finger_corners(robot: Robot, q_hand: Array) -> dict[int, Array]:
    """Corners (m, 3) of the bounds of the bodies of each finger, in the tool frame.

    `q_hand` is (hand joints,). A finger is what one joint of the hand that no other
    of the hand moves carries; the keys are the ids of these joints.
    """
    q = robot.q_neutral.copy()
    q[robot.hand.indices] = q_hand
    q = robot.with_followers(q)
    T = joint_placements(robot.model, q[None])[0]
    T_tool_world = np.linalg.inv(T[robot.tool_joint] @ robot.T_joint_tool)
    found: dict[int, list[Array]] = {}
    hand = {int(robot.model.getJointId(name)) for name in robot.hand.names}
    for body in robot.geometry.geometryObjects:
        above = [int(j) for j in robot.model.supports[body.parentJoint]]
        moving = [j for j in above if j in hand]
        if moving:
            box = local_bounds(body.geometry)
            T_tool_body = (
                T_tool_world @ T[body.parentJoint] @ body.placement.homogeneous
            )
            corners = box.centre + _SIGNS * box.half
            placed = corners @ T_tool_body[:3, :3].T + T_tool_body[:3, 3]
            found.setdefault(moving[0], []).append(placed)
    return {joint: np.concatenate(parts) for joint, parts in found.items()}


def closing_direction(robot: Robot) -> Array | None:
    """The direction (3,) in the tool frame in which the fingers close.

    It is that of the finger that moves most, by its end farthest from the wrist; None
    where no finger moves.
    """
    opened = finger_corners(robot, robot.hand_open)
    closed = finger_corners(robot, robot.hand_closed)
    ways = [closed[joint] - opened[joint] for joint in opened]
    if not ways:
        return None
    moves = np.concatenate(ways)
    lengths = np.linalg.norm(moves, axis=1)
    most = int(np.argmax(lengths))
    return moves[most] / lengths[most] if lengths[most] > 1e-6 else None
