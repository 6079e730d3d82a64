"""Plans as bags of ROS 2: a folder with a database."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from mmplan.exceptions import InputError
from mmplan.exports.motion import motion_of
from mmplan.exports.ros_messages import recording
from mmplan.exports.ros_types import missing_extra, typestore
from mmplan.plan import Plan
from mmplan.problem import Problem


def write_ros_bag(problem: Problem, plan: Plan, path: Path) -> None:
    """A recording of the motion, see `recording`, in a new folder.

    Raises:
        InputError: The extra `export` is not installed, or there is something already
            where the folder is to be.
    """
    types = typestore()
    try:
        from rosbags.rosbag2 import Writer
        from rosbags.rosbag2.errors import WriterError
    except ImportError:
        raise missing_extra() from None
    messages = list(recording(motion_of(problem, plan)))
    try:
        with Writer(path, version=8) as bag:
            topics = {
                topic: bag.add_connection(topic, type_, typestore=types)
                for topic, type_ in {m.topic: m.type for m in messages}.items()
            }
            for topic, type_, time, message in messages:
                data = types.serialize_cdr(_message(types, type_, message), type_)
                bag.write(topics[topic], time, data)
    except WriterError as error:
        raise InputError(f"{path}: {error}") from None


def _message(types: Any, name: str, fields: Mapping[str, Any]) -> Any:
    """The library's message of plain fields."""
    values = {}
    for field, (kind, detail) in types.fielddefs[name][1]:
        value = fields[field]
        if isinstance(value, Mapping):
            value = _message(types, detail, value)
        elif isinstance(value, list):
            value = _array(types, kind, detail[0], value)
        values[field] = value
    return types.types[name](**values)


def _array(types: Any, kind: Any, element: Any, values: list[Any]) -> Any:
    """A list of messages or names, or an array of numbers."""
    assert kind.name == "SEQUENCE", "no message of a recording has a fixed array"
    element_kind, name = element
    if element_kind.name == "NAME":
        return [_message(types, name, value) for value in values]
    if name[0] == "string":
        return values
    return np.array(values, dtype=name[0])
