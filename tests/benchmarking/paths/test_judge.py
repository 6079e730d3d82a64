"""What is found out about paths."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mmplan.benchmarking.paths.judge import (
    TOLERANCE,
    collides_when_rechecked,
    judge,
    lengths,
)
from tests.benchmarking.paths.made import arena, box

# A sheet of 0.1 mm across the way of the hand, and where that is: y is 0 at HOME.
SHEET = box((0.4, 1e-4, 0.4), 0.45, 0.2, 0.6)


def test_a_sheet_between_all_samples_is_found() -> None:
    made = arena(SHEET)
    coarse = np.stack([made.q_start, made.q_goal])
    assert not made.world.any_collision(coarse)
    assert "overlap" in judge(made, coarse).fault


def test_a_free_path_is_proven() -> None:
    made = arena(box((0.1, 0.1, 0.1), 0.0, -0.8, 0.5))
    judgement = judge(made, np.stack([made.q_start, made.q_goal]))
    assert judgement.fault == ""
    assert judgement.clearance is not None
    assert judgement.clearance > 0.0


@given(seed=st.integers(0, 10**6))
@settings(max_examples=8, deadline=None)
def test_what_samples_find_the_proof_finds_too(seed: int) -> None:
    rng = np.random.default_rng(seed)
    made = arena(box((0.3, 0.3, 0.3), *rng.uniform((0.2, -0.5, 0.2), (0.7, 0.5, 0.9))))
    path = np.tile(made.q_start, (3, 1))
    lower, upper = made.joints.lower, made.joints.upper
    path[:, made.joints.indices] = rng.uniform(lower, upper, (3, len(lower)))
    if collides_when_rechecked(made, path):
        assert judge(made, path).fault


def test_paths_that_end_elsewhere_or_leave_the_limits_are_refused() -> None:
    made = arena()
    path = np.stack([made.q_start, made.q_goal])
    off = path.copy()
    off[1, 0] += 2.0 * TOLERANCE
    assert "the path's goal is" in judge(made, off).fault
    beyond = np.insert(path, 1, path[0], axis=0)
    beyond[1, 3] = 0.5
    assert "panda_joint4 goes 0.41 beyond its limit" in judge(made, beyond).fault


def test_lengths_are_those_of_the_joints_and_of_the_way() -> None:
    made = arena()
    length, way = lengths(made, np.stack([made.q_start, made.q_goal, made.q_start]))
    assert length == pytest.approx(2.0 * 1.6)
    assert way > length * 0.5  # the first joint carries the arm around
