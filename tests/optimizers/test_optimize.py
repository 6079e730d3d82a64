"""What every optimizer owes: its budget, its history, and candidates that are real."""

from __future__ import annotations

from functools import cache
from itertools import combinations, product

import numpy as np
import pytest

from mmplan.optimizers import OPTIMIZERS, Archive, Triple
from mmplan.optimizers import optimize as run
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End, Outcome
from tests.optimizers.analytic import (
    CENTRES,
    GRASPS,
    INSTALLED,
    OUTER,
    QUICK,
    SPACE,
    AnalyticScore,
    free,
    optimize,
)

NAMES = sorted(QUICK)
PAPERS_BUDGET = 6940
ENOUGH = 2500  # evaluations for every optimizer to find candidates

searched = cache(optimize)  # for tests that only look at what was found


@pytest.mark.parametrize(
    ("name", "evaluations"),
    [
        *product(NAMES, [1, 7, 500, 588, 2072, PAPERS_BUDGET]),
        *product(set(INSTALLED) - set(QUICK), [1, 7, 500]),
    ],
)
def test_the_budget_is_spent_exactly(name: str, evaluations: int) -> None:
    found, score = optimize(name, evaluations)
    assert found.evaluations == score.count == evaluations
    assert found.outcomes.sum() == evaluations
    assert len(found.evaluated.end) == evaluations
    assert found.history[-1, 0] == evaluations


@pytest.mark.parametrize("name", NAMES)
def test_the_history_never_falls_and_ends_at_the_best(name: str) -> None:
    found, score = searched(name, ENOUGH)
    evaluations, best = found.history.T
    assert np.all(np.diff(evaluations) > 0)
    assert np.all(np.diff(best) >= 0.0)
    assert best[-1] == pytest.approx(best_sum(score), abs=1e-12)
    assert best[-1] >= found.candidates[0].total > 0.0


@pytest.mark.parametrize("name", NAMES)
def test_the_history_is_that_of_evaluations_one_by_one(name: str) -> None:
    found, score = optimize(name, 1500)
    totals, best = score.pairs(), Archive()
    rises = []
    for end, q_base, grasp in zip(*found.evaluated, strict=True):
        before = best.best
        total = totals[End(end), q_base.tobytes(), grasp.tobytes()]
        if total > 0.0:
            best.add(End(end), q_base, grasp, total)
        rises.append(best.best > before)
    spent = np.flatnonzero(rises) + 1
    assert found.history[:, 0].tolist() == np.union1d(spent, [1500]).tolist()


def best_sum(score: AnalyticScore) -> float:
    """The greatest sum of a start's and a goal's score with one grasp."""
    best: dict[bytes, list[float]] = {}
    for (end, _, grasp), total in score.pairs().items():
        ends = best.setdefault(grasp, [0.0, 0.0])
        ends[end] = max(ends[end], total)
    return max(sum(ends) for ends in best.values() if min(ends) > 0.0)


@pytest.mark.parametrize("name", NAMES)
def test_outcomes_and_grasps_are_counted_by_end(name: str) -> None:
    found, score = searched(name, ENOUGH)
    works: dict[bytes, set[End]] = {}
    counts = np.zeros_like(found.outcomes)
    for (end, _, grasp), total in score.pairs().items():
        if total > 0.0:
            works.setdefault(grasp, set()).add(end)
    for end, *_, totals in score.asked:
        counts[end, Outcome.SCORED] += np.count_nonzero(totals)
        counts[end, Outcome.COLLISION] += np.count_nonzero(totals == 0.0)
    assert np.array_equal(found.outcomes, counts)
    ends = list(works.values())
    kinds = [{End.START}, {End.GOAL}, {End.START, End.GOAL}]
    assert found.grasps_by_end == tuple(ends.count(kind) for kind in kinds)


@pytest.mark.parametrize("name", NAMES)
def test_candidates_were_evaluated_and_work_at_both_ends(name: str) -> None:
    found, score = searched(name, ENOUGH)
    pairs = score.pairs()
    assert found.candidates
    for triple in found.candidates:
        for end in End:
            key = (end, triple.q_base[end].tobytes(), triple.grasp.tobytes())
            assert pairs[key] == triple.scores[end] > 0.0
            assert free(triple.q_base[end][None])


@pytest.mark.parametrize("name", NAMES)
def test_candidates_are_distinct_and_sorted(name: str) -> None:
    found, _ = searched(name, ENOUGH)
    totals = [triple.total for triple in found.candidates]
    assert totals == sorted(totals, reverse=True)
    assert 1 < len(totals) <= 10
    for one, other in combinations(found.candidates, 2):
        assert differ(one, other)


def differ(a: Triple, b: Triple) -> bool:
    """Whether a base is 5 cm off or a grasp gene 5 % of its range."""
    bases = zip(a.q_base, b.q_base, strict=True)
    gap = np.abs(a.grasp - b.grasp) / GRASPS.range
    gap[1] = min(gap[1], 1.0 - gap[1])  # an angle
    moved = max(float(np.linalg.norm(p - q)) for p, q in bases)
    return moved > 0.05 or bool(gap.max() > 0.05)


@pytest.mark.parametrize("name", NAMES)
def test_no_more_candidates_than_wanted(name: str) -> None:
    found, _ = optimize(name, 1200, candidates=2)
    assert len(found.candidates) == 2
    more, _ = optimize(name, 1200, candidates=3)
    for one, other in zip(found.candidates, more.candidates, strict=False):
        assert one.total == other.total


@pytest.mark.parametrize("name", NAMES)
def test_one_seed_gives_one_search_bit_for_bit(name: str) -> None:
    one, again, other = (optimize(name, 700, seed)[0] for seed in (3, 3, 4))
    assert np.array_equal(one.evaluated.q_base, again.evaluated.q_base)
    assert np.array_equal(one.evaluated.grasps, again.evaluated.grasps)
    assert np.array_equal(one.history, again.history)
    for a, b in zip(one.candidates, again.candidates, strict=True):
        assert np.array_equal(a.q_base, b.q_base)
        assert np.array_equal(a.grasp, b.grasp)
        assert a.scores == b.scores
    assert not np.array_equal(one.evaluated.q_base, other.evaluated.q_base)


@pytest.mark.parametrize("name", NAMES)
def test_everything_asked_for_is_within_bounds(name: str) -> None:
    found, _ = searched(name, ENOUGH)
    grasps = found.evaluated.grasps
    assert np.all((grasps >= GRASPS.lower) & (grasps <= GRASPS.upper))
    for end, centre in CENTRES.items():
        q_base = found.evaluated.q_base[found.evaluated.end == end]
        away = np.abs(q_base - centre).max()
        assert away <= OUTER + 0.2


def test_progress_is_told_after_every_batch() -> None:
    told: list[int] = []
    optimizer = OPTIMIZERS["coevolution"](
        SPACE, OptimizerSettings(), np.random.default_rng(0)
    )
    found = run(AnalyticScore(), optimizer, 3000, 1, told.append)  # type: ignore[arg-type]
    assert told == [1176, 2072, 3000]
    assert found.evaluations == told[-1]


def test_co_evolution_beats_random_sampling() -> None:
    best = {
        name: [
            optimize(name, PAPERS_BUDGET, seed)[0].history[-1, 1] for seed in range(4)
        ]
        for name in ("coevolution", "random")
    }
    assert np.mean(best["coevolution"]) > np.mean(best["random"]) + 5.0
