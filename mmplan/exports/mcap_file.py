"""Plans as MCAP files, which Foxglove and ROS 2 read."""

from __future__ import annotations

from pathlib import Path

from mmplan.exceptions import InputError
from mmplan.exports.motion import motion_of
from mmplan.exports.ros_messages import recording
from mmplan.exports.ros_types import missing_extra, typestore
from mmplan.plan import Plan
from mmplan.problem import Problem


def write_mcap(problem: Problem, plan: Plan, path: Path) -> None:
    """A recording of the motion, see `recording`.

    Raises:
        InputError: The extra `export` is not installed, or the file cannot be written.
    """
    types = typestore()
    try:
        from mcap_ros2.writer import Writer
    except ImportError:
        raise missing_extra() from None
    messages = list(recording(motion_of(problem, plan)))
    try:
        with path.open("wb") as file, Writer(file) as writer:
            schemas = {
                type_: writer.register_msgdef(
                    type_, types.generate_msgdef(type_, ros_version=2)[0]
                )
                for type_ in {m.type for m in messages}
            }
            for number, (topic, type_, time, message) in enumerate(messages):
                writer.write_message(topic, schemas[type_], message, time, time, number)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror}") from None
