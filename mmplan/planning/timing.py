"""Timing of paths: a polyline becomes a motion within the robot's limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mmplan.hermite import HermiteCurve
from mmplan.planning.blending import blend_sizes, smooth_curves
from mmplan.planning.checking import PathChecker, even_fractions
from mmplan.planning.curve import Curve
from mmplan.planning.joints import MotionLimits
from mmplan.planning.speed_profile import SpeedProfile, even_in_length, even_in_time
from mmplan.planning.world import PlanningWorld, contact_names
from mmplan.shapes import Array, read_only

# How often all blends are halved before the motion stops at every corner.
HALVINGS = 3
# How often samples are made twice as dense.
DOUBLINGS = 3
# Waypoints nearer to each other than this are one, m.
SAME_PLACE = 1e-7
# By how much a joint may pass its limit between samples and be tamed, rad or m, and how
# often its velocities are halved for that.
HAIR = 1e-4
TAMINGS = 30
# A hair of slack, so that limits hold in any order of evaluation.
SLACK = 1.0 + 1e-9


@dataclass(frozen=True)
class TimingSettings:
    """How a path may be rounded and how densely the motion is sampled.

    `rate` (1/s) is the density of the samples, `blend` (m) how far from the polyline a
    rounded corner may take any point of the robot, and `deviation` (m) how far the
    motion between samples may from the rounded path.
    """

    rate: float = 30.0
    blend: float = 0.1
    deviation: float = 0.001


@dataclass(frozen=True, eq=False)
class TimedPath:
    """A motion of all joints from rest to rest.

    Between the samples it is the cubic Hermite curve through positions and velocities.
    """

    times: Array  # (n,), s, strictly increasing from 0
    positions: Array  # (n, nq), rad or m
    velocities: Array  # (n, nq), rad/s or m/s

    @property
    def duration(self) -> float:
        """The motion's length in time, s."""
        return float(self.times[-1])

    @cached_property
    def curve(self) -> HermiteCurve:
        """The curve through the samples."""
        return HermiteCurve(self.times, self.positions, self.velocities)

    def fastest(self) -> Array:
        """The greatest speed of each joint between samples, (n - 1, nq)."""
        return self.curve.velocity_extremes(self.times[:-1], self.times[1:]).magnitude

    def stretched(self, factor: float) -> TimedPath:
        """The same motion, slower by a factor."""
        return TimedPath(self.times * factor, self.positions, self.velocities / factor)


@dataclass(frozen=True, eq=False)
class TimingResult:
    """A motion along a path, or what stood in its way."""

    motion: TimedPath | None
    message: str  # one line for people
    stops: int = 0  # corners at which the motion comes to rest
    states: int = 0  # checked


def time_path(
    world: PlanningWorld,
    path: Array,
    limits: MotionLimits,
    resolution: float,
    settings: TimingSettings = TimingSettings(),
) -> TimingResult:
    """Move along a polyline (n, nq) as fast as the limits allow, from rest to rest.

    Corners are rounded where that is free of collision; elsewhere the motion stops at
    the corner. The motion itself, between its samples too, is checked at `resolution`
    (m) and holds all limits exactly.

    Raises:
        ValueError: if the path does not move.
    """
    checker = PathChecker(world, resolution)
    path = _without_repeats(path, checker.sweep.weights)
    if len(path) < 2:
        raise ValueError("a path that does not move has no timing")
    sizes = blend_sizes(path, checker, settings.blend)
    for attempt in _smaller_and_smaller(sizes):
        curves = smooth_curves(path, attempt, checker.sweep.weights)
        result = time_curves(curves, limits, checker, settings)
        if result.motion is not None:
            break
    return result


def time_curves(
    curves: Sequence[Curve],
    limits: MotionLimits,
    checker: PathChecker,
    settings: TimingSettings,
) -> TimingResult:
    """Move along curves as fast as the limits allow, from rest to rest on each."""
    try:
        motion = joined([_timed(c, limits, checker, settings) for c in curves])
    except ArithmeticError as error:
        return TimingResult(None, str(error), states=checker.states)
    hit = _first_collision(motion, checker)
    if hit is not None:
        message = f"the timed motion collides: {contact_names(checker.world, hit)}"
        return TimingResult(None, message, states=checker.states)
    stops = len(curves) - 1
    message = f"{motion.duration:.2f} s with {stops} stops"
    return TimingResult(motion, message, stops, checker.states)


