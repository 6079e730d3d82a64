"""Joint searches: what a triple costs, what it is worth, the box of joint vectors."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.exceptions import InputError
from mmplan.optimizers import OPTIMIZERS, BasePlacements, Optimizer
from mmplan.optimizers import contender as contender_module
from mmplan.optimizers.joint import START_ONLY_VALUE, joint_values
from mmplan.optimizers.unit_box import UnitBox
from mmplan.problem import OptimizerSettings
from mmplan.scoring import End
from tests.optimizers.analytic import (
    CENTRES,
    GRASPS,
    INNER,
    INSTALLED,
    LIBRARIES,
    OUTER,
    QUICK,
    SPACE,
    optimize,
)

CONTENDERS = [name for name in INSTALLED if name in LIBRARIES]
JOINT = ["random", *CONTENDERS]


def make(name: str, seed: int = 0) -> Optimizer:
    return OPTIMIZERS[name](SPACE, OptimizerSettings(), np.random.default_rng(seed))


@pytest.mark.parametrize("name", JOINT)
def test_goals_are_asked_for_where_the_start_is_feasible_and_only_there(
    name: str,
) -> None:
    optimizer, rng = make(name), np.random.default_rng(5)
    batches = 0
    while batches < 30:
        starts = optimizer.ask(10_000)
        assert set(starts.end) == {End.START}
        totals = np.where(rng.random(len(starts.end)) < 0.3, 7.0, 0.0)
        optimizer.tell(totals)
        batches += 1
        if not totals.any():
            continue
        goals = optimizer.ask(10_000)
        assert set(goals.end) == {End.GOAL}
        assert np.array_equal(goals.grasps, starts.grasps[totals > 0.0])
        optimizer.tell(rng.uniform(0.0, 9.0, len(goals.end)))


@pytest.mark.parametrize("name", JOINT)
@pytest.mark.parametrize("limit", [1, 3, 1000])
def test_no_more_is_asked_for_than_may_be(name: str, limit: int) -> None:
    optimizer = make(name)
    for _ in range(5):
        queries = optimizer.ask(limit)
        assert 1 <= len(queries.end) <= limit
        optimizer.tell(np.ones(len(queries.end)))


def test_random_sampling_draws_no_start_whose_goal_it_could_not_afford() -> None:
    for limit in range(1, 50):
        optimizer = make("random")
        starts = len(optimizer.ask(limit).end)
        optimizer.tell(np.ones(starts))
        assert starts == (limit + 1) // 2


def test_a_triple_is_worth_the_sum_of_its_scores_if_it_works_at_both_ends() -> None:
    scores = np.array([[30.0, 0.5], [60.0, 0.0], [0.0, 0.0], [1e-3, 2e-3]])
    values = joint_values(scores)
    assert values.tolist() == [30.5, START_ONLY_VALUE, 0.0, 3e-3]


@pytest.mark.parametrize("name", [n for n in CONTENDERS if n in QUICK])
def test_contenders_learn(name: str) -> None:
    """With what they are told they do far better than without."""
    best = {
        n: np.mean([optimize(n, 3000, seed)[0].history[-1, 1] for seed in range(3)])
        for n in (name, "random")
    }
    assert best[name] > best["random"] + 10.0


@pytest.mark.parametrize("name", LIBRARIES)
def test_a_missing_library_is_named_with_its_extra(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(module: str) -> None:
        raise ModuleNotFoundError(f"No module named {module!r}", name=module)

    monkeypatch.setattr(contender_module.importlib, "import_module", missing)
    with pytest.raises(InputError, match=rf"{name}.*needs.*mmplan\[contenders\]"):
        make(name)


def test_a_fault_within_a_library_is_not_taken_for_its_absence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def broken(_: str) -> None:
        raise ModuleNotFoundError("No module named 'other'", name="other")

    monkeypatch.setattr(contender_module.importlib, "import_module", broken)
    with pytest.raises(ModuleNotFoundError, match="other"):
        make("cmaes")


def test_samples_of_the_box_are_free_bases_of_the_annuli() -> None:
    box = UnitBox(SPACE)
    vectors = box.sample(200, np.random.default_rng(1))
    assert vectors.shape == (200, len(box)) == (200, 10)
    assert np.all((vectors >= 0.0) & (vectors <= 1.0))
    triples = box.triples(vectors)
    for end in End:
        away = np.linalg.norm(triples[end] - CENTRES[end], axis=1)
        assert np.all((away > INNER - 1e-9) & (away < OUTER + 1e-9))
        assert SPACE.bases[end].is_free(triples[end]).all()


def test_angles_go_round_and_other_genes_stop() -> None:
    box = UnitBox(SPACE)
    assert box.periodic.tolist() == [0, 1, 0, 0, 0, 1, 0, 0, 0, 1]
    vector = box.sample(1, np.random.default_rng(2))
    there, round_ = box.triples(vector), box.triples(vector + 3.0 * box.periodic)
    for a, b in zip(there, round_, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-9)
    beyond = box.triples(vector + 5.0 * ~box.periodic)
    assert beyond.grasps[0, 0] == GRASPS.upper[0]


@pytest.mark.parametrize("seed", range(5))
def test_the_nearest_placement_is_the_wanted_one_where_genes_reach(seed: int) -> None:
    placements: BasePlacements = SPACE.bases[End.START]
    rng = np.random.default_rng(seed)
    genes = placements.genes
    wanted = placements.q_base(genes.sample(500, rng))
    got = placements.nearest(wanted)
    off = np.linalg.norm(got - wanted, axis=1)
    away = np.linalg.norm(wanted - placements.centre, axis=1)
    inside = (away >= INNER) & (away <= OUTER)
    assert inside.sum() > 100
    assert off[inside].max() < 1e-9
    assert off.max() < 0.1  # corners of the offsets' square
    np.testing.assert_allclose(placements.nearest(got), got, atol=1e-9)
