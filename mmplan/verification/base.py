"""How the base moves: out of forbidden zones, and rolling where it can do no other.

What must hold at all times is proven on the cubic Hermite curves that are delivered.
Over a stretch of time of half-length h around t a quantity f stays within
|f(t)| + h |f'(t)| + h²/2 max |f''|: with a bound of f'' short stretches suffice.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mmplan.hermite import HermiteCurve
from mmplan.problem import Problem
from mmplan.replay import Stage
from mmplan.shapes import Array
from mmplan.verification.limits import curve_of
from mmplan.verification_report import Fault
from mmplan.zones import base_clearances

# A base that rolls may slip sideways at no more than this, m/s.
SLIP_TOLERANCE = 1e-3
# A forbidden zone may be entered by no more than this, m.
ZONE_TOLERANCE = 1e-6
# Of the tolerance, what may be lost to the length of the stretches.
_SHARE = 0.2
_MOST_SPLITS = 14


@dataclass(frozen=True, eq=False)
class Rolling:
    """The motion of a base seen in its own frame, over stretches of time.

    The speed ahead is u = ẋ cos ψ + ẏ sin ψ, the side slip v = ẏ cos ψ - ẋ sin ψ.
    """

    times: Array  # (n,), s, the middles of stretches that cover the segment
    ahead: Array  # (n,), m/s, in the middles
    turning: Array  # (n,), rad/s, in the middles
    slip: Array  # (n,), m/s, what its magnitude is at most
    tight: Array  # (n,), m/s, how much turning by the radius exceeds |u| at most
    doubt: Array  # (n,), m/s, how far both bounds may be above the truth


def base_faults(stages: Sequence[Stage], problem: Problem) -> Iterator[Fault]:
    """Where the base enters a zone, slips sideways, or turns tighter than it can."""
    if problem.base_stands:
        return
    for stage in stages:
        yield from _zone_faults(stage, problem)
        if problem.robot.base_type in ("diff_drive", "reeds_shepp"):
            yield from _rolling_faults(stage, problem)


def side_slip(stage: Stage, problem: Problem) -> float:
    """What the side slip (m/s) of a base that turns is at most in a segment."""
    return float(_rolling(curve_of(stage), problem).slip.max())


def _rolling_faults(stage: Stage, problem: Problem) -> Iterator[Fault]:
    rolling, radius = _rolling(curve_of(stage), problem), problem.robot.turning_radius
    worst = int(rolling.slip.argmax())
    if rolling.slip[worst] > SLIP_TOLERANCE:
        yield Fault(
            "side_slip",
            f"{stage.place}: the base slips sideways at {rolling.slip[worst]:.3g} m/s "
            f"near t = {rolling.times[worst]:.3f} s; {SLIP_TOLERANCE:g} is let pass",
        )
    worst = int(rolling.tight.argmax())
    if radius > 0.0 and rolling.tight[worst] > SLIP_TOLERANCE:
        speed, rate = abs(rolling.ahead[worst]), abs(rolling.turning[worst])
        yield Fault(
            "tight_turn",
            f"{stage.place}: the base turns at {rate:.3g} rad/s while it goes "
            f"{speed:.3g} m/s near t = {rolling.times[worst]:.3f} s, tighter than its "
            f"turning radius of {radius:g} m",
        )


def _rolling(curve: HermiteCurve, problem: Problem) -> Rolling:
    """The motion of the base over stretches short enough for the tolerance."""
    for splits in range(_MOST_SPLITS):
        parts = 2**splits
        step = np.diff(curve.times) / parts
        start = curve.times[:-1, None] + step[:, None] * np.arange(parts)
        half = np.repeat(step / 2.0, parts)
        rolling = _over(curve, start.ravel() + half, half, problem)
        if rolling.doubt.max() <= _SHARE * SLIP_TOLERANCE:
            break
    return rolling


def _over(curve: HermiteCurve, times: Array, half: Array, problem: Problem) -> Rolling:
    """The motion over stretches of half-lengths (n,) around times (n,)."""
    index, radius = problem.robot.base.indices, problem.robot.turning_radius
    piece = curve.piece_of(times)
    heading = curve.positions(times)[:, index[2]]
    xd, yd, turning = curve.velocities(times)[:, index].T
    xdd, ydd, turning_rate = curve.accelerations(times)[:, index].T
    c, s = np.cos(heading), np.sin(heading)
    ahead, slip = xd * c + yd * s, yd * c - xd * s
    ahead_rate = xdd * c + ydd * s + turning * slip
    slip_rate = ydd * c - xdd * s - turning * ahead
    jerk = np.abs(curve.jerks()[:, index])[piece]
    curved = half**2 / 2.0 * _second(curve, index)[piece]
    doubt = curved + half**2 / 2.0 * radius * jerk[:, 2]
    way = np.where(ahead < 0.0, -1.0, 1.0)
    tight = [
        sign * radius * turning
        - way * ahead
        + half * np.abs(sign * radius * turning_rate - way * ahead_rate)
        for sign in (-1.0, 1.0)
    ]
    return Rolling(
        times=times,
        ahead=ahead,
        turning=turning,
        slip=np.abs(slip) + half * np.abs(slip_rate) + curved,
        tight=np.max(tight, axis=0) + doubt,
        doubt=doubt,
    )


def _second(curve: HermiteCurve, index: npt.NDArray[np.int_]) -> Array:
    """What the second derivative of u and v is at most on every piece, (pieces,).

    That is |p⃛ + 2 ψ̇ J p̈ + ψ̈ J ṗ + ψ̇² ṗ| with p = (x, y) and J a quarter turn.
    """
    velocity = curve.velocity_extremes(curve.times[:-1], curve.times[1:])
    speeds = velocity.magnitude[:, index]
    accelerations = curve.acceleration_extremes().magnitude[:, index]
    jerks = np.abs(curve.jerks()[:, index])
    v, a, j = (np.hypot(d[:, 0], d[:, 1]) for d in (speeds, accelerations, jerks))
    turning, rate = speeds[:, 2], accelerations[:, 2]
    second: Array = j + 2.0 * turning * a + rate * v + turning**2 * v
    return second


def _zone_faults(stage: Stage, problem: Problem) -> Iterator[Fault]:
    """Zones that the base enters: every stretch is proven to stay out, or split."""
    curve, robot = curve_of(stage), problem.robot
    for zone in problem.forbidden:
        start, end = curve.times[:-1], curve.times[1:]
        while len(start):
            middle = (start + end) / 2.0
            q_base = curve.positions(middle)[:, robot.base.indices]
            clearance = base_clearances([zone], q_base, robot.base_radius)
            deep = int(clearance.argmin())
            if clearance[deep] < -ZONE_TOLERANCE:
                yield Fault(
                    "zone",
                    f"{stage.place}: the base is {-clearance[deep]:.3g} m deep in "
                    f"{zone.name} at t = {middle[deep]:.3f} s",
                )
                break
            speeds = curve.velocity_extremes(start, end).magnitude[
                :, robot.base.indices
            ]
            reach = np.hypot(speeds[:, 0], speeds[:, 1]) * (end - start) / 2.0
            near = clearance - reach < -ZONE_TOLERANCE
            start = np.concatenate([start[near], middle[near]])
            end = np.concatenate([middle[near], end[near]])
