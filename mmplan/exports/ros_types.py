"""The one door to the definitions of ROS 2 messages, of the library rosbags."""

from __future__ import annotations

from typing import Any

from mmplan.exceptions import InputError


def typestore() -> Any:
    """The message types of ROS 2 Humble.

    Raises:
        InputError: The extra `export` is not installed.
    """
    try:
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise missing_extra() from None
    return get_typestore(Stores.ROS2_HUMBLE)


def missing_extra() -> InputError:
    """The error where a library of the extra is not installed."""
    return InputError(
        "this export needs the extra 'export': pip install 'mmplan[export]'"
    )
