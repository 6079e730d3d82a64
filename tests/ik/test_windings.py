"""Windings within limits, against trying every number of turns."""

from __future__ import annotations

from itertools import product

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mmplan.ik.windings import nearest_winding, windings
from mmplan.shapes import Array

TURN = 2 * np.pi
angles = st.floats(-30.0, 30.0)
limits = st.tuples(st.floats(-7.0, 0.0), st.floats(0.1, 14.0)).map(
    lambda low_span: (low_span[0], low_span[0] + low_span[1])
)
joints = st.lists(st.tuples(angles, limits), min_size=1, max_size=3).map(
    lambda drawn: np.array([(q, low, high) for q, (low, high) in drawn]).T
)  # rows q, lower and upper


def by_trial(q: Array, lower: Array, upper: Array) -> set[tuple[float, ...]]:
    """Every winding within limits, rounded so that sets can be compared."""
    found = set()
    for turns in product(range(-8, 9), repeat=len(q)):
        moved = q + TURN * np.array(turns)
        if np.all((moved >= lower) & (moved <= upper)):
            found.add(tuple(np.round(moved, 6)))
    return found


@given(joints)
def test_windings_are_all_that_trial_finds(drawn: Array) -> None:
    q, lower, upper = drawn
    at_a_limit = np.abs(np.sin((q - [lower, upper]) / 2)).min() < 1e-6
    if not at_a_limit:
        rows = windings(q, lower, upper)
        assert rows.shape[1] == len(q)
        assert {tuple(np.round(row, 6)) for row in rows} == by_trial(q, lower, upper)
        assert len(rows) == len(by_trial(q, lower, upper))


@given(joints)
def test_the_first_winding_is_the_nearest_to_the_middle(drawn: Array) -> None:
    q, lower, upper = drawn
    rows = windings(q, lower, upper)
    if len(rows):
        np.testing.assert_array_equal(rows[0], nearest_winding(q, lower, upper))
        distances = np.abs(rows - (lower + upper) / 2).sum(axis=1)
        assert distances[0] <= distances.min() + 1e-9


def test_joint_6_of_the_puma_has_two_windings_beyond_94_degrees() -> None:
    lower, upper = np.radians([[-266.0], [266.0]])
    np.testing.assert_allclose(
        np.degrees(windings(np.radians([100.0]), lower, upper)), [[100.0], [-260.0]]
    )
    assert len(windings(np.radians([90.0]), lower, upper)) == 1


def test_no_winding_within_limits_is_an_empty_answer() -> None:
    assert windings(np.array([3.0]), np.array([-1.0]), np.array([1.0])).shape == (0, 1)


def test_a_joint_without_limits_is_nearest_0_and_has_one_winding() -> None:
    lower, upper = np.array([-np.inf, -1.0]), np.array([np.inf, 9.0])
    q = np.array([15.0, 0.5])
    near = [15.0 - 2 * TURN, 0.5 + TURN]
    np.testing.assert_allclose(nearest_winding(q, lower, upper), near)
    np.testing.assert_allclose(windings(q, lower, upper), [near, [near[0], 0.5]])
