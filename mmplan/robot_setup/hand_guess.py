"""How a hand opens, and where its tool frame is, guessed from the bodies of fingers."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pinocchio as pin

from mmplan.robot import Robot
from mmplan.robot_setup.configurations import bounds
from mmplan.robot_setup.fingers import finger_corners
from mmplan.shapes import Array

# How far behind the tips of the fingers the middle of their pads is taken to be: at
# most this, m, and at most this share of the fingers' length.
_PAD, _PAD_SHARE = 0.02, 0.25
# Directions nearer to an axis than this are taken to be along it (cosine).
_ALONG = 0.9


class HandGuess(NamedTuple):
    """Positions of the hand's joints that lead, (k,), and T_tip_tool (4, 4)."""

    open: Array
    closed: Array
    T_tip_tool: Array


def guess_hand(robot: Robot) -> HandGuess:
    """Guess from a robot whose tool frame is its tip link, whatever its axes are.

    Of the two ends of each joint's range the hand is open where its finger's tip is
    farther from the middle of all tips. z of the tool frame points from the wrist to
    the fingers, y is the way in which they close.
    """
    lower, upper = bounds(robot.hand)
    middle = (lower + upper) / 2.0
    opened, closed = _ends(robot, lower, upper, middle)
    T = tool_frame(robot, opened, closed)
    leads = robot.hand.leads
    return HandGuess(opened[leads], closed[leads], T)


def _ends(
    robot: Robot, lower: Array, upper: Array, middle: Array
) -> tuple[Array, Array]:
    """The hand open and closed, (hand joints,) each."""
    opened, closed = middle.copy(), middle.copy()
    centre = _centre(robot, middle)
    for k in np.flatnonzero(robot.hand.leads):
        spread = []
        for end in (lower, upper):
            q = middle.copy()
            q[k] = end[k]
            spread.append(_spread(robot, q, centre))
        order = (lower, upper) if spread[0] > spread[1] else (upper, lower)
        opened[k], closed[k] = order[0][k], order[1][k]
    return opened, closed


def _centre(robot: Robot, q_hand: Array) -> Array:
    """The point (3,) in the tip's frame in the middle of the tips of all fingers.

    With one finger it is the tip frame's own axis that the finger closes against.
    """
    tips = _tips(robot, q_hand)
    return np.asarray(tips.mean(axis=0)) if len(tips) > 1 else np.zeros(3)


def _spread(robot: Robot, q_hand: Array, centre: Array) -> float:
    """How far the tips of the fingers are from the approach through `centre`, m."""
    away = _tips(robot, q_hand) - centre
    z = _approach(robot, q_hand)
    across = away - np.outer(away @ z, z)
    return float(np.linalg.norm(across, axis=1).sum())


def _tips(robot: Robot, q_hand: Array) -> Array:
    """Of each finger the middle of its far end, (fingers, 3), in the tip's frame."""
    z = _approach(robot, q_hand)
    tips = []
    for corners in finger_corners(robot, q_hand).values():
        heights = corners @ z
        far = heights >= heights.max() - 0.2 * np.ptp(heights) - 1e-9
        tips.append(corners[far].mean(axis=0))
    return np.array(tips).reshape(-1, 3)


def _approach(robot: Robot, q_hand: Array) -> Array:
    """The direction (3,) from the wrist to the fingers in the tip's frame."""
    corners = np.concatenate(list(finger_corners(robot, q_hand).values()))
    wrist = -robot.T_joint_tool[:3, :3].T @ robot.T_joint_tool[:3, 3]
    return _snapped(corners.mean(axis=0) - wrist)


def tool_frame(robot: Robot, opened: Array, closed: Array) -> Array:
    """T_tip_tool (4, 4) of the convention, for a hand open and closed."""
    z = _approach(robot, closed)
    y = _closing(robot, opened, closed, z)
    corners = np.concatenate(list(finger_corners(robot, closed).values()))
    heights = corners @ z
    pad = min(_PAD, _PAD_SHARE * float(np.ptp(heights)))
    tips = _tips(robot, closed)
    middle = tips.mean(axis=0)
    T = np.eye(4)
    T[:3, :3] = np.column_stack([np.cross(y, z), y, z])
    T[:3, 3] = middle + (heights.max() - pad - middle @ z) * z
    return np.asarray(np.round(T, 9))


def _closing(robot: Robot, opened: Array, closed: Array, z: Array) -> Array:
    """The direction (3,) across z in which the fingers close."""
    tips = _tips(robot, opened)
    moves = _tips(robot, closed) - tips
    way = tips[0] - tips[-1] if len(tips) == 2 else moves[_longest(moves)]
    way = way - (way @ z) * z
    if np.linalg.norm(way) < 1e-6:
        way = np.eye(3)[np.argmin(np.abs(z))]
    way = _snapped(way)
    way = way - (way @ z) * z
    y: Array = way / np.linalg.norm(way)
    # the sign is free for a hand of two fingers: nearest to the axis of the tip's frame
    return y if y[np.argmax(np.abs(y))] > 0 else -y


def _longest(moves: Array) -> int:
    return int(np.argmax(np.linalg.norm(moves, axis=1)))


def _snapped(direction: Array) -> Array:
    """The direction of length 1, along an axis if it is near to one."""
    unit = direction / max(float(np.linalg.norm(direction)), 1e-12)
    axis = int(np.argmax(np.abs(unit)))
    if abs(unit[axis]) < _ALONG:
        return np.asarray(unit)
    return np.asarray(np.sign(unit[axis]) * np.eye(3)[axis])


def rpy(T: Array) -> list[float]:
    """Angles about the fixed axes x, y, z (rad) of a pose (4, 4)."""
    return [float(x) for x in pin.rpy.matrixToRpy(T[:3, :3])]
