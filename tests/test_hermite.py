from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.hermite import HermiteCurve

SEEDS = st.integers(0, 10_000)


def random_curve(seed: int, pieces: int = 5) -> HermiteCurve:
    """Random samples of 3 joints; a joint that stands still and a straight one."""
    rng = np.random.default_rng(seed)
    times = np.concatenate([[0.0], np.cumsum(rng.uniform(0.05, 1.0, pieces))])
    positions = rng.uniform(-2.0, 2.0, (pieces + 1, 3))
    velocities = rng.uniform(-3.0, 3.0, (pieces + 1, 3))
    if seed % 2:
        positions[:, 1], velocities[:, 1] = 0.7, 0.0
        positions[:, 2], velocities[:, 2] = 0.3 * times, 0.3
    return HermiteCurve(times, positions, velocities)


def dense(curve: HermiteCurve, piece: int, count: int = 2001) -> np.ndarray:
    return np.linspace(curve.times[piece], curve.times[piece + 1], count)


@given(SEEDS)
def test_the_curve_passes_through_its_samples(seed: int) -> None:
    rng = np.random.default_rng(seed)
    times = np.array([0.0, 0.3, 1.1])
    positions, velocities = rng.normal(size=(2, 3, 4))
    curve = HermiteCurve(times, positions, velocities)
    assert curve.positions(times) == pytest.approx(positions, abs=1e-12)
    assert curve.velocities(times) == pytest.approx(velocities, abs=1e-12)


@given(SEEDS)
def test_velocities_are_the_slopes_of_positions(seed: int) -> None:
    curve, step = random_curve(seed), 1e-6
    t = np.random.default_rng(seed).uniform(step, curve.times[-1] - step, 50)
    slope = (curve.positions(t + step) - curve.positions(t - step)) / (2 * step)
    assert curve.velocities(t) == pytest.approx(slope, abs=2e-3)


@given(SEEDS)
def test_extremes_of_pieces_are_reached_and_never_passed(seed: int) -> None:
    curve = random_curve(seed)
    positions = curve.position_extremes()
    velocities = curve.velocity_extremes(curve.times[:-1], curve.times[1:])
    accelerations = curve.acceleration_extremes()
    for piece in range(curve.pieces):
        t = dense(curve, piece)
        inside = t[1:-1]
        slopes = np.gradient(curve.velocities(inside), inside, axis=0)[1:-1]
        for extremes, samples, tolerance in (
            (positions, curve.positions(inside), 0.01),
            (velocities, curve.velocities(inside), 0.2),
            (accelerations, slopes, 1.0),
        ):
            low, high = extremes.least[piece], extremes.greatest[piece]
            rounding = 1e-6 * (1.0 + np.abs(samples).max())
            assert np.all(samples.min(axis=0) >= low - rounding)
            assert np.all(samples.max(axis=0) <= high + rounding)
            scale = np.maximum(1.0, high - low)
            assert np.all(samples.min(axis=0) <= low + tolerance * scale)
            assert np.all(samples.max(axis=0) >= high - tolerance * scale)


@given(SEEDS)
def test_velocity_extremes_of_any_stretch_are_never_passed(seed: int) -> None:
    curve = random_curve(seed)
    rng = np.random.default_rng(seed)
    ends = np.sort(rng.uniform(0.0, curve.times[-1], (20, 2)), axis=1)
    ends[0] = 0.0, curve.times[-1]
    ends[1] = curve.times[1], curve.times[2]
    extremes = curve.velocity_extremes(ends[:, 0], ends[:, 1])
    for k, (start, end) in enumerate(ends):
        v = curve.velocities(np.linspace(start, end, 501)[1:-1])
        assert np.all(v >= extremes.least[k] - 1e-9)
        assert np.all(v <= extremes.greatest[k] + 1e-9)
        assert np.all(np.abs(v) <= extremes.magnitude[k] + 1e-9)


def test_a_stretch_within_a_piece_has_exact_velocity_extremes() -> None:
    curve = HermiteCurve(
        np.array([0.0, 2.0]), np.array([[0.0], [1.0]]), np.zeros((2, 1))
    )
    whole = curve.velocity_extremes(np.array([0.0]), np.array([2.0]))
    first = curve.velocity_extremes(np.array([0.0]), np.array([0.5]))
    assert whole.greatest == pytest.approx(np.array([[0.75]]))
    assert first.greatest == pytest.approx(curve.velocities(np.array([0.5])))
    assert first.least == pytest.approx(np.array([[0.0]]))
