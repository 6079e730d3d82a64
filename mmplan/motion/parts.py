"""The parts that a task's motion is made of, before they are timed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from mmplan.collision import CollisionWorld
from mmplan.shapes import Array


@dataclass(frozen=True)
class Blocked:
    """Which segment could not be planned, and why."""

    segment: str
    message: str


class BlockedError(Exception):
    """Carries a `Blocked` out of the steps of one motion; never leaves this folder."""

    def __init__(self, segment: str, message: str) -> None:
        """Note the segment and what stood in its way."""
        super().__init__(message)
        self.blocked = Blocked(segment, message)


@dataclass(frozen=True, eq=False)
class Part:
    """One segment: its path, a polyline, in the world in which it must be free."""

    name: str
    world: CollisionWorld
    path: Array  # (n, nq)
    attached: dict[str, Array] = field(default_factory=dict)  # -> T_tool_object

    @property
    def moves(self) -> bool:
        """Whether anything moves at all; a straight motion of length 0 does not."""
        return len(self.path) > 1 and bool(np.ptp(self.path, axis=0).any())

    def turned(self, turn: Array) -> Part:
        """The same motion with whole turns (nq,) added to its joints."""
        return replace(self, path=self.path + turn)