def _smaller_and_smaller(sizes: Array) -> Iterator[Array]:
    """The blends as they are, halved and halved again, and none."""
    for halvings in range(HALVINGS + 1):
        yield sizes * 0.5**halvings
    yield np.zeros_like(sizes)


def _without_repeats(path: Array, weights: Array) -> Array:
    """The path less waypoints that coincide with the one before, its ends as given."""
    steps = np.linalg.norm(np.diff(path, axis=0) * weights, axis=1)
    kept: Array = path[np.append(True, steps > SAME_PLACE)]
    kept[-1] = path[-1]
    return kept


def _timed(
    curve: Curve,
    limits: MotionLimits,
    checker: PathChecker,
    settings: TimingSettings,
) -> TimedPath:
    """The motion along one curve, sampled so densely that it follows the curve."""
    rough = SpeedProfile.fastest(curve, even_in_length(curve), limits)
    profile = rough
    for doublings in range(DOUBLINGS + 1):
        grid = even_in_time(curve, rough, settings.rate * 2.0**doublings)
        with suppress(ArithmeticError):  # toppra sometimes fails on one grid alone
            profile = SpeedProfile.fastest(curve, grid, limits)
            if _deviation(_sampled(curve, profile), curve, profile, checker) <= (
                settings.deviation
            ):
                break
    return _within(_inside(_sampled(curve, profile), limits), limits)


def _sampled(curve: Curve, profile: SpeedProfile) -> TimedPath:
    """The motion with a sample at every point of the profile's grid."""
    velocities = curve(profile.grid, 1) * profile.speeds[:, None]
    return TimedPath(profile.times, curve(profile.grid), velocities)


def _deviation(
    motion: TimedPath, curve: Curve, profile: SpeedProfile, checker: PathChecker
) -> float:
    """How far (m) the motion leaves the curve midway between its samples."""
    amid = (motion.times[:-1] + motion.times[1:]) / 2.0
    off = motion.curve.positions(amid) - curve(profile.at(amid))
    return float(checker.sweep.distance(off).max())


def _inside(motion: TimedPath, limits: MotionLimits) -> TimedPath:
    """The motion without the hair by which it passes a limit between two samples.

    Where a joint moves along its limit, its velocities at both samples are lessened.
    """
    tamed = motion
    for _ in range(TAMINGS):
        extremes = tamed.curve.position_extremes()
        over = np.maximum(
            extremes.greatest - limits.upper, limits.lower - extremes.least
        )
        if over.max() <= 0.0:
            return tamed
        if over.max() > HAIR:
            break
        velocities = tamed.velocities.copy()
        pieces = over > 0.0
        velocities[:-1][pieces] *= 0.5
        velocities[1:][pieces] *= 0.5
        tamed = TimedPath(tamed.times, tamed.positions, velocities)
    return motion


def _within(motion: TimedPath, limits: MotionLimits) -> TimedPath:
    """The motion with its time stretched evenly so that all limits just hold."""
    hardest = motion.curve.acceleration_extremes().magnitude
    velocity = float((motion.fastest() / limits.velocity).max())
    acceleration = float((hardest / limits.acceleration).max())
    more = [limit.stretch(motion.curve) for limit in limits.more]
    factor = SLACK * max(velocity, np.sqrt(acceleration), *more)
    if not np.isfinite(factor):
        raise ArithmeticError("the robot cannot move along a path however slowly")
    return motion.stretched(factor)


def joined(motions: Sequence[TimedPath]) -> TimedPath:
    """One motion after the other; each begins where and as the last one ended."""
    starts = np.cumsum([0.0, *(m.duration for m in motions)])
    times = [m.times[i > 0 :] + starts[i] for i, m in enumerate(motions)]
    positions = [m.positions[i > 0 :] for i, m in enumerate(motions)]
    velocities = [m.velocities[i > 0 :] for i, m in enumerate(motions)]
    return TimedPath(
        read_only(np.concatenate(times)),
        read_only(np.concatenate(positions)),
        read_only(np.concatenate(velocities)),
    )


def _first_collision(motion: TimedPath, checker: PathChecker) -> Array | None:
    """Where the motion collides first (nq,), None if it nowhere does."""
    steps = np.diff(motion.times)
    piece, fraction = even_fractions(checker.steps(motion.fastest() * steps[:, None]))
    q = motion.curve.positions(motion.times[piece] + fraction * steps[piece])
    hit = checker.first_hit(q)
    return None if hit is None else q[hit]
