"""Changes of the robot that might help."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mmplan.collision.hand_width import narrowed
from mmplan.explanation.near_limit import slides
from mmplan.explanation.settings import Change, Setting, centimetres
from mmplan.robot import Robot
from mmplan.robot_build import with_arm_limits


def narrower_hand(by: float) -> Change:
    """Palm and fingers are narrower by a length, m."""

    def apply(setting: Setting) -> Setting:
        return _with_robot(setting, narrowed(setting.problem.robot, by))

    return Change(f"with the hand {centimetres(by)} narrower", by, apply)


def wider_limits(setting: Setting, joint: str, by: float) -> Change:
    """A joint of the arm may turn farther on both sides, rad; or slide farther, m.

    The size of a turn is how far it moves the tip of the stretched arm.
    """
    robot = setting.problem.robot
    length = slides(robot, joint)
    size = by if length else by * robot.reach
    words = centimetres(by) if length else f"{np.degrees(by):.3g} degrees"

    def apply(setting: Setting) -> Setting:
        arm = setting.problem.robot.arm
        more = np.where(np.array(arm.names) == joint, by, 0.0)
        wider = with_arm_limits(
            setting.problem.robot, arm.lower - more, arm.upper + more
        )
        return _with_robot(setting, wider)

    return Change(f"with the limits of `{joint}` {words} wider", size, apply)


def _with_robot(setting: Setting, robot: Robot) -> Setting:
    problem = replace(setting.problem, robot=robot)
    return Setting(problem, replace(setting.world, robot=robot))
