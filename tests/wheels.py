"""The shipped Puma on other bases, and a small scene for each."""

from __future__ import annotations

import re
from pathlib import Path

from mmplan.assets import robots_folder

PUMA = robots_folder() / "puma_mobile"
SWIVEL = """<link name="swivel"/>
  <joint name="base_yaw" type="continuous">
    <parent link="swivel"/>
    <child link="base"/>
    <axis xyz="0 0 1"/>
    <limit velocity="1.5" effort="100"/>
  </joint>
"""
TURNING_RADIUS = 0.4  # m, with reeds_shepp


def puma_on(base_type: str, folder: Path) -> Path:
    """A robot.yaml in `folder`: the Puma on a base that turns, or on none at all."""
    urdf = (PUMA / "puma_mobile.urdf").read_text()
    robot = (PUMA / "robot.yaml").read_text()
    if base_type == "fixed":
        start, end = urdf.index('<link name="odom"/>'), urdf.index('<link name="base">')
        urdf = urdf[:start] + urdf[end:]
        base = "base: {type: fixed, radius: 0.28}"
        robot = re.sub(r"  base_[xy]: .*\n", "", robot)
    else:
        urdf = urdf.replace('<child link="base"/>', '<child link="swivel"/>')
        urdf = urdf.replace('<link name="base">', f'{SWIVEL}<link name="base">')
        radius = f", turning_radius: {TURNING_RADIUS}"
        base = (
            f"base: {{type: {base_type}, joints: [base_x, base_y, base_yaw], "
            f"radius: 0.28{radius if base_type == 'reeds_shepp' else ''}}}"
        )
        robot = robot.replace("  base_y: 0.8", "  base_y: 0.8\n  base_yaw: 2.0")
    robot = re.sub(r"base: \{type: xy.*\}", base, robot)
    path = folder / f"puma_{base_type}"
    path.mkdir()
    (path / "puma_mobile.urdf").write_text(urdf)
    (path / "robot.yaml").write_text(robot)
    return path / "robot.yaml"


def cup_scene(robot: str, folder: Path, more: str = "") -> Path:
    """A cup moved along a counter by a robot; `robot` are the lines of that section."""
    path = folder / "cup.yaml"
    path.write_text(
        f"""mmplan: 1
name: cup
robot:
{robot}
obstacles:
  floor: {{box: [8, 8, 0.1], at: {{xyz: [0, 0, -0.05]}}, ground: true}}
  counter: {{box: [0.6, 2.4, 0.8], at: {{xyz: [1.5, 0, 0.4]}}}}
objects:
  cup:
    cylinder: {{radius: 0.03, length: 0.1}}
    at: {{xyz: [1.4, 0.3, 0.85]}}
    grasps: {{side: {{family: axis, along: [-0.03, 0.03]}}}}
tasks:
  - {{move: cup, to: {{xyz: [1.4, -0.3, 0.85]}}}}
optimizer: {{evaluations: 800, bases: 16, grasps: 12, partners: 3}}
{more}"""
    )
    return path
