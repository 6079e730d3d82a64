"""The margin of the joints: in the middle 1, at a limit 0, and a term if wanted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mmplan.candidate import Candidate
from mmplan.optimizers import Triple
from mmplan.pipeline import score_function
from mmplan.problem import Problem, ScoreSettings
from mmplan.scoring import TERMS, End
from mmplan.scoring.joint_margin import joint_margin
from tests.honest import puma
from tests.tabletop import cup_problem

ROBOT = puma()
ARM = ROBOT.arm


def at(share: np.ndarray) -> np.ndarray:
    """A configuration (1, nq) with the arm's joints at shares of their ranges."""
    q = ROBOT.q_neutral[None].copy()
    q[:, ARM.indices] = ARM.lower + share * (ARM.upper - ARM.lower)
    return q


@given(st.lists(st.floats(0.0, 1.0), min_size=len(ARM), max_size=len(ARM)))
def test_it_is_that_of_the_joint_nearest_to_a_limit(shares: list[float]) -> None:
    share = np.array(shares)
    expected = 2.0 * np.minimum(share, 1.0 - share).min()
    np.testing.assert_allclose(joint_margin(ROBOT, at(share)), expected, atol=1e-9)


def test_joints_without_limits_do_not_count() -> None:
    share = np.full(len(ARM), 0.5)
    share[2] = 0.9
    assert joint_margin(ROBOT, at(share))[0] == pytest.approx(0.2)
    endless = np.array([0.0, 0.0, np.inf, 0.0, 0.0, 0.0])
    arm = replace(
        ARM, lower=ARM.lower - endless, upper=ARM.upper + endless, wraps=endless > 0.0
    )
    turning = replace(ROBOT, arm=arm)
    assert joint_margin(turning, at(share))[0] == pytest.approx(1.0)
    every = replace(arm, wraps=np.ones(len(arm), dtype=np.bool_))
    assert joint_margin(replace(ROBOT, arm=every), at(share))[0] == 1.0


def weighted(weight: float) -> Problem:
    return replace(cup_problem(), score=ScoreSettings(joint_margin=weight))


def test_it_is_a_term_where_it_has_a_weight_and_none_elsewhere() -> None:
    rng = np.random.default_rng(0)
    plain, margin = (score_function(weighted(w)) for w in (0.0, 2.0))
    assert plain.terms == TERMS
    assert margin.terms == (*TERMS, "joint_margin")
    q_base = np.array([0.4, 0.5]) + rng.uniform(-1, 1, (200, 2))
    grasps = plain.family.genes.sample(200, rng)
    before, after = (f(End.START, q_base, grasps) for f in (plain, margin))
    scored = before.total > 0.0
    assert scored.sum() > 3
    assert np.array_equal(before.outcome, after.outcome)
    np.testing.assert_allclose(after.terms.sum(axis=1), after.total, atol=1e-9)
    J = joint_margin(ROBOT, after.q[scored])
    np.testing.assert_allclose(after.terms[scored, 3], 100.0 * J, atol=1e-9)
    # The best branch for the new sum is at least as good in it as the old one.
    old = before.total[scored] + 100.0 * joint_margin(ROBOT, before.q[scored])
    assert np.all(after.total[scored] >= old - 1e-9)
    assert np.any(after.total[scored] > old + 1e-3)


def test_it_is_in_the_breakdown_and_in_what_a_plan_records() -> None:
    score = score_function(weighted(1.0))
    rng = np.random.default_rng(0)
    q_base = np.array([0.4, 0.5]) + rng.uniform(-1, 1, (400, 2))
    grasps = score.family.genes.sample(400, rng)
    row = int(score(End.START, q_base, grasps).total.argmax())
    parts = score.breakdown(End.START, q_base[row], grasps[row])
    assert parts.terms["joint_margin"] > 0.0
    assert sum(parts.terms.values()) == pytest.approx(parts.total)
    triple = Triple((q_base[row], q_base[row]), grasps[row], (1.0, 1.0))
    recorded = Candidate.of_triple(triple, score).scores[End.START]
    assert recorded == parts.terms
