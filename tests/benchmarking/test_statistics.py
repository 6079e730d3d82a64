"""Statistics: known values, and laws that hold for any scores."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mmplan.benchmarking.statistics import (
    best_so_far,
    difference,
    proportion,
    spread,
)
from tests.benchmarking.made import failed, made_up

scores = st.dictionaries(
    st.integers(0, 20), st.floats(0.0, 100.0), min_size=2, max_size=12
)


def test_the_wilson_interval_of_the_papers_success_rate() -> None:
    # 198 of 200; by the formula of Wilson (1927) with z = 1.95996.
    p = proportion(198, 200)
    assert p.share == 0.99
    assert (p.low, p.high) == pytest.approx((0.96428, 0.99725), abs=1e-5)


def test_the_wilson_interval_at_its_ends() -> None:
    none, every = proportion(0, 10), proportion(10, 10)
    assert (none.low, none.high) == pytest.approx((0.0, 0.27753), abs=1e-5)
    assert (every.low, every.high) == pytest.approx((0.72247, 1.0), abs=1e-5)


def test_mean_and_deviation_of_a_sample() -> None:
    s = spread([2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0])
    assert (s.n, s.mean, s.median) == (8, 5.0, 4.5)
    assert s.deviation == pytest.approx(math.sqrt(32 / 7))


def test_no_runs_have_no_mean_and_one_has_no_deviation() -> None:
    assert math.isnan(spread([]).mean)
    assert math.isnan(spread([1.0]).deviation)


@settings(max_examples=20)
@given(scores, scores)
def test_a_difference_is_the_opposite_the_other_way_round(
    a: dict[int, float], b: dict[int, float]
) -> None:
    there, back = difference(a, b), difference(b, a)
    if there is None or back is None:
        assert len(a.keys() & b.keys()) < 2
        return
    assert there.n == len(a.keys() & b.keys())
    assert there.mean == pytest.approx(-back.mean, abs=1e-9)
    assert there.low <= there.high
    assert 0.0 <= there.p <= 1.0
    assert there.p == pytest.approx(back.p)


@given(scores)
def test_nobody_is_ahead_of_itself(a: dict[int, float]) -> None:
    d = difference(a, a)
    assert d is not None
    assert (d.mean, d.low, d.high, d.p) == (0.0, 0.0, 0.0, 1.0)


def test_a_constant_lead_is_certain() -> None:
    behind = {seed: float(seed) for seed in range(20)}
    d = difference({seed: s + 3.0 for seed, s in behind.items()}, behind)
    assert d is not None
    assert (d.mean, d.low, d.high) == (3.0, 3.0, 3.0)
    assert d.p < 0.001


def test_the_bootstrap_interval_covers_the_true_difference_as_often_as_it_says() -> (
    None
):
    rng = np.random.default_rng(1)
    covered = 0
    for _ in range(100):
        ahead = dict(enumerate(rng.normal(1.0, 2.0, 40)))
        d = difference(ahead, dict.fromkeys(range(40), 0.0))
        assert d is not None
        covered += d.low <= 1.0 <= d.high
    # 95 of 100 are expected; fewer than 86 or all 100 have a chance below 1 %.
    assert 86 <= covered <= 99


def test_the_curve_of_best_scores_is_the_mean_of_steps() -> None:
    runs = [
        made_up(evaluations=100, history=[[10, 20.0], [60, 40.0], [100, 40.0]]),
        made_up(evaluations=100, history=[[30, 10.0], [100, 10.0]]),
        failed(evaluations=100, history=[], seconds=[]),
    ]
    curve = best_so_far(runs, 0.5, points=100)  # at 1, 2, ..., 100 evaluations
    mean = dict(zip(curve.evaluations.round().astype(int), curve.mean, strict=True))
    assert mean[9] == 0.0
    assert mean[10] == mean[29] == pytest.approx(10.0 / 3)
    assert mean[30] == mean[59] == pytest.approx(15.0 / 3)
    assert mean[60] == mean[100] == pytest.approx(25.0 / 3)
    assert np.all(curve.low <= curve.mean)
    assert np.all(curve.mean <= curve.high)
    assert np.all(np.diff(curve.mean) >= 0.0)
