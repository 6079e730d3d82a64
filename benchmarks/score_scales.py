"""The score scales of robots, for the key `score_scales` of robot.yaml.

They bring the score's terms to one scale for any scene, so they depend on the robot
alone: M that 1 % of random arm configurations exceed, and C at the home configuration
with every link half a metre from its nearest obstacle.

    python benchmarks/score_scales.py [robots ...]
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np

from mmplan.assets import ROBOT_FILE, robot_names, robots_folder
from mmplan.robot import Robot, ScoreScales
from mmplan.robot_build import build_robot
from mmplan.robot_file import load_robot_description
from mmplan.scoring.clutter import LinkWeights
from mmplan.scoring.manipulability import manipulability

CONFIGURATIONS = 20_000
PERCENTILE = 99.0
DISTANCE = 0.5  # m


def score_scales(robot: Robot) -> ScoreScales:
    """Both scales of a robot; the same on every call."""
    return ScoreScales(manipulability_scale(robot), clutter_scale(robot))


def manipulability_scale(robot: Robot) -> float:
    """The 99th percentile of M over random arm configurations within limits."""
    rng = np.random.default_rng(0)
    q = np.tile(robot.q_neutral, (CONFIGURATIONS, 1))
    size = (CONFIGURATIONS, len(robot.arm))
    q[:, robot.arm.indices] = rng.uniform(robot.arm.lower, robot.arm.upper, size)
    return float(np.percentile(manipulability(robot, q), PERCENTILE))


def clutter_scale(robot: Robot) -> float:
    """C at home with all distances at 0.5 m."""
    q = robot.q_neutral.copy()
    q[robot.arm.indices] = robot.configurations["home"]
    return float(DISTANCE * LinkWeights(robot)(q[None]).sum())


def main(arguments: Sequence[str] | None = None) -> None:
    """Print what belongs into each robot.yaml and what is there."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robots", nargs="*", default=robot_names())
    for name in parser.parse_args(arguments).robots:
        path = robots_folder() / name / ROBOT_FILE
        robot = build_robot(load_robot_description(path))
        print(f"{name:16} computed {score_scales(robot)}")
        print(f"{'':16} in file  {robot.score_scales}")


if __name__ == "__main__":
    main()
