"""The parts that a task's motion is made of, before they are timed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TypeAlias

import numpy as np

from mmplan.planning import (
    Drive,
    MotionLimits,
    PlanningWorld,
    TimedPath,
    joined,
    time_drive,
    time_path,
)
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


# A polyline (n, nq), or the base driving alone.
Leg: TypeAlias = Array | Drive


@dataclass(frozen=True, eq=False)
class Part:
    """One segment: its legs, in the world in which they must be free.

    The robot rests between two legs.
    """

    name: str
    world: PlanningWorld
    legs: tuple[Leg, ...]
    attached: dict[str, Array] = field(default_factory=dict)  # -> T_tool_object

    @cached_property
    def path(self) -> Array:
        """Configurations (n, nq) along all legs, their ends among them."""
        return np.concatenate([path_of(leg) for leg in self.legs])

    @property
    def moves(self) -> bool:
        """Whether anything moves at all; a straight motion of length 0 does not."""
        return bool(np.ptp(self.path, axis=0).any())

    def turned(self, turn: Array) -> Part:
        """The same motion with whole turns (nq,) added to its joints."""
        legs = (x.turned(turn) if isinstance(x, Drive) else x + turn for x in self.legs)
        return replace(self, legs=tuple(legs))


def path_of(leg: Leg) -> Array:
    """Configurations (n, nq) along a leg, its ends among them."""
    return leg.path if isinstance(leg, Drive) else leg


def time_part(part: Part, limits: MotionLimits, resolution: float) -> TimedPath:
    """The motion of a part that moves, as fast as the limits allow.

    Raises:
        BlockedError: The timed motion would touch something.
    """
    motions = []
    for leg in part.legs:
        if not np.ptp(path_of(leg), axis=0).any():
            continue
        if isinstance(leg, Drive):
            result = time_drive(part.world, leg, limits, resolution)
        else:
            result = time_path(part.world, leg, limits, resolution)
        if result.motion is None:
            raise BlockedError(part.name, result.message)
        motions.append(result.motion)
    return joined(motions)
