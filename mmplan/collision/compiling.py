"""When to load numba: once a process asks so much that this is worth the time."""

from __future__ import annotations

import time
from functools import cache
from itertools import count
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mmplan.collision.compiled_broadphase import CompiledBroadphase

# So many questions about motions take as long without numba as loading it.
_WORTHWHILE = 200

_questions = count()
_wanted: list[bool] = []
_seconds_of_loading: list[float] = []


def compile_motions() -> None:
    """Load numba for the next question about a motion, if it is installed.

    Else that is done once a process has asked many. The answers are the same.
    """
    _wanted.append(True)


def compiled_broadphase() -> type[CompiledBroadphase] | None:
    """The broadphase for the next question about a motion; None for that in numpy."""
    if not _wanted and next(_questions) < _WORTHWHILE:
        return None
    return _load()


def planning_clock() -> float:
    """CPU s that this thread has worked, but for loading and compiling numba's part.

    For limits in seconds, which else would give other plans where the machine is busy
    and where mmplan has just been installed.
    """
    return time.thread_time() - sum(_seconds_of_loading)


@cache
def _load() -> type[CompiledBroadphase] | None:
    begin = time.thread_time()
    try:
        from mmplan.collision.compiled_broadphase import CompiledBroadphase
    except (ImportError, RuntimeError):
        # There is no numba, or none that goes with this numpy, or no folder in which
        # it could keep what it compiles. All works without, only slower.
        return None
    finally:
        _seconds_of_loading.append(time.thread_time() - begin)
    return CompiledBroadphase
