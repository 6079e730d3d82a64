"""Genes are drawn within bounds, and brought back into them."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from mmplan.genes import GeneSpace
from mmplan.shapes import Array

SPACE = GeneSpace(
    lower=np.array([-1.0, -np.pi, 2.0, 0.5]),
    upper=np.array([1.0, np.pi, 5.0, 0.5]),
    periodic=np.array([False, True, False, False]),
)
GENOMES = arrays(np.float64, (6, 4), elements=st.floats(-50, 50))


def test_a_space_knows_its_size_and_ranges() -> None:
    assert len(SPACE) == 4
    np.testing.assert_allclose(SPACE.range, [2.0, 2 * np.pi, 3.0, 0.0])


@given(st.integers(0, 10_000))
def test_samples_lie_within_bounds_and_repeat(seed: int) -> None:
    genomes = SPACE.sample(20, np.random.default_rng(seed))
    assert genomes.shape == (20, 4)
    assert np.all((genomes >= SPACE.lower) & (genomes <= SPACE.upper))
    again = SPACE.sample(20, np.random.default_rng(seed))
    np.testing.assert_array_equal(genomes, again)


def test_samples_fill_the_bounds() -> None:
    genomes = SPACE.sample(5000, np.random.default_rng(0))
    middle = (SPACE.lower + SPACE.upper) / 2
    np.testing.assert_allclose(genomes.mean(axis=0), middle, atol=0.1)
    np.testing.assert_allclose(np.ptp(genomes, axis=0), SPACE.range, rtol=0.01)


@given(GENOMES)
def test_contained_genes_lie_within_bounds(genomes: Array) -> None:
    inside = SPACE.contain(genomes)
    assert np.all((inside >= SPACE.lower) & (inside <= SPACE.upper))


@given(GENOMES)
def test_containing_twice_is_containing_once(genomes: Array) -> None:
    once = SPACE.contain(genomes)
    np.testing.assert_allclose(SPACE.contain(once), once, rtol=0, atol=1e-12)


@given(st.integers(0, 10_000))
def test_genes_within_bounds_stay_as_they_are(seed: int) -> None:
    genomes = SPACE.sample(10, np.random.default_rng(seed))
    np.testing.assert_allclose(SPACE.contain(genomes), genomes, atol=1e-12)


@given(GENOMES)
def test_periodic_genes_wrap_and_others_stop(genomes: Array) -> None:
    inside = SPACE.contain(genomes)
    turns = (genomes[:, 1] - inside[:, 1]) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-9)
    np.testing.assert_array_equal(inside[:, 2], np.clip(genomes[:, 2], 2.0, 5.0))
    np.testing.assert_array_equal(inside[:, 3], 0.5)
