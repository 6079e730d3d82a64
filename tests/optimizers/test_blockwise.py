"""Blockwise search: better than the others where it can be known, and its parts."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.genes import GeneSpace
from mmplan.optimizers import OPTIMIZERS, Triple, optimize
from mmplan.optimizers.lineage import Lineage
from mmplan.optimizers.optimizer import Queries
from mmplan.optimizers.successes import Successes
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End
from tests.optimizers.analytic import (
    BEST_BASE,
    BEST_GRASP,
    GRASPS,
    QUICK,
    SPACE,
    AnalyticScore,
    free,
)
from tests.optimizers.analytic import optimize as search

SEEDS = range(5)
TRIPLE = Triple((BEST_BASE[End.START], BEST_BASE[End.GOAL]), BEST_GRASP, (100.0, 100.0))


def mean_best(name: str, evaluations: int) -> float:
    score, settings = AnalyticScore(), OptimizerSettings(evaluations=evaluations)
    best = []
    for seed in SEEDS:
        optimizer = OPTIMIZERS[name](SPACE, settings, np.random.default_rng(seed))
        found = optimize(score, optimizer, evaluations, 1)  # type: ignore[arg-type]
        best.append(sum(t.total for t in found.candidates))
    return float(np.mean(best))


@pytest.mark.parametrize("evaluations", [500, 2000, 6940])
@pytest.mark.parametrize("other", ["coevolution", "random"])
def test_it_is_better_than_the_papers(other: str, evaluations: int) -> None:
    assert mean_best("blockwise", evaluations) >= mean_best(other, evaluations)


def test_it_finds_the_best_triple_there_is() -> None:
    assert mean_best("blockwise", 6940) > 199.0


def test_it_needs_no_settings_of_populations() -> None:
    """Those are co-evolution's."""
    found = []
    for settings in (OptimizerSettings(), OptimizerSettings(bases=5, partners=2)):
        rng = np.random.default_rng(0)
        optimizer = OPTIMIZERS["blockwise"](SPACE, settings, rng)
        score = AnalyticScore()
        found.append(optimize(score, optimizer, 800, 1))  # type: ignore[arg-type]
    assert np.array_equal(found[0].evaluated.q_base, found[1].evaluated.q_base)


def test_bases_asked_for_are_free() -> None:
    found, _ = search("blockwise", 3000)
    assert free(found.evaluated.q_base).all()


def test_the_second_end_is_asked_only_for_grasps_that_work_at_the_first() -> None:
    """Scouts come first: until a triple is known nothing else is evaluated."""
    optimizer = OPTIMIZERS["blockwise"](
        SPACE, OptimizerSettings(), np.random.default_rng(0)
    )
    first = optimizer.ask(1000)
    good = np.arange(len(first.end)) % 3 == 0
    optimizer.tell(np.where(good, 10.0, 0.0))
    second = optimizer.ask(1000)
    assert set(second.end) == {1 - first.end[0]}
    known = {row.tobytes() for row in first.grasps[good]}
    assert {row.tobytes() for row in second.grasps} == known


def test_a_line_learns_the_direction_of_its_successes() -> None:
    line, way = Lineage.of(TRIPLE), np.zeros(6)
    way[[0, 4]] = 0.1, 0.1  # the start base moves in x where the first grasp gene does
    for _ in range(20):
        line.succeed(TRIPLE, line.scale * way)
    rng = np.random.default_rng(0)
    grasp_step = np.array([0.1, 0.0])
    steps = line.base_steps(End.START, grasp_step, 500, rng)
    goals = line.base_steps(End.GOAL, grasp_step, 500, rng)
    np.testing.assert_allclose(steps.mean(axis=0), [0.1, 0.0], atol=0.02)
    np.testing.assert_allclose(goals.mean(axis=0), [0.0, 0.0], atol=0.02)


def test_a_line_that_fails_converges_and_success_lengthens_its_steps() -> None:
    line = Lineage.of(TRIPLE)
    for _ in range(20):
        line.fail()
    scale = line.scale
    assert 0.0 < scale < 1.0
    line.succeed(TRIPLE, np.full(6, 0.01))
    assert line.scale > scale
    while not line.converged:
        line.fail()
    assert np.abs(line.grasp_step(np.random.default_rng(0))).max() < 0.02


def test_successes_are_remembered_by_end_and_draws_profit_by_them() -> None:
    rng = np.random.default_rng(0)
    successes = Successes(SPACE.bases[End.START], GRASPS, rng)
    assert successes.rate == 0.5
    q_base = np.array([[0.5, 0.4], [0.6, -0.4], [0.4, 0.1]])
    grasps = np.array([[0.05, 3.0], [0.15, 0.0], [0.1, -1.5]])
    queries = Queries(np.zeros(3, np.int8), q_base, grasps)
    successes.add(queries, np.array([10.0, 20.0, 0.0]))
    assert successes.rate == pytest.approx(3 / 5)
    drawn = successes.bases(np.tile(grasps[:1], (2000, 1)), 1)[:, 0]
    near = [np.mean(np.linalg.norm(drawn - b, axis=1) < 0.15) for b in q_base]
    assert near[0] > 0.3 > 0.1 > near[1]
    assert free(drawn).all()


def test_a_base_that_collides_is_drawn_back_towards_where_it_came_from() -> None:
    successes = Successes(SPACE.bases[End.START], GRASPS, np.random.default_rng(0))
    origin = np.array([[1.0, 0.8], [1.19, 0.8]])
    got = successes.contained(origin + np.array([0.3, 0.0]), origin)
    assert free(got).all()
    np.testing.assert_allclose(got[0], [1.15, 0.8], atol=1e-12)
    np.testing.assert_allclose(got[1], origin[1], atol=1e-12)


def test_a_gene_that_cannot_vary_does_no_harm() -> None:
    fixed = GeneSpace(np.array([0.1, -np.pi]), np.array([0.1, np.pi]), GRASPS.periodic)
    space = type(SPACE)(SPACE.bases, fixed)
    for name in QUICK:
        rng = np.random.default_rng(0)
        optimizer = OPTIMIZERS[name](space, OptimizerSettings(), rng)
        score = AnalyticScore()
        found = optimize(score, optimizer, 1000, 1)  # type: ignore[arg-type]
        assert np.all(found.evaluated.grasps[:, 0] == 0.1)
