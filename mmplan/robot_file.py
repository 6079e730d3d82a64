"""The file robot.yaml of a robot, as plain values."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class RobotDescription:
    """What a robot.yaml says, checked by itself but not yet against the URDF.

    Angles are in radians, lengths in metres. `package_dirs` are the folders in which
    `package://` paths of the URDF are looked up.
    """

    path: Path  # the robot.yaml
    name: str
    description: str
    urdf: Path
    package_dirs: tuple[Path, ...]
    base_type: str  # "xy"
    base_joints: tuple[str, ...]
    base_radius: float
    arm_joints: tuple[str, ...]
    hand_joints: tuple[str, ...]
    hand_open: tuple[float, ...]
    hand_closed: tuple[float, ...]
    tool: str
    reach: float
    ik_solver: str
    ik_settings: Mapping[str, float]
    acceleration: Mapping[str, float]  # by joint
    configurations: Mapping[str, tuple[float, ...]]  # arm joints
    manipulability_scale: float
    clutter_scale: float
    disabled_pairs: tuple[tuple[str, str, str], ...]  # two links and the reason
