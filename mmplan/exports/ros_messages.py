"""Messages of ROS 2 as plain mappings, with the names of their fields."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple, TypeAlias

from mmplan.exports.motion import WORLD_FRAME, Motion
from mmplan.shapes import Array

Message: TypeAlias = dict[str, Any]
_NANOSECONDS = 1_000_000_000


class Stamped(NamedTuple):
    """A message that is published on a topic at a time (ns since the start)."""

    topic: str
    type: str
    time: int
    message: Message


def nanoseconds(seconds: float) -> int:
    """A time as ROS counts it."""
    return round(seconds * _NANOSECONDS)


def joint_trajectory(motion: Motion) -> Message:
    """trajectory_msgs/JointTrajectory of arm and hand.

    Controllers that are given positions and velocities follow the same cubic curves
    that the plan is made of.
    """
    which = motion.others
    rows = zip(
        motion.times.tolist(),
        motion.positions[:, which].tolist(),
        motion.velocities[:, which].tolist(),
        strict=True,
    )
    return {
        "header": _header(0.0),
        "joint_names": [motion.joints[i] for i in which],
        "points": [
            {
                "positions": positions,
                "velocities": velocities,
                "accelerations": [],
                "effort": [],
                "time_from_start": _time(time),
            }
            for time, positions, velocities in rows
        ],
    }


def multi_dof_trajectory(motion: Motion) -> Message:
    """trajectory_msgs/MultiDOFJointTrajectory of the base, as poses in the world."""
    names = [motion.base_frame] if motion.base_joints else []
    points = [
        {
            "transforms": [_transform(pose)] if names else [],
            "velocities": [],
            "accelerations": [],
            "time_from_start": _time(time),
        }
        for time, pose in zip(motion.times.tolist(), motion.base, strict=True)
    ]
    return {"header": _header(0.0), "joint_names": names, "points": points}


def recording(motion: Motion) -> Iterator[Stamped]:
    """A plan as a robot that does it would be recorded, by rising time.

    First both trajectories, then at each sample the state of all joints and the poses
    of base and objects.
    """
    package = "trajectory_msgs/msg"
    yield Stamped(
        "/joint_trajectory", f"{package}/JointTrajectory", 0, joint_trajectory(motion)
    )
    yield Stamped(
        "/base_trajectory",
        f"{package}/MultiDOFJointTrajectory",
        0,
        multi_dof_trajectory(motion),
    )
    for i, time in enumerate(motion.times.tolist()):
        stamp = nanoseconds(time)
        state = {
            "header": _header(time),
            "name": list(motion.joints),
            "position": motion.positions[i].tolist(),
            "velocity": motion.velocities[i].tolist(),
            "effort": [],
        }
        yield Stamped("/joint_states", "sensor_msgs/msg/JointState", stamp, state)
        poses = {name: poses[i] for name, poses in motion.objects.items()}
        if motion.base_joints:
            poses = {motion.base_frame: motion.base[i], **poses}
        transforms = [
            {
                "header": _header(time),
                "child_frame_id": name,
                "transform": _transform(pose),
            }
            for name, pose in poses.items()
        ]
        message = {"transforms": transforms}
        yield Stamped("/tf", "tf2_msgs/msg/TFMessage", stamp, message)


def _header(time: float) -> Message:
    return {"stamp": _time(time), "frame_id": WORLD_FRAME}


def _time(seconds: float) -> Message:
    whole, rest = divmod(nanoseconds(seconds), _NANOSECONDS)
    return {"sec": whole, "nanosec": rest}


def _transform(pose: Array) -> Message:
    x, y, z, qx, qy, qz, qw = pose.tolist()
    return {
        "translation": {"x": x, "y": y, "z": z},
        "rotation": {"x": qx, "y": qy, "z": qz, "w": qw},
    }
