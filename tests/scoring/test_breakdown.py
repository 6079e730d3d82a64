"""The breakdown of a score by term and by link adds up."""

from __future__ import annotations

import numpy as np
import pytest

from mmplan.scoring import TERMS, Outcome, ScoreFunction
from tests.scoring.conftest import Evaluated


def test_terms_add_up_to_the_score_and_links_to_the_clutter(
    evaluated: Evaluated, kitchen_score: ScoreFunction
) -> None:
    end, q_base, grasps, scores = evaluated
    for row in np.flatnonzero(scores.total > 0.0)[:20]:
        parts = kitchen_score.breakdown(end, q_base[row], grasps[row])
        assert parts.outcome == Outcome.SCORED
        assert tuple(parts.terms) == TERMS
        assert parts.total == scores.total[row]
        assert sum(parts.terms.values()) == pytest.approx(parts.total, abs=1e-12)
        points = sum(link.points for link in parts.links)
        assert points == pytest.approx(parts.terms["clutter"], abs=1e-9)


def test_a_links_points_are_weight_times_distance_to_scale(
    evaluated: Evaluated, kitchen_score: ScoreFunction
) -> None:
    end, q_base, grasps, scores = evaluated
    row = int(np.argmax(scores.total))
    parts = kitchen_score.breakdown(end, q_base[row], grasps[row])
    scale = kitchen_score.problem.robot.score_scales.clutter
    assert {link.link for link in parts.links} >= {"base", "forearm", "hand"}
    for link in parts.links:
        expected = 50.0 * link.weight * link.distance / scale
        assert link.points == pytest.approx(expected, rel=1e-12)
        assert link.distance > 0.0


def test_what_does_not_score_has_nothing_to_break_down(
    evaluated: Evaluated, kitchen_score: ScoreFunction
) -> None:
    end, q_base, grasps, scores = evaluated
    row = int(np.argmin(scores.total))
    parts = kitchen_score.breakdown(end, q_base[row], grasps[row])
    assert parts.outcome == scores.outcome[row] != Outcome.SCORED
    assert parts.total == 0.0
    assert set(parts.terms.values()) == {0.0}
    assert parts.links == ()
