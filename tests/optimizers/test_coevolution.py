"""Co-evolution is the paper's: who is asked for, who becomes a parent, who is born."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.genes import GeneSpace
from mmplan.optimizers import CoEvolution, Queries
from mmplan.optimizers.coevolution import breed, grasp_fitness
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End
from mmplan.shapes import Array
from tests.optimizers.analytic import SPACE, optimize, totals

PAPER = OptimizerSettings()
ENDLESS = 10**9


def generations(settings: OptimizerSettings, n: int) -> list[tuple[Queries, Array]]:
    """What a search asks for in n batches and is told, by end."""
    search = CoEvolution(SPACE, settings, np.random.default_rng(5))
    batches: list[tuple[Queries, Array]] = []
    for _ in range(n):
        queries = search.ask(ENDLESS)
        parts = [queries.take(queries.end == end) for end in End]
        told = [totals(end, parts[end].q_base, parts[end].grasps) for end in End]
        assert np.array_equal(queries.end, np.concatenate([p.end for p in parts]))
        search.tell(np.concatenate(told))
        batches += zip(parts, told, strict=True)
    return batches


@pytest.fixture(scope="module")
def batches() -> list[tuple[Queries, Array]]:
    """Two cycles: start bases, goal bases, grasps at the start, grasps at the goal."""
    return generations(PAPER, 4)


def by_pair(batch: tuple[Queries, Array], n: int) -> tuple[Array, Array, Array]:
    """The n bases, m grasps and the scores (n, m) of all their pairs."""
    queries, told = batch
    bases = queries.q_base.reshape(n, -1, 2)
    grasps = queries.grasps.reshape(n, -1, 2)
    assert np.all(bases == bases[:, :1])
    assert np.all(grasps == grasps[:1])
    return bases[:, 0], grasps[0], told.reshape(n, -1)


def fittest(members: Array, fitness: Array, n: int) -> Array:
    return members[np.argsort(-fitness, kind="stable")[:n]]


def test_one_cycle_evolves_both_base_populations_and_then_the_grasps(
    batches: list[tuple[Queries, Array]],
) -> None:
    ends = [set(queries.end.tolist()) for queries, _ in batches]
    assert ends == [{0}, {1}, {0}, {1}] * 2
    k, bases, grasps = PAPER.partners, PAPER.bases, PAPER.grasps
    sizes = [len(told) for _, told in batches]
    assert sizes == [bases * k, bases * k, k * grasps, k * grasps] * 2


def test_the_papers_budget_is_so_many_cycles() -> None:
    found, _ = optimize("coevolution", 6940)
    assert found.cycles == pytest.approx(6940 / 2072)
    assert found.cycles == pytest.approx(3.349, abs=1e-3)


def test_f_base_is_the_best_score_with_the_fittest_grasps(
    batches: list[tuple[Queries, Array]],
) -> None:
    for end in End:
        bases, _, scores = by_pair(batches[end], PAPER.bases)
        partners, _, _ = by_pair(batches[2 + end], PAPER.partners)
        expected = fittest(bases, scores.max(axis=1), PAPER.partners)
        assert np.array_equal(partners, expected)


def test_the_fittest_half_of_the_bases_lives_on_as_parents(
    batches: list[tuple[Queries, Array]],
) -> None:
    for end in End:
        bases, _, scores = by_pair(batches[end], PAPER.bases)
        following, _, _ = by_pair(batches[4 + end], PAPER.bases)
        parents = fittest(bases, scores.max(axis=1), PAPER.bases // 2)
        assert np.array_equal(following[: len(parents)], parents)
        old = {row.tobytes() for row in bases}
        children = [row.tobytes() for row in following[len(parents) :]]
        assert len(children) == PAPER.bases - len(parents)
        assert len([child for child in children if child not in old]) > 20


def test_f_grasp_sums_over_the_fittest_bases_of_both_ends(
    batches: list[tuple[Queries, Array]],
) -> None:
    _, grasps, start = by_pair(batches[2], PAPER.partners)
    _, same, goal = by_pair(batches[3], PAPER.partners)
    assert np.array_equal(grasps, same)
    sides = start.sum(axis=0), goal.sum(axis=0)
    one_end = (sides[0] == 0.0) != (sides[1] == 0.0)
    fitness = np.where(one_end, 1.0, sides[0] + sides[1])
    _, partners, _ = by_pair(batches[4], PAPER.bases)
    assert np.array_equal(partners, fittest(grasps, fitness, PAPER.partners))
    _, following, _ = by_pair(batches[6], PAPER.partners)
    parents = fittest(grasps, fitness, PAPER.grasps // 2)
    assert np.array_equal(following[: len(parents)], parents)


@given(st.floats(1e-9, 1e6), st.floats(1e-9, 1e6))
def test_a_grasp_that_works_at_one_end_has_fitness_one(a: float, b: float) -> None:
    start, goal = np.array([a, a, 0.0, 0.0]), np.array([b, 0.0, b, 0.0])
    assert grasp_fitness(start, goal).tolist() == [a + b, 1.0, 1.0, 0.0]


def test_a_population_of_odd_size_keeps_its_size() -> None:
    settings = replace(PAPER, bases=9, grasps=7, partners=3)
    sizes = [len(told) for _, told in generations(settings, 6)]
    assert sizes == [27, 27, 21, 21] * 3


def test_a_budget_that_ends_within_a_generation_cuts_it_short() -> None:
    search = CoEvolution(SPACE, PAPER, np.random.default_rng(5))
    whole = search.ask(ENDLESS)
    head = search.ask(10)
    assert np.array_equal(head.q_base, whole.q_base[:10])
    assert np.array_equal(head.grasps, whole.grasps[:10])


WIDE = GeneSpace(np.full(7, -100.0), np.full(7, 100.0), np.zeros(7, np.bool_))


def marked_parents(n: int, d: int) -> Array:
    """Parents (n, d) every gene of which tells whose it is."""
    return np.tile(np.arange(n, dtype=np.float64)[:, None], (1, d))


def test_a_child_is_one_parent_with_a_segment_of_another() -> None:
    children = breed(marked_parents(6, 7), 4000, WIDE, 0.0, np.random.default_rng(0))
    for child in children:
        members, changes = set(child), np.count_nonzero(np.diff(child))
        assert len(members) <= 2
        assert changes <= 2
        assert changes < 2 or child[0] == child[-1]


def test_the_two_parents_are_different() -> None:
    # Copies of one parent come only from cuts that are equal or at both ends.
    d, n = 7, 20_000
    children = breed(marked_parents(2, d), n, WIDE, 0.0, np.random.default_rng(0))
    copies = np.mean(children.min(axis=1) == children.max(axis=1))
    assert copies == pytest.approx((d + 1 + 2) / (d + 1) ** 2, abs=0.01)


def test_every_parent_has_children() -> None:
    children = breed(marked_parents(6, 7), 3000, WIDE, 0.0, np.random.default_rng(0))
    counts = np.bincount(children.astype(int).ravel(), minlength=6)
    assert np.all(np.abs(counts / counts.sum() - 1 / 6) < 0.02)


def test_genes_mutate_as_often_as_said() -> None:
    parents = np.zeros((4, 7))
    children = breed(parents, 20_000, WIDE, 0.2, np.random.default_rng(0))
    mutated = np.mean(children != 0.0, axis=0)
    np.testing.assert_allclose(mutated, 0.2, atol=0.01)


def test_a_mutation_is_at_most_a_quarter_of_the_range_and_uniform() -> None:
    lower = np.array([-1.0, 0.0, 5.0])
    upper = np.array([1.0, 40.0, 5.0])
    space = GeneSpace(lower, upper, np.zeros(3, np.bool_))
    middle = (space.lower + space.upper) / 2
    children = breed(
        np.tile(middle, (2, 1)), 20_000, space, 1.0, np.random.default_rng(0)
    )
    steps = (children - middle)[:, :2] / space.range[:2]
    assert np.abs(steps).max() <= 0.25
    for gene in steps.T:
        quarters = np.histogram(gene, bins=4, range=(-0.25, 0.25))[0] / len(gene)
        np.testing.assert_allclose(quarters, 0.25, atol=0.015)
    assert np.all(children[:, 2] == 5.0)  # a gene without a range stays


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 1.0))
def test_children_stay_within_bounds_and_angles_wrap(
    seed: int, mutation: float
) -> None:
    rng = np.random.default_rng(seed)
    space = SPACE.bases[End.START].genes
    parents = np.concatenate([space.sample(4, rng), [space.lower, space.upper]])
    children = breed(parents, 50, space, mutation, rng)
    assert np.all((children >= space.lower) & (children <= space.upper))


def test_an_angle_mutates_across_the_seam() -> None:
    space = SPACE.bases[End.START].genes
    at_seam = np.tile(space.upper, (2, 1))
    children = breed(at_seam, 2000, space, 1.0, np.random.default_rng(0))
    angles = children[:, 1]
    assert np.mean(angles < 0.0) == pytest.approx(0.5, abs=0.05)
    assert np.all(np.abs(angles) >= np.pi / 2)
    distances = children[:, 0]
    assert np.mean(distances == space.upper[0]) == pytest.approx(0.5, abs=0.05)
