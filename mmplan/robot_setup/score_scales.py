"""The score scales of a robot, for the key `score_scales` of robot.yaml.

They bring the score's terms to one scale for any scene, so they depend on the robot
alone: M that 1 % of random arm configurations exceed, and C at the home configuration
with every link half a metre from its nearest obstacle.
"""

from __future__ import annotations

import numpy as np

from mmplan.robot import Robot, ScoreScales
from mmplan.robot_setup.configurations import bounds, with_arm
from mmplan.scoring.link_weights import LinkWeights
from mmplan.scoring.manipulability import manipulability
from mmplan.shapes import Array

_CONFIGURATIONS = 20_000
_PERCENTILE = 99.0
_DISTANCE = 0.5  # m


def score_scales(robot: Robot, q_home: Array) -> ScoreScales:
    """Both scales of a robot whose arm is at `q_home` (arm joints,) in rest.

    The same on every call.
    """
    return ScoreScales(_manipulability(robot), _clutter(robot, q_home))


def _manipulability(robot: Robot) -> float:
    """The 99th percentile of M over random arm configurations within limits."""
    rng = np.random.default_rng(0)
    size = (_CONFIGURATIONS, len(robot.arm))
    q = with_arm(robot, rng.uniform(*bounds(robot.arm), size))
    return float(np.percentile(manipulability(robot, q), _PERCENTILE))


def _clutter(robot: Robot, q_home: Array) -> float:
    """C at home with all distances at 0.5 m."""
    q = with_arm(robot, q_home[None])
    return float(_DISTANCE * LinkWeights(robot)(q).sum())
