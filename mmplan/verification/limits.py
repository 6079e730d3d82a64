"""Limits, rest and continuity of the motion, on the curve and not on samples."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from mmplan.hermite import HermiteCurve
from mmplan.problem import Problem
from mmplan.replay import Stage
from mmplan.robot import JointGroup
from mmplan.shapes import Array
from mmplan.verification_report import Fault

# Limits may be passed by this share, for what rounding does.
_RELATIVE = 1e-9
# Positions and velocities that ought to be equal may differ by this (m, rad, per s).
_EQUAL = 1e-9


def curve_of(stage: Stage) -> HermiteCurve:
    """The motion of a segment."""
    segment = stage.segment
    return HermiteCurve(segment.times, segment.positions, segment.velocities)


def motion_faults(stages: Sequence[Stage], problem: Problem) -> Iterator[Fault]:
    """Where the motion jumps, does not rest, or passes a limit."""
    names = tuple(problem.robot.model.names)[1:]
    q_before, before = problem.q_start, "the robot's start"
    for stage in stages:
        segment = stage.segment
        jump = np.abs(segment.positions[0] - q_before)
        if jump.max() > _EQUAL:
            j = int(jump.argmax())
            kind = "start" if before == "the robot's start" else "jump"
            message = f"{names[j]} jumps by {jump[j]:.3g} after {before}"
            yield Fault(kind, f"{stage.place}: {message}")
        for where, row in (("start", 0), ("end", -1)):
            speed = np.abs(segment.velocities[row])
            if speed.max() > _EQUAL:
                j = int(speed.argmax())
                message = f"{names[j]} moves at {speed[j]:.3g} per second"
                yield Fault(
                    "rest", f"{stage.place}: not at rest at its {where}: {message}"
                )
        yield from _limit_faults(stage, problem)
        yield from _follower_faults(stage, problem)
        q_before, before = segment.positions[-1], stage.place


def _limit_faults(stage: Stage, problem: Problem) -> Iterator[Fault]:
    curve, robot = curve_of(stage), problem.robot
    starts, ends = curve.times[:-1], curve.times[1:]
    positions = curve.position_extremes()
    velocities = curve.velocity_extremes(starts, ends)
    accelerations = curve.acceleration_extremes()
    for group in (robot.base, robot.arm, robot.hand):
        for kind, extremes, lower, upper in (
            ("position", positions, group.lower, group.upper),
            ("velocity", velocities, -group.velocity, group.velocity),
            ("acceleration", accelerations, -group.acceleration, group.acceleration),
        ):
            least = extremes.least[:, group.indices]
            greatest = extremes.greatest[:, group.indices]
            yield from _beyond(stage, kind, group, (least, lower), (greatest, upper))
    index = robot.base.indices
    least, greatest = positions.least[:, index], positions.greatest[:, index]
    lower, upper = problem.base_bounds.T
    yield from _beyond(stage, "base", robot.base, (least, lower), (greatest, upper))


def _follower_faults(stage: Stage, problem: Problem) -> Iterator[Fault]:
    """Joints that are elsewhere, or move otherwise, than those they mimic have them."""
    names = tuple(problem.robot.model.names)[1:]
    q, v = stage.segment.positions, stage.segment.velocities
    for follower, leader, multiplier, offset in problem.robot.hand.followers:
        off = np.abs(q[:, follower] - multiplier * q[:, leader] - offset)
        rate = np.abs(v[:, follower] - multiplier * v[:, leader])
        if max(off.max(), rate.max()) > _EQUAL:
            yield Fault(
                "mimic",
                f"{stage.place}: {names[follower]} does not follow {names[leader]}: "
                f"off by up to {off.max():.3g}, or {rate.max():.3g} per second",
            )


def _beyond(
    stage: Stage,
    kind: str,
    group: JointGroup,
    low: tuple[Array, Array],
    high: tuple[Array, Array],
) -> Iterator[Fault]:
    """Faults of values (pieces, joints) below or above limits (joints,)."""
    for (values, limits), sign in ((low, -1.0), (high, 1.0)):
        excess = sign * (values - limits)
        allowed = _RELATIVE * np.maximum(1.0, np.abs(limits))
        for j in np.flatnonzero(np.any(excess > allowed, axis=0)):
            piece = int(np.argmax(excess[:, j]))
            what = "bound of the base" if kind == "base" else f"{kind} limit"
            yield Fault(
                kind,
                f"{stage.place}: {group.names[j]} reaches {values[piece, j]:.6g} near "
                f"t = {stage.segment.times[piece]:.3f} s, past its {what} "
                f"{limits[j]:.6g}",
            )
