"""The one door to MuJoCo."""

from __future__ import annotations

import ctypes.util
import os
from types import ModuleType

from mmplan.exceptions import InputError


def load_mujoco(purpose: str) -> ModuleType:
    """MuJoCo, told to draw without a display unless the user has said how.

    It decides how to draw when it is first imported, even by what draws nothing. Where
    there is no library to draw with, `MUJOCO_GL` stays unset.

    Raises:
        InputError: It is not installed; `purpose` says what needs it.
    """
    if not os.environ.get("MUJOCO_GL"):
        backends = [b for b in ("EGL", "OSMesa") if ctypes.util.find_library(b)]
        if backends:
            os.environ["MUJOCO_GL"] = backends[0].lower()
    try:
        import mujoco
    except ImportError as error:
        message = f"{purpose} need the extra: pip install 'mmplan[render]'"
        raise InputError(message) from error
    module: ModuleType = mujoco
    return module
