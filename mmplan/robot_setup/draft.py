"""A robot.yaml that is being made: its data, and what about it was guessed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

from mmplan.assets import ROBOT_FILE
from mmplan.atomic_file import write_whole
from mmplan.files.urdf_edit import joints_by_name
from mmplan.files.yaml_writer import yaml_text
from mmplan.robot import Robot
from mmplan.robot_build import build_robot
from mmplan.robot_file import RobotDescription, load_robot_description

# Of a base that is added: speed (m/s, rad/s) and acceleration (m/s^2, rad/s^2).
_BASE = {"base_x": (0.8, 0.8), "base_y": (0.8, 0.8), "base_yaw": (1.0, 1.5)}
_TURNING_RADIUS = 0.5  # m
# Speed of a joint whose URDF says none: turning, rad/s, and sliding, m/s.
_SPEED_TURNING, _SPEED_SLIDING = 1.0, 0.1
_ENDLESS = 1e6  # a speed above this is none
# A joint reaches its full speed in this time, s.
_RAMP = 0.5


@dataclass
class Draft:
    """The data of a robot.yaml in a folder, and notes on what was guessed."""

    folder: Path
    data: dict[str, Any]
    trunk: frozenset[str]  # links that are fixed to the root of the URDF
    notes: list[str] = field(default_factory=list)

    @property
    def path(self) -> Path:
        """Its robot.yaml."""
        return self.folder / ROBOT_FILE

    def write(self, comment: str = "") -> None:
        """Write the robot.yaml as it is now."""
        write_whole(self.path, yaml_text(self.data, comment))

    def load(self) -> tuple[Robot, RobotDescription]:
        """The robot as it is now.

        Raises:
            InputError: It cannot be loaded.
        """
        self.write()
        description = load_robot_description(self.path)
        return build_robot(description), description


def base_section(kind: str) -> dict[str, Any]:
    """The section of a base that is added."""
    if kind == "reeds_shepp":
        return {"type": kind, "turning_radius": _TURNING_RADIUS}
    return {"type": kind}


def speeds(
    urdfs: Sequence[ET.Element], joints: Sequence[str], base_joints: Sequence[str]
) -> tuple[dict[str, float], dict[str, float], list[str]]:
    """Velocity limits that the URDFs lack, acceleration limits of all, and notes."""
    velocity = {name: _BASE[name][0] for name in base_joints}
    acceleration = {name: _BASE[name][1] for name in base_joints}
    elements = {k: e for root in urdfs for k, e in joints_by_name(root).items()}
    notes = []
    for name in joints:
        limit = elements[name].find("limit")
        speed = 0.0 if limit is None else float(limit.get("velocity", "0"))
        if not 0.0 < speed < _ENDLESS:
            sliding = elements[name].get("type") == "prismatic"
            speed = velocity[name] = _SPEED_SLIDING if sliding else _SPEED_TURNING
            notes.append(f"velocity of {name}: the URDF has none, {speed:g} is a guess")
        acceleration[name] = float(f"{speed / _RAMP:.2g}")
    notes.append(f"acceleration: full speed in {_RAMP:g} s")
    return velocity, acceleration, notes
