"""Plans as YAML, laid out as `ros2 topic echo` prints messages."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from mmplan.atomic_file import write_whole
from mmplan.exports.motion import motion_of
from mmplan.exports.ros_messages import joint_trajectory, multi_dof_trajectory
from mmplan.plan import Plan
from mmplan.problem import Problem


def write_ros_yaml(problem: Problem, plan: Plan, path: Path) -> None:
    """A message as moveit_msgs/RobotTrajectory: arm and hand, and the base.

    Raises:
        InputError: The file cannot be written.
    """
    motion = motion_of(problem, plan)
    message = {
        "joint_trajectory": joint_trajectory(motion),
        "multi_dof_joint_trajectory": multi_dof_trajectory(motion),
    }
    write_whole(path, "\n".join([*_mapping(message, ""), "---", ""]))


def _mapping(message: Mapping[str, Any], indent: str) -> Iterator[str]:
    for key, value in message.items():
        if isinstance(value, Mapping):
            yield f"{indent}{key}:"
            yield from _mapping(value, indent + "  ")
        elif isinstance(value, Sequence) and not isinstance(value, str):
            yield f"{indent}{key}:" if value else f"{indent}{key}: []"
            yield from _sequence(value, indent)
        else:
            yield f"{indent}{key}: {_scalar(value)}"


def _sequence(values: Sequence[Any], indent: str) -> Iterator[str]:
    for value in values:
        if isinstance(value, Mapping):
            first, *rest = _mapping(value, indent + "  ")
            yield f"{indent}- {first.lstrip()}"
            yield from rest
        else:
            yield f"{indent}- {_scalar(value)}"


def _scalar(value: object) -> str:
    """A number or a name; numbers keep a point, so that YAML 1.1 reads them as such."""
    if isinstance(value, float):
        mantissa, e, exponent = repr(value).partition("e")
        mantissa += "" if "." in mantissa else ".0"
        return f"{mantissa}{e}{exponent}"
    return str(value) or "''"
