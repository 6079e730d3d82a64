"""A base that rolls from place to place while everything else keeps its posture."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from mmplan.planning.blending import smooth_curves
from mmplan.planning.checking import PathChecker
from mmplan.planning.curve import Curve
from mmplan.planning.joints import MotionLimits
from mmplan.planning.rolling import RollingPiece, Steering, joints_of
from mmplan.planning.timing import TimingResult, TimingSettings, time_curves
from mmplan.planning.world import PlanningWorld
from mmplan.shapes import Array, read_only


@dataclass(frozen=True, eq=False)
class Drive:
    """Pieces rolled one after the other, at rest between two.

    `poses` (k + 1, 3) are those of the base before, between and after the k pieces;
    headings go on beyond π.
    """

    q: Array  # (nq,), where it begins
    base: npt.NDArray[np.int_]  # (3,), places of x, y and heading in q
    pieces: tuple[RollingPiece, ...]
    poses: Array

    @property
    def path(self) -> Array:
        """The configurations (k + 1, nq) at the ends of its pieces."""
        return at_poses(self.q, self.base, self.poses)

    def turned(self, turn: Array) -> Drive:
        """The same drive with whole turns (nq,) added to all joints."""
        poses = read_only(self.poses + turn[self.base])
        return replace(self, q=read_only(self.q + turn), poses=poses)

    def curves(self, weights: Array) -> list[Curve]:
        """One curve a piece; what is straight in the joints is a straight line."""
        path = self.path
        curves: list[Curve] = []
        for i, piece in enumerate(self.pieces):
            if piece.turn and piece.length:
                curves.append(Arc(path[i], path[i + 1], self.base, piece))
            else:
                curves += smooth_curves(path[i : i + 2], np.zeros(2), weights)
        return curves


@dataclass(frozen=True, eq=False)
class Arc:
    """An arc of a drive as a curve q(s); s counts metres along it.

    Ends exactly at `q_end`: what rounding leaves is spread over the whole arc.
    """

    q: Array  # (nq,)
    q_end: Array  # (nq,)
    base: npt.NDArray[np.int_]  # (3,)
    piece: RollingPiece

    @property
    def length(self) -> float:
        """How long the arc is, m."""
        return abs(self.piece.length)

    @property
    def starts(self) -> Array:
        """One piece, which begins at 0."""
        return np.zeros(1)

    @property
    def moving(self) -> npt.NDArray[np.int64]:
        """The base's joints."""
        return np.sort(self.base).astype(np.int64)

    def corners(self, turn: float) -> Array:  # noqa: ARG002 (it has none)
        """Nowhere does the curvature jump."""
        return np.empty(0)

    def __call__(self, s: Array, order: int = 0) -> Array:
        """The curve's derivative of that order (0, 1 or 2) at s (n,), (n, nq)."""
        start = self.q[self.base]
        rest = self.q_end[self.base] - self.piece.end(start)
        rate = self.piece.turn / self.length
        heading = start[2] + rate * s
        ahead = np.copysign(1.0, self.piece.length)
        c, sn = ahead * np.cos(heading), ahead * np.sin(heading)
        value = np.zeros((len(s), len(self.q)))
        if order == 0:
            value += self.q
            share = s / self.length
            poses = self.piece.poses(start, share) + share[:, None] * rest
            value[:, self.base] = poses
        elif order == 1:
            tangent = np.stack([c, sn, np.full(len(s), rate)], axis=1)
            value[:, self.base] = tangent + rest / self.length
        else:
            value[:, self.base] = np.stack([-sn * rate, c * rate, 0.0 * s], axis=1)
        return value


def make_drive(
    q: Array, base: npt.NDArray[np.int_], waypoints: Sequence[Array], steering: Steering
) -> Drive:
    """The drive from pose to pose (3,), the last of which it meets exactly."""
    pieces: list[RollingPiece] = []
    poses = [np.array(waypoints[0])]
    for waypoint in waypoints[1:]:
        way = steering.pieces(poses[-1], waypoint)
        if not way:
            continue
        ends = joints_of(way, poses[-1])[1:]
        if way[-1].length:
            turns = 2.0 * np.pi * np.rint((ends[-1, 2] - waypoint[2]) / (2.0 * np.pi))
            ends[-1] = (*waypoint[:2], waypoint[2] + turns)
        pieces += way
        poses += list(ends)
    return Drive(q, base, tuple(pieces), read_only(np.array(poses)))


def at_poses(q: Array, base: npt.NDArray[np.int_], poses: Array) -> Array:
    """The configuration q (nq,) with its base at poses (n, 3), (n, nq)."""
    path = np.tile(q, (len(poses), 1))
    path[:, base] = poses
    return path


def time_drive(
    world: PlanningWorld,
    drive: Drive,
    limits: MotionLimits,
    resolution: float,
    settings: TimingSettings = TimingSettings(),  # noqa: B008 (it is frozen)
) -> TimingResult:
    """Drive as fast as the limits allow, from rest to rest in every piece.

    Where the curvature changes the base stops, as a car does that turns its wheels.
    The motion, between its samples too, is checked at `resolution` (m).
    """
    checker = PathChecker(world, resolution)
    return time_curves(drive.curves(checker.sweep.weights), limits, checker, settings)
