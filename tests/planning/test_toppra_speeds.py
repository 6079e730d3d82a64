"""Speeds are found on curves whose joints move very unevenly, within the limits."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.planning.blending import SmoothCurve
from mmplan.planning.joints import MotionLimits
from mmplan.planning.toppra_speeds import fastest_speeds

LIMITS = MotionLimits(velocity=np.array([0.07]), acceleration=np.array([0.2]))


@pytest.mark.parametrize(
    ("slow", "blend", "quick", "last"),
    [
        (1.5e-5, 0.0014, -0.07, 0.016),
        (4.4e-5, 0.0026, -0.87, 0.011),
        (-3.2e-7, 0.0013, -0.17, 0.014),
        (4.7e-8, 0.0075, -0.55, 0.007),
        (2.7e-6, 0.0094, -0.39, 0.012),
        (0.3, 0.0094, -0.39, 0.012),
    ],
)
def test_a_joint_that_hardly_moves_at_first(
    slow: float, blend: float, quick: float, last: float
) -> None:
    """A torso that stands almost still for 0.25 m and then moves."""
    curve = SmoothCurve(
        starts=np.array([0.0, 0.25, 0.25 + blend]),
        a=np.zeros((3, 1)),
        b=np.array([[slow], [slow], [quick]]),
        c=np.array([[0.0], [(quick - slow) / (2.0 * blend)], [0.0]]),
        length=0.25 + blend + last,
    )
    grid = np.unique([*np.linspace(0.0, curve.length, 28), *curve.starts])
    speeds = fastest_speeds(curve, grid, LIMITS)
    assert speeds[0] == speeds[-1] == 0.0
    assert np.all(speeds[1:-1] > 0.0)
    velocities = curve(grid, 1)[:, 0] * speeds
    assert np.all(np.abs(velocities) <= LIMITS.velocity * (1.0 + 1e-6))
    # Between points the speed squared is linear in s: q'' = q''(s) s'^2 + q'(s) s''.
    growth = np.diff(speeds**2) / (2.0 * np.diff(grid))
    bend = curve(grid[:-1], 2)[:, 0] * speeds[:-1] ** 2
    accelerations = bend + curve(grid[:-1], 1)[:, 0] * growth
    assert np.all(np.abs(accelerations) <= LIMITS.acceleration * (1.0 + 1e-3))
