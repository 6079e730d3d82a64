"""Random sampling is the paper's baseline, and its triples cost what they cost."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.optimizers import RandomSampling
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End
from tests.optimizers.analytic import CENTRES, INNER, OUTER, SPACE, free, optimize


def test_a_triple_costs_one_evaluation_if_its_start_fails_and_two_otherwise() -> None:
    found, score = optimize("random", 5000)
    starts, goals = ([a for a in score.asked if a[0] == end] for end in End)
    feasible = [
        grasp.tobytes()
        for _, _, grasps, totals in starts
        for grasp in grasps[totals > 0.0]
    ]
    asked = [grasp.tobytes() for _, _, grasps, _ in goals for grasp in grasps]
    assert asked == feasible[: len(asked)]
    last = len(starts[-1][1])  # of the last batch not every goal may be affordable
    assert len(feasible) - len(asked) <= last
    assert found.evaluations == sum(len(a[1]) for a in starts) + len(asked)


def test_bases_come_from_the_annuli_and_are_free() -> None:
    found, _ = optimize("random", 5000)
    for end in End:
        q_base = found.evaluated.q_base[found.evaluated.end == end]
        away = np.linalg.norm(q_base - CENTRES[end], axis=1)
        assert np.all((away >= INNER - 1e-12) & (away <= OUTER + 1e-12))
        assert free(q_base).all()


def test_every_triple_is_drawn_anew() -> None:
    found, _ = optimize("random", 5000)
    starts = found.evaluated.grasps[found.evaluated.end == End.START]
    assert len(np.unique(starts, axis=0)) == len(starts)


@pytest.mark.parametrize("limit", [1, 3, 1000])
def test_no_more_is_asked_for_than_may_be(limit: int) -> None:
    search = RandomSampling(SPACE, OptimizerSettings(), np.random.default_rng(0))
    for _ in range(5):
        queries = search.ask(limit)
        assert 1 <= len(queries.end) <= limit
        search.tell(np.ones(len(queries.end)))


def test_it_has_no_cycles() -> None:
    assert optimize("random", 10)[0].cycles is None
