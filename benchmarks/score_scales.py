"""The score scales of robots, for the key `score_scales` of robot.yaml.

python benchmarks/score_scales.py [robots ...]
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from mmplan.assets import robot_names
from mmplan.robot_build import load_robot
from mmplan.robot_setup.score_scales import score_scales


def main(arguments: Sequence[str] | None = None) -> None:
    """Print what belongs into each robot.yaml and what is there."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robots", nargs="*", default=robot_names())
    for name in parser.parse_args(arguments).robots:
        robot = load_robot(name)
        print(f"{name:16} computed {score_scales(robot, robot.configurations['home'])}")
        print(f"{'':16} in file  {robot.score_scales}")


if __name__ == "__main__":
    main()
