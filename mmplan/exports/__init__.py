"""Plans in the formats of other programs: one format a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

from mmplan.exports.mcap_file import write_mcap
from mmplan.exports.mjcf import write_mjcf
from mmplan.exports.moveit_scene import write_moveit_scene
from mmplan.exports.ros_bag import write_ros_bag
from mmplan.exports.ros_yaml import write_ros_yaml
from mmplan.exports.tables import write_csv, write_npz
from mmplan.plan import Plan
from mmplan.problem import Problem

# Writes a plan and what belongs to it of its problem; may raise InputError.
Writer: TypeAlias = Callable[[Problem, Plan, Path], None]

EXPORTS: Mapping[str, Writer] = MappingProxyType(
    {
        "ros-yaml": write_ros_yaml,
        "csv": write_csv,
        "npz": write_npz,
        "mcap": write_mcap,
        "rosbag2": write_ros_bag,
        "moveit-scene": write_moveit_scene,
        "mjcf": write_mjcf,
    }
)

__all__ = ["EXPORTS", "Writer"]
