"""When to load numba: once a process asks so much that this is worth the time."""

from __future__ import annotations

from functools import cache
from itertools import count
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mmplan.collision.compiled_broadphase import CompiledBroadphase

# So many questions about motions take as long without numba as loading it.
_WORTHWHILE = 200

_questions = count()
_wanted: list[bool] = []


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


@cache
def _load() -> type[CompiledBroadphase] | None:
    try:
        from mmplan.collision.compiled_broadphase import CompiledBroadphase
    except (ImportError, RuntimeError):
        # There is no numba, or none that goes with this numpy, or no folder in which
        # it could keep what it compiles. All works without, only slower.
        return None
    return CompiledBroadphase
