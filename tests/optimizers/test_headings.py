"""Bases that turn, and bases that stand still: placements and every optimizer."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.exceptions import NoPlanError
from mmplan.optimizers import (
    OPTIMIZERS,
    BasePlacements,
    Optimization,
    SearchSpace,
    Triple,
    optimize,
)
from mmplan.optimizers.archive import distinct
from mmplan.optimizers.bases import OnePlacement, base_ways
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End, Outcome, Scores
from mmplan.shapes import Array
from tests.optimizers.analytic import CENTRES, GRASPS, INNER, OUTER, QUICK, totals

ENDLESS = (-np.inf, np.inf)
# At the seam of the circle, so that it is reached from either side.
BEST_HEADING = np.pi - 0.01


def anywhere(q_base: Array) -> np.ndarray:
    return np.ones(len(q_base), dtype=np.bool_)


def turning(limits: tuple[float, float] = ENDLESS) -> BasePlacements:
    return BasePlacements(CENTRES[End.START], INNER, OUTER, anywhere, limits)


class HeadedScore:
    """The analytic score of the first two base joints, less where turned away."""

    def __call__(self, end: End, q_base: Array, grasps: Array) -> Scores:
        total = totals(end, q_base[:, :2], grasps)
        if q_base.shape[1] > 2:
            total *= np.exp(-np.abs(angle(q_base[:, 2] - BEST_HEADING)))
        outcome = np.where(total > 0.0, Outcome.SCORED, Outcome.NO_IK)
        n = len(total)
        return Scores(
            total, np.zeros((n, 3)), np.zeros((n, 1)), outcome.astype(np.int8)
        )


def angle(x: Array) -> Array:
    return np.mod(x + np.pi, 2 * np.pi) - np.pi


def search(name: str, space: SearchSpace, evaluations: int = 2500) -> Optimization:
    settings = OptimizerSettings(evaluations=evaluations)
    optimizer = OPTIMIZERS[name](space, settings, np.random.default_rng(0))
    return optimize(HeadedScore(), optimizer, evaluations, 3)  # type: ignore[arg-type]


@given(st.integers(0, 2**32 - 1))
def test_the_heading_is_relative_to_the_way_to_the_object(seed: int) -> None:
    rng = np.random.default_rng(seed)
    placements = turning()
    genes = placements.genes.sample(50, rng)
    q = placements.q_base(genes)
    to_object = np.array(placements.centre) - q[:, :2]
    seen = np.arctan2(to_object[:, 1], to_object[:, 0])
    np.testing.assert_allclose(angle(q[:, 2] - seen - genes[:, 4]), 0.0, atol=1e-9)
    assert np.all(np.abs(q[:, 2]) <= np.pi)
    ahead = placements.q_base(genes * [1, 1, 1, 1, 0])
    np.testing.assert_allclose(ahead[:, 2], seen, atol=1e-9)


@given(st.integers(0, 2**32 - 1))
def test_what_genes_stand_for_is_its_own_nearest_placement(seed: int) -> None:
    rng = np.random.default_rng(seed)
    placements = turning()
    q = placements.q_base(placements.sample(50, rng))
    turned = q + [0, 0, 2 * np.pi] * rng.integers(-2, 3, (50, 1))
    np.testing.assert_allclose(placements.nearest(turned), q, atol=1e-9)


@given(st.floats(-20, 20), st.floats(0.0, 6.0), st.integers(0, 2**32 - 1))
def test_headings_keep_to_the_robots_limits(
    low: float, width: float, seed: int
) -> None:
    placements = turning((low, low + width))
    rng = np.random.default_rng(seed)
    heading = placements.nearest(rng.uniform(-9, 9, (20, 3)))[:, 2]
    assert np.all((heading >= low) & (heading <= low + width))
    drawn = placements.q_base(placements.genes.sample(20, rng))[:, 2]
    # If any winding is within the limits, it is the one that the genes stand for.
    windings = drawn[:, None] + 2 * np.pi * np.arange(-5, 6)
    possible = np.any((windings >= low) & (windings <= low + width), axis=1)
    assert np.array_equal(possible, (drawn >= low) & (drawn <= low + width))


@given(st.integers(0, 2**32 - 1))
def test_ways_of_headings_are_the_short_ones(seed: int) -> None:
    a, b = np.random.default_rng(seed).uniform(-9, 9, (2, 20, 3))
    way = base_ways(a, b)
    assert np.array_equal(way[:, :2], (b - a)[:, :2])
    assert np.all(np.abs(way[:, 2]) <= np.pi)
    np.testing.assert_allclose(np.exp(1j * (a + way)[:, 2]), np.exp(1j * b[:, 2]))


def test_placements_a_turn_apart_are_not_distinct() -> None:
    q = np.array([0.3, 0.2, 3.1])
    grasp = np.array([0.1, 0.0])
    headings = (3.1, 3.1 - 2 * np.pi, -3.1, 2.5)
    triples = [
        Triple((np.array([0.3, 0.2, h]), q), grasp, (1.0, 1.0)) for h in headings
    ]
    assert distinct(triples, GRASPS, 9) == [triples[0], triples[3]]


@pytest.mark.parametrize("name", QUICK)
def test_every_optimizer_turns_the_base(name: str) -> None:
    bases = {
        e: BasePlacements(CENTRES[e], INNER, OUTER, anywhere, ENDLESS) for e in End
    }
    found = search(name, SearchSpace(bases, GRASPS))
    assert found.evaluated.q_base.shape == (2500, 3)
    best = found.candidates[0]
    at_random = search("random", SearchSpace(bases, GRASPS)).candidates[0]
    assert best.total >= at_random.total
    if name != "random":
        assert best.total > 80.0
        for q_base in best.q_base:
            assert abs(angle(q_base[2] - BEST_HEADING)) < 0.8


@pytest.mark.parametrize("name", OPTIMIZERS)
@pytest.mark.parametrize("joints", [0, 2, 3])
def test_a_base_that_stands_leaves_the_grasp_to_be_searched(
    name: str, joints: int
) -> None:
    if name not in QUICK:
        pytest.skip("slow, or its library is not installed")
    place = np.array([0.3, 0.6, 3.0])[:joints]
    bases = {end: OnePlacement(place, anywhere) for end in End}

    class GraspScore(HeadedScore):
        def __call__(self, end: End, q_base: Array, grasps: Array) -> Scores:  # noqa: ARG002
            assert np.array_equal(q_base, np.tile(place, (len(grasps), 1)))
            seen = np.tile([0.5, 0.4], (len(grasps), 1))
            total = totals(End.START, seen, grasps)
            n = len(total)
            outcome = np.full(n, Outcome.SCORED, np.int8)
            return Scores(total, np.zeros((n, 3)), np.zeros((n, 1)), outcome)

    settings = OptimizerSettings(evaluations=2000)
    space = SearchSpace(bases, GRASPS)
    optimizer = OPTIMIZERS[name](space, settings, np.random.default_rng(1))
    found = optimize(GraspScore(), optimizer, 2000, 3)  # type: ignore[arg-type]
    assert found.evaluations == 2000
    best = found.candidates[0]
    assert best.total > 180.0
    assert all(np.array_equal(q, place) for q in best.q_base)
    if name == "coevolution":  # 64 grasps at either end make a cycle
        assert found.cycles == pytest.approx(2000 / 128)


def test_a_base_that_cannot_stand_is_an_error() -> None:
    nowhere = OnePlacement(np.zeros(3), lambda q: np.zeros(len(q), np.bool_))
    with pytest.raises(NoPlanError, match="the base cannot stand where it is fixed"):
        nowhere.sample(5, np.random.default_rng(0))
