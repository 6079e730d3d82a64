"""Base placements: where they are drawn from, and what is said if there is no room."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.exceptions import NoPlanError
from mmplan.optimizers import BasePlacements, search_space
from mmplan.pipeline import score_function
from mmplan.scoring import End, Outcome
from mmplan.shapes import Array
from tests.tabletop import cup_problem

PLACEMENTS = BasePlacements((1.4, -0.3), 0.28, 1.06, lambda q: q[:, 1] > -0.5)


@given(st.integers(1, 300), st.integers(0, 2**32 - 1))
def test_samples_lie_in_the_annulus_free_and_without_offsets(n: int, seed: int) -> None:
    genes = PLACEMENTS.sample(n, np.random.default_rng(seed))
    q_base = PLACEMENTS.q_base(genes)
    away = np.linalg.norm(q_base - PLACEMENTS.centre, axis=1)
    assert genes.shape == (n, 4)
    assert not genes[:, 2:].any()
    assert np.all((away >= 0.28 - 1e-12) & (away <= 1.06 + 1e-12))
    np.testing.assert_allclose(away, genes[:, 0], atol=1e-12)
    assert np.all(q_base[:, 1] > -0.5)


def test_samples_are_uniform_over_the_area() -> None:
    anywhere = BasePlacements((0.0, 0.0), 0.28, 1.06, lambda q: np.ones(len(q), bool))
    genes = anywhere.sample(20_000, np.random.default_rng(0))
    share = (genes[:, 0] ** 2 - 0.28**2) / (1.06**2 - 0.28**2)
    for values in (share, genes[:, 1] / (2 * np.pi) + 0.5):
        tenths = np.histogram(values, bins=10, range=(0.0, 1.0))[0] / len(values)
        np.testing.assert_allclose(tenths, 0.1, atol=0.01)


def test_offsets_move_the_base_and_are_limited() -> None:
    genes = np.array([[0.5, np.pi / 2, 0.1, -0.05]])
    np.testing.assert_allclose(PLACEMENTS.q_base(genes), [[1.5, 0.15]])
    bounds = PLACEMENTS.genes
    assert bounds.lower[2:].tolist() == [-0.2, -0.2]
    assert bounds.upper[2:].tolist() == [0.2, 0.2]
    assert bounds.periodic.tolist() == [False, True, False, False]


def test_no_room_is_an_error_that_names_the_place() -> None:
    asked = 0

    def nowhere(q_base: Array) -> np.ndarray:
        nonlocal asked
        asked += len(q_base)
        return np.zeros(len(q_base), bool)

    enclosed = BasePlacements((1.4, -0.3), 0.28, 1.06, nowhere)
    message = (
        r"no room for the base within reach of \(1\.400, -0\.300\): 4000 placements "
        r"0\.28 m to 1\.06 m away were in collision or out of bounds"
    )
    with pytest.raises(NoPlanError, match=message):
        enclosed.sample(2, np.random.default_rng(0))
    assert asked == 4000


def test_the_search_is_about_the_objects_centre_at_either_end() -> None:
    score = score_function(cup_problem())
    robot = score.problem.robot
    placements = search_space(score).bases
    for end, centre in ((End.START, (0.4, 0.5)), (End.GOAL, (0.4, 0.0))):
        np.testing.assert_allclose(placements[end].centre, centre, atol=1e-9)
        assert placements[end].inner == robot.base_radius
        assert placements[end].outer == robot.reach
        q_base = placements[end].q_base(
            placements[end].sample(50, np.random.default_rng(0))
        )
        assert np.all(score.base_outcomes(end, q_base) == Outcome.SCORED)
