"""Curves on which a base rolls: pieces driven with an even turn, or turned in place."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi
from typing import Protocol

import numpy as np

from mmplan.shapes import Array

# Ways and turns below this (m, rad) are none.
_NOTHING = 1e-9


@dataclass(frozen=True)
class RollingPiece:
    """A way along the heading while that turns evenly.

    Straight where `turn` is 0, a turn in place where `length` is, else an arc.
    """

    length: float  # m, negative backwards
    turn: float  # rad, positive to the left

    def poses(self, start: Array, fractions: Array) -> Array:
        """Poses (n, 3) at shares (n,) of the piece that begins at a pose (3,).

        A pose is x (m), y (m) and heading (rad), which goes on beyond π.
        """
        x, y, heading = start.tolist()
        turned = heading + fractions * self.turn
        if self.turn == 0.0:
            way = fractions * self.length
            return np.stack(
                [x + way * np.cos(heading), y + way * np.sin(heading), turned], axis=1
            )
        radius = self.length / self.turn
        return np.stack(
            [
                x + radius * (np.sin(turned) - np.sin(heading)),
                y - radius * (np.cos(turned) - np.cos(heading)),
                turned,
            ],
            axis=1,
        )

    def end(self, start: Array) -> Array:
        """The pose (3,) at its end."""
        end: Array = self.poses(start, np.ones(1))[0]
        return end

    @property
    def moves(self) -> bool:
        """Whether it is more than nothing."""
        return max(abs(self.length), abs(self.turn)) > _NOTHING


class Steering(Protocol):
    """How a base gets from one pose to another where nothing is in the way."""

    @property
    def radius(self) -> float:
        """How tight it can turn, m; what OMPL's distances are computed with."""
        ...

    def pieces(self, start: Array, end: Array) -> tuple[RollingPiece, ...]:
        """The way from pose to pose, (3,) each; headings count modulo whole turns."""
        ...


@dataclass(frozen=True)
class TurnInPlace:
    """A differential drive: turn, go straight ahead or back, turn."""

    radius: float = 0.05  # for distances alone: what a turn counts, m per rad

    def pieces(self, start: Array, end: Array) -> tuple[RollingPiece, ...]:
        """At most three pieces; of going ahead or back the one with less turning."""
        dx, dy = end[:2] - start[:2]
        length = float(np.hypot(dx, dy))
        if length <= _NOTHING:
            return _that_move([RollingPiece(0.0, wrapped(end[2] - start[2]))])
        ways = []
        for way, heading in (
            (length, np.arctan2(dy, dx)),
            (-length, np.arctan2(-dy, -dx)),
        ):
            first, last = wrapped(heading - start[2]), wrapped(end[2] - heading)
            ways.append((abs(first) + abs(last), first, way, last))
        _, first, way, last = min(ways)
        return _that_move(
            [RollingPiece(0.0, first), RollingPiece(way, 0.0), RollingPiece(0.0, last)]
        )


def wrapped(angle: float) -> float:
    """An angle less whole turns, in [-π, π)."""
    return float((angle + pi) % (2.0 * pi) - pi)


def joints_of(pieces: Sequence[RollingPiece], start: Array) -> Array:
    """The poses (n + 1, 3) at the ends of n pieces that begin at a pose (3,)."""
    poses = [start]
    for piece in pieces:
        poses.append(piece.end(poses[-1]))
    return np.array(poses)


def _that_move(pieces: Sequence[RollingPiece]) -> tuple[RollingPiece, ...]:
    return tuple(piece for piece in pieces if piece.moves)
